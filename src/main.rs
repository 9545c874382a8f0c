//! The command-line program.

fn main() -> std::process::ExitCode {
    rollin::cli::main()
}
