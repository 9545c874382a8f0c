//! The one error type of the crate.
//!
//! An error about an argument names the argument, its value and what is allowed; an error about data gives path, line and
//! column and what was expected there. `Display` tells one layer, [`std::error::Error::source`] the rest.

use std::fmt;
use std::path::{Path, PathBuf};

/// The result of everything in this crate that can fail.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Whatever can go wrong. None of these is a defect of the program: each tells its reader what to change.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An argument is outside its range.
    #[error("{name} is {value}, but must be {expected}")]
    Argument {
        /// The argument's name, as its user wrote it.
        name: &'static str,
        /// The value given.
        value: String,
        /// What is allowed.
        expected: String,
    },
    /// Text that was read is not of its form.
    #[error("{place}: {problem}; expected {expected}")]
    Data {
        /// Where.
        place: Place,
        /// What stands there.
        problem: String,
        /// What should stand there.
        expected: String,
    },
    /// A file is not what it should be, as a whole.
    #[error("{}: {problem}; {remedy}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
    /// An instance of the theory commands is well-formed JSON, but one of its values cannot be.
    #[error("{}: {at}: {problem}; expected {expected}", path.display())]
    Instance {
        /// The file, or a name in angle brackets for an instance that was made in memory.
        path: PathBuf,
        /// The value within the instance, such as `P[2][0]`.
        at: String,
        /// What stands there.
        problem: String,
        /// What should stand there.
        expected: String,
    },
    /// The operating system refused.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// What was tried: `read`, `write`, ...
        action: &'static str,
        /// On which file.
        path: PathBuf,
        /// The system's own words.
        source: std::io::Error,
    },
}

impl Error {
    /// An argument outside its range.
    pub fn argument(name: &'static str, value: impl fmt::Display, expected: impl Into<String>) -> Self {
        Error::Argument { name, value: value.to_string(), expected: expected.into() }
    }

    /// Text at `place` that is not of its form.
    pub fn data(place: Place, problem: impl Into<String>, expected: impl Into<String>) -> Self {
        Error::Data { place, problem: problem.into(), expected: expected.into() }
    }

    /// A file that is not what it should be.
    pub fn file(path: impl AsRef<Path>, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Error::File { path: path.as_ref().to_owned(), problem: problem.into(), remedy: remedy.into() }
    }

    /// A value of an instance that cannot be; [`Error::within`] adds the file.
    pub fn instance(at: impl Into<String>, problem: impl Into<String>, expected: impl Into<String>) -> Self {
        let path = PathBuf::from("<instance>");
        Error::Instance { path, at: at.into(), problem: problem.into(), expected: expected.into() }
    }

    /// The same error, said to come from the file at `file` if it is an error of an instance.
    pub fn within(self, file: impl AsRef<Path>) -> Self {
        match self {
            Error::Instance { at, problem, expected, .. } => {
                Error::Instance { path: file.as_ref().to_owned(), at, problem, expected }
            }
            other => other,
        }
    }

    /// The operating system's refusal to `action` the file at `path`.
    pub fn io(action: &'static str, path: impl AsRef<Path>, source: std::io::Error) -> Self {
        Error::Io { action, path: path.as_ref().to_owned(), source }
    }
}

/// A place in a text: `path:line:column`, line and column counted from 1, the column in characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file, or a name in angle brackets for a text that is not a file, such as `<stdin>`.
    pub path: PathBuf,
    /// The line, from 1.
    pub line: usize,
    /// The character within the line, from 1.
    pub column: usize,
}

impl Place {
    /// The place at byte `offset` of `text`, which was read from `path`.
    pub fn of(path: impl AsRef<Path>, text: &[u8], offset: usize) -> Self {
        let before = &text[..offset.min(text.len())];
        let start = memchr::memrchr(b'\n', before).map_or(0, |newline| newline + 1);
        Place {
            path: path.as_ref().to_owned(),
            line: memchr::memchr_iter(b'\n', before).count() + 1,
            column: String::from_utf8_lossy(&before[start..]).chars().count() + 1,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.path.display(), self.line, self.column)
    }
}
