//! Files that tell when they are damaged: a magic line with the version, a line with the body's length and checksum, then the body.

use crate::error::{Error, Result};
use std::path::Path;

/// One kind of file, and what to tell whoever has another one.
pub(crate) struct Seal {
    /// What such a file is called, after "rollin" in its first line and in errors.
    pub name: &'static str,
    /// The version that is written, and the only one that is read.
    pub version: u32,
    /// What to do about a file of another kind.
    pub stranger: &'static str,
    /// What to do about one of another version.
    pub outdated: &'static str,
    /// What to do about one that is damaged.
    pub broken: &'static str,
}

impl Seal {
    /// A file with this body.
    pub fn close(&self, body: Vec<u8>) -> Vec<u8> {
        [self.head(body.len(), checksum(&body)), body].concat()
    }

    /// The first two lines of a file whose body has this length and checksum.
    pub fn head(&self, length: usize, sum: u64) -> Vec<u8> {
        format!("rollin {} {}\n{}\n", self.name, self.version, second_line(length, sum)).into_bytes()
    }

    /// The body of the file at `path` with these bytes, when its length and checksum are right.
    ///
    /// # Errors
    /// When it is of another kind or version, cut short or damaged.
    pub fn open<'a>(&self, bytes: &'a [u8], path: &Path) -> Result<&'a [u8]> {
        let stranger = || Error::file(path, format!("not a rollin {}", self.name), self.stranger);
        let (magic, rest) = first_line(bytes).ok_or_else(stranger)?;
        let version = std::str::from_utf8(magic)
            .ok()
            .and_then(|line| line.strip_prefix("rollin ")?.strip_prefix(self.name)?.strip_prefix(' '))
            .ok_or_else(stranger)?;
        if version != self.version.to_string() {
            let own = self.version;
            let problem = format!("a {} of format version {version}, but this program reads version {own}", self.name);
            return Err(Error::file(path, problem, self.outdated));
        }
        let (line, body) = first_line(rest).ok_or_else(|| self.damaged(path, "its second line is missing"))?;
        let (length, sum) = std::str::from_utf8(line)
            .ok()
            .and_then(|line| line.split_once(" bytes, checksum "))
            .and_then(|(length, sum)| Some((length.parse::<usize>().ok()?, u64::from_str_radix(sum, 16).ok()?)))
            .filter(|(length, sum)| line == second_line(*length, *sum).as_bytes())
            .ok_or_else(|| self.damaged(path, "its second line gives no length and checksum"))?;
        if body.len() != length {
            return Err(self.damaged(path, &format!("it has {} bytes of {length}", body.len())));
        }
        if checksum(body) != sum {
            return Err(self.damaged(path, "its checksum is wrong"));
        }
        Ok(body)
    }

    /// The error of a file whose body cannot be.
    pub fn damaged(&self, path: &Path, what: &str) -> Error {
        Error::file(path, format!("the {} is damaged: {what}", self.name), self.broken)
    }
}

/// The line that tells the body's length and checksum.
fn second_line(length: usize, sum: u64) -> String {
    format!("{length} bytes, checksum {sum:016x}")
}

/// The first line without its end, and the rest.
pub(crate) fn first_line(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = memchr::memchr(b'\n', bytes)?;
    Some((&bytes[..end], &bytes[end + 1..]))
}

/// The checksum of a body.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    rapidhash::v3::rapidhash_v3(bytes)
}

/// Little-endian numbers, one array after the other.
pub struct Arrays<'a> {
    rest: &'a [u8],
}

impl<'a> Arrays<'a> {
    /// The arrays in these bytes.
    pub fn of(rest: &'a [u8]) -> Self {
        Arrays { rest }
    }

    /// The next `count` numbers of 64 bits; `None` when they are not there.
    pub fn keys(&mut self, count: usize) -> Option<impl ExactSizeIterator<Item = u64> + 'a> {
        Some(self.take::<8>(count)?.iter().map(|key| u64::from_le_bytes(*key)))
    }

    /// Whether all have been taken.
    pub(crate) fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// The next `count` numbers of `N` bytes each; `None` when they are not there.
    pub(crate) fn take<const N: usize>(&mut self, count: usize) -> Option<&'a [[u8; N]]> {
        let (taken, rest) = self.rest.split_at_checked(count.checked_mul(N)?)?;
        self.rest = rest;
        Some(taken.as_chunks().0)
    }
}
