//! Load on `rollin serve` from another process: good requests of ten sentences on connections that are kept, and in between one in ten that is
//! malformed, too large or slow; the model is read again every second. What is not answered as it should be ends the run with an error.
//!
//! cargo bench --bench serve [-- --seconds 60] [--clients 4]

#[path = "../tests/serve/client.rs"]
mod client;

use client::{Server, receive, send};
use std::collections::VecDeque;
use std::io::{BufReader, Write};
use std::net::TcpStream;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A number from the command line.
fn option(name: &str, default: u64) -> u64 {
    let mut arguments = std::env::args().skip_while(|argument| argument != name);
    arguments.nth(1).and_then(|value| value.parse().ok()).unwrap_or(default)
}

/// The memory that a process holds, in KiB.
fn memory(id: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmRSS")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|number| number.parse().ok()).unwrap_or(0)
}

/// What one client saw.
#[derive(Default)]
struct Seen {
    /// Seconds that good requests took.
    seconds: Vec<f64>,
    /// Bad ones, all answered as such.
    bad: usize,
}

/// Asks until `over`, on one connection as long as the server keeps it.
fn client(server: &Server, (text, expected): (&[u8], &str), over: &AtomicBool) -> Seen {
    let (mut seen, mut slow) = (Seen::default(), VecDeque::new());
    let mut stream = server.connect();
    let mut reader = BufReader::new(stream.try_clone().expect("a socket"));
    for turn in 0_usize.. {
        if over.load(Ordering::Relaxed) {
            break;
        }
        if turn % 10 == 9 {
            let status = match turn / 10 % 3 {
                0 => server.ask("POST /tag", b"the X\nboat\n").0 == 400,
                1 => server.ask("POST /tag", &vec![b'a'; 200_000]).0 == 413,
                _ => {
                    slow.push_back(dawdle(server));
                    // The oldest of so many were given up by the server long ago.
                    slow.len() < SLOW || slow.pop_front().is_some_and(was_timed_out)
                }
            };
            assert!(status, "a bad request was not answered as such");
            seen.bad += 1;
            continue;
        }
        let start = Instant::now();
        send(&mut stream, "POST /tag", text);
        let (status, answer) = receive(&mut reader).expect("every good request is answered");
        seen.seconds.push(start.elapsed().as_secs_f64());
        assert!(status == 200 && answer == expected, "a good request was answered by {status}");
    }
    assert!(slow.into_iter().all(was_timed_out), "a slow request was not timed out");
    seen
}

/// As many slow requests as a client keeps open: more than it makes within the server's limit of time.
const SLOW: usize = 2_000;

/// Whether a slow request was answered as such.
fn was_timed_out(slow: TcpStream) -> bool {
    receive(&mut BufReader::new(slow)).is_some_and(|(status, _)| status == 408)
}

/// A request whose body never comes; nobody waits for the answer.
fn dawdle(server: &Server) -> TcpStream {
    let mut slow = server.connect();
    slow.write_all(b"POST /tag HTTP/1.1\r\nHost: x\r\nContent-Length: 100\r\n\r\nthe").expect("it takes that");
    slow
}

fn main() {
    let (seconds, clients) = (option("--seconds", 60), option("--clients", 4));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rollin = |line: &str| {
        let run = Command::new(env!("CARGO_BIN_EXE_rollin")).args(line.split(' ')).current_dir(&folder).output();
        let run = run.expect("the program runs");
        assert!(run.status.success(), "{line}: {}", String::from_utf8_lossy(&run.stderr));
    };
    std::fs::write(folder.path().join("train.txt"), rollin::grammar::defaults::TRAIN).expect("a file");
    rollin("train --data train.txt --model m");
    let sentences: Vec<&str> = rollin::grammar::defaults::TEST.split("\n\n").take(10).collect();
    let text = sentences.join("\n\n") + "\n";
    let server = Server::start(folder.path(), "--model m --body-limit 100000 --time-limit 1 --connections 10000");
    let expected = server.ask("POST /tag", text.as_bytes()).1;
    let tokens = text.lines().filter(|line| !line.is_empty()).count();
    assert_eq!(expected.lines().filter(|line| !line.is_empty()).count(), tokens);

    let over = AtomicBool::new(false);
    let (before, start) = (memory(server.process.id()), Instant::now());
    let mut highest = before;
    let (seen, reloads) = std::thread::scope(|scope| {
        let work = || client(&server, (text.as_bytes(), &expected), &over);
        let clients: Vec<_> = (0..clients).map(|_| scope.spawn(work)).collect();
        let mut reloads = 0;
        while start.elapsed() < Duration::from_secs(seconds) {
            std::thread::sleep(Duration::from_secs(1));
            assert_eq!(server.ask("POST /reload", b"").0, 200);
            reloads += 1;
            highest = highest.max(memory(server.process.id()));
        }
        over.store(true, Ordering::Relaxed);
        let seen: Vec<Seen> = clients.into_iter().map(|client| client.join().expect("no client fails")).collect();
        (seen, reloads)
    });
    let passed = start.elapsed().as_secs_f64();
    let mut times: Vec<f64> = seen.iter().flat_map(|seen| seen.seconds.iter().copied()).collect();
    times.sort_by(f64::total_cmp);
    let at = |share: f64| 1000.0 * times[((times.len() - 1) as f64 * share) as usize];
    let bad: usize = seen.iter().map(|seen| seen.bad).sum();
    println!("{passed:.0} s, {clients} clients, {tokens} tokens a good request, {reloads} reloads");
    println!(
        "good requests: {} ({:.0}/s, {:.0} tokens/s), none lost",
        times.len(),
        times.len() as f64 / passed,
        (times.len() * tokens) as f64 / passed
    );
    println!("bad requests: {bad}, each answered as such");
    println!("p50 {:.2} ms, p99 {:.2} ms, longest {:.2} ms", at(0.5), at(0.99), at(1.0));
    println!(
        "memory: {} MiB before, {} MiB at most, {} MiB at the end",
        before / 1024,
        highest / 1024,
        memory(server.process.id()) / 1024
    );
}
