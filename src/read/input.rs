//! Where texts come from: a file or standard input, as it is or packed by gzip or zstd.
//!
//! What is packed is known by its first bytes, wherever it comes from; a file that is named `.gz` or `.zst` must be what it says. Archives of several
//! parts, one behind the other, are read whole. One that is cut short or damaged is an error at the latest where its text ends: nothing is ever taken for
//! whole that is not.
//!
//! ```
//! use std::io::Write;
//!
//! let folder = tempfile::tempdir().expect("a folder");
//! let path = folder.path().join("pets.gz");
//! let file = std::fs::File::create(&path).expect("a file");
//! let mut packer = flate2::write::GzEncoder::new(file, Default::default());
//! packer.write_all(b"cat NN\n").and_then(|()| packer.finish()).expect("the disk takes it");
//!
//! assert_eq!(rollin::corpus::Corpus::read(&path)?.word(1, 0), "NN");
//! # Ok::<(), rollin::Error>(())
//! ```

use crate::error::{Error, Place, Result};
use flate2::bufread::MultiGzDecoder;
use ruzstd::decoding::FrameDecoder;
use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// The path that stands for standard input.
const STDIN: &str = "-";

/// Bytes read at a time.
const BUFFER: usize = 1 << 16;

/// Something to be read, unpacked.
pub type Input = Box<dyn BufRead + Send>;

/// What `path` is called in errors: standard input has a name of its own.
pub fn name(path: &Path) -> &Path {
    if path == Path::new(STDIN) { Path::new("<stdin>") } else { path }
}

/// The text at `path`, or on standard input where that is `-`, unpacked as it is read.
///
/// # Errors
/// When it cannot be read, standard input was opened before, or a file is named as an archive and is none. What is wrong within an archive is an error when that
/// is read.
pub fn open(path: impl AsRef<Path>) -> Result<Input> {
    let path = path.as_ref();
    plain(source(path)?, path)
}

/// `raw`, which comes from `path`, unpacked.
fn plain(mut raw: Input, path: &Path) -> Result<Input> {
    let head = head(&mut raw).map_err(|source| Error::io("read", name(path), source))?;
    let found = Packing::of(&head);
    if let Some(named) = Packing::named(path)
        && found != Some(named)
    {
        let problem = format!("named as packed by {}, but it is not", named.name());
        return Err(Error::file(path, problem, "pack it, or give it another name"));
    }
    let raw = Cursor::new(head).chain(raw);
    let whole = |raw| BufReader::with_capacity(BUFFER, Patient(raw));
    Ok(match found {
        None => Box::new(raw),
        Some(Packing::Gzip) => unpacked(Packing::Gzip, MultiGzDecoder::new(whole(raw))),
        Some(Packing::Zstd) => {
            unpacked(Packing::Zstd, Frames { raw: whole(raw), decoder: FrameDecoder::new(), open: false })
        }
    })
}

/// All of it.
///
/// # Errors
/// As [`open`], and when an archive is cut short or damaged.
pub fn bytes(path: impl AsRef<Path>) -> Result<Vec<u8>> {
    let path = path.as_ref();
    let mut bytes = Vec::new();
    open(path)?.read_to_end(&mut bytes).map_err(|source| Error::io("read", name(path), source))?;
    Ok(bytes)
}

/// All of it as characters.
///
/// # Errors
/// As [`bytes`], and with the exact place when it is not UTF-8.
pub fn text(path: impl AsRef<Path>) -> Result<String> {
    let path = path.as_ref();
    String::from_utf8(bytes(path)?).map_err(|error| {
        let place = Place::of(name(path), error.as_bytes(), error.utf8_error().valid_up_to());
        Error::data(place, "a byte that is not UTF-8", "text in UTF-8")
    })
}

/// The bytes at `path`, or on standard input where that is `-`, as they are.
///
/// # Errors
/// When it cannot be read, or standard input was opened before.
pub fn raw(path: impl AsRef<Path>) -> Result<Vec<u8>> {
    let path = path.as_ref();
    let mut bytes = Vec::new();
    source(path)?.read_to_end(&mut bytes).map_err(|source| Error::io("read", name(path), source))?;
    Ok(bytes)
}

/// The file, or standard input, which nobody can read twice.
fn source(path: &Path) -> Result<Input> {
    static TAKEN: AtomicBool = AtomicBool::new(false);
    if path != Path::new(STDIN) {
        let file = File::open(path).map_err(|source| Error::io("read", path, source))?;
        return Ok(Box::new(BufReader::with_capacity(BUFFER, file)));
    }
    if TAKEN.swap(true, Ordering::Relaxed) {
        return Err(Error::file(name(path), "read already", "give a file in place of one -"));
    }
    Ok(Box::new(BufReader::with_capacity(BUFFER, io::stdin())))
}

/// How a text is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Packing {
    Gzip,
    Zstd,
}

impl Packing {
    fn name(self) -> &'static str {
        match self {
            Packing::Gzip => "gzip",
            Packing::Zstd => "zstd",
        }
    }

    /// The one that begins like this: RFC 1952 section 2.3.1, RFC 8878 sections 3.1.1 and 3.1.2.
    fn of(head: &[u8]) -> Option<Self> {
        match head {
            [0x1f, 0x8b, ..] => Some(Packing::Gzip),
            [0x28, 0xb5, 0x2f, 0xfd, ..] | [0x50..=0x5f, 0x2a, 0x4d, 0x18, ..] => Some(Packing::Zstd),
            _ => None,
        }
    }

    /// The one that a file's name speaks of.
    fn named(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "gz" => Some(Packing::Gzip),
            "zst" => Some(Packing::Zstd),
            _ => None,
        }
    }
}

/// The first bytes, as many as may still be those of an archive: who types is not kept waiting.
fn head(raw: &mut impl Read) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    while matches!(head[..], [] | [0x1f] | [0x28] | [0x28, 0xb5] | [0x28, 0xb5, 0x2f])
        || matches!(head[..], [0x50..=0x5f] | [0x50..=0x5f, 0x2a] | [0x50..=0x5f, 0x2a, 0x4d])
    {
        if raw.take(1).read_to_end(&mut head)? == 0 {
            break;
        }
    }
    Ok(head)
}

/// Reads again where a signal interrupted: a decoder in the middle of a block could not.
struct Patient<R>(R);

impl<R: Read> Read for Patient<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            match self.0.read(buffer) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                done => return done,
            }
        }
    }
}

/// What `decoder` makes of an archive, with errors that say so.
fn unpacked(packing: Packing, decoder: impl Read + Send + 'static) -> Input {
    Box::new(BufReader::with_capacity(BUFFER, Unpacked { packing, decoder }))
}

/// A decoder whose errors say what is damaged.
struct Unpacked<R> {
    packing: Packing,
    decoder: R,
}

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.decoder.read(buffer).map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof | io::ErrorKind::InvalidData | io::ErrorKind::InvalidInput => {
                let name = self.packing.name();
                let problem = format!("{name} data that are cut short or damaged ({error}); expected a whole archive");
                io::Error::new(io::ErrorKind::InvalidData, problem)
            }
            _ => error,
        })
    }
}

/// The frames of a zstd archive, one after the other, with their checksums (RFC 8878 section 3).
struct Frames<R> {
    raw: R,
    decoder: FrameDecoder,
    /// Whether there is a frame that was not read to its end.
    open: bool,
}

impl<R: BufRead> Frames<R> {
    /// Opens the next frame; those that hold something else than data are skipped. False at the end.
    fn next(&mut self) -> io::Result<bool> {
        while !self.raw.fill_buf()?.is_empty() {
            match self.decoder.reset(&mut self.raw) {
                Ok(()) => return Ok(true),
                Err(FrameDecoderError::ReadFrameHeaderError(ReadFrameHeaderError::SkipFrame { length, .. })) => {
                    let length = u64::from(length);
                    if io::copy(&mut (&mut self.raw).take(length), &mut io::sink())? < length {
                        return Err(io::ErrorKind::UnexpectedEof.into());
                    }
                }
                Err(error) => return Err(broken(error)),
            }
        }
        Ok(false)
    }

    /// Refuses a frame that is not what was packed.
    fn check(&self) -> io::Result<()> {
        match self.decoder.get_checksum_from_data() {
            Some(sum) if self.decoder.get_calculated_checksum() != Some(sum) => Err(broken("its checksum is wrong")),
            _ => Ok(()),
        }
    }
}

/// Data that are no archive.
fn broken(what: impl ToString) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what.to_string())
}

impl<R: BufRead> Read for Frames<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while !buffer.is_empty() {
            if !self.open {
                self.open = self.next()?;
                if !self.open {
                    break;
                }
            }
            // A block at a time: no more is in memory than a window, which the decoder bounds.
            while self.decoder.can_collect() == 0 && !self.decoder.is_finished() {
                let blocks = ruzstd::decoding::BlockDecodingStrategy::UptoBlocks(1);
                self.decoder.decode_blocks(&mut self.raw, blocks).map_err(broken)?;
            }
            match self.decoder.read(buffer)? {
                0 => {
                    self.check()?;
                    self.open = false;
                }
                count => return Ok(count),
            }
        }
        Ok(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};
    use proptest::prelude::*;
    use ruzstd::encoding::{CompressionLevel, compress_to_vec};
    use std::io::Write;

    fn gzip(text: &[u8]) -> Vec<u8> {
        let mut packer = GzEncoder::new(Vec::new(), Compression::default());
        packer.write_all(text).and_then(|()| packer.finish()).expect("memory")
    }

    fn zstd(text: &[u8]) -> Vec<u8> {
        compress_to_vec(text, CompressionLevel::Fastest)
    }

    /// What is read of `raw`, which comes in pieces of `piece` bytes.
    fn read(raw: &[u8], piece: usize, path: &str) -> Result<Vec<u8>, String> {
        let raw = Box::new(BufReader::with_capacity(piece, Cursor::new(raw.to_vec())));
        let mut text = Vec::new();
        let mut input = plain(raw, path.as_ref()).map_err(|error| error.to_string())?;
        input.read_to_end(&mut text).map_err(|error| error.to_string())?;
        Ok(text)
    }

    /// Interrupted before every third piece, and broken after `whole` bytes.
    struct Faulty {
        bytes: Vec<u8>,
        piece: usize,
        calls: usize,
        at: usize,
        whole: usize,
    }

    impl Read for Faulty {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            self.calls += 1;
            match self.calls % 3 {
                0 => return Err(io::ErrorKind::Interrupted.into()),
                _ if self.at == self.whole && self.at < self.bytes.len() => return Err(io::ErrorKind::TimedOut.into()),
                _ => {}
            }
            let some = buffer.len().min(self.piece).min(self.bytes.len().min(self.whole) - self.at);
            buffer[..some].copy_from_slice(&self.bytes[self.at..self.at + some]);
            self.at += some;
            Ok(some)
        }
    }

    #[test]
    fn interruptions_and_faults() {
        let text: Vec<u8> = (0..999).flat_map(|i| format!("word{} X\n", i * i).into_bytes()).collect();
        for archive in [text.clone(), gzip(&text), zstd(&text)] {
            for piece in [1, 5, 100_000] {
                for whole in [usize::MAX, archive.len() / 2, archive.len() - 1, 5] {
                    let raw = Faulty { bytes: archive.clone(), piece, calls: 0, at: 0, whole };
                    let (mut read, raw) = (Vec::new(), Box::new(BufReader::with_capacity(64, raw)));
                    let done = plain(raw, "-".as_ref()).map(|mut input| input.read_to_end(&mut read));
                    let done = done.expect("its first bytes are there").map(|_| ());
                    match whole {
                        usize::MAX => assert!(done.is_ok() && read == text, "{done:?} by {piece}"),
                        _ => {
                            let error = done.expect_err("it broke");
                            assert!(text.starts_with(&read) && error.kind() != io::ErrorKind::Interrupted, "{error:?}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn what_a_name_says_must_be_so() {
        assert_eq!(
            read(b"a b\n", 9, "x.gz"),
            Err("x.gz: named as packed by gzip, but it is not; pack it, or give it another name".into())
        );
        assert!(read(&gzip(b"a"), 9, "x.ZST").is_err_and(|message| message.contains("by zstd")));
        assert_eq!(read(&gzip(b"a"), 9, "x.GZ"), Ok(b"a".to_vec()));
        // Neither is an archive as short as this.
        assert_eq!(read(b"P*", 9, "x"), Ok(b"P*".to_vec()));
        assert!(read(b"", 9, "x.gz").is_err());
    }

    #[test]
    fn frames_that_hold_something_else_are_skipped() {
        let note = [&[0x53, 0x2a, 0x4d, 0x18, 3, 0, 0, 0][..], b"???"].concat();
        let archive = [&note[..], &zstd(b"a\n"), &note, &note, &zstd(b""), &zstd(b"b\n"), &note].concat();
        for piece in [1, 7, 1000] {
            assert_eq!(read(&archive, piece, "-"), Ok(b"a\nb\n".to_vec()));
        }
        let short = &archive[..archive.len() - 1];
        assert!(
            read(short, 9, "-").is_err_and(|message| message.starts_with("zstd data that are cut short or damaged"))
        );
    }

    /// What the program of that name packed, with a checksum: `printf 'a b\n\n' | zstd -c`, and one of its bits turned.
    #[test]
    fn checksums_are_checked() {
        let mut archive = b"\x28\xb5\x2f\xfd\x04\x58\x29\0\0a b\n\n\xd7\x37\xa5\x98".to_vec();
        assert_eq!(read(&archive, 9, "x.zst"), Ok(b"a b\n\n".to_vec()));
        archive[9] ^= 1;
        let message = read(&archive, 9, "x.zst").expect_err("another word");
        assert_eq!(
            message,
            "zstd data that are cut short or damaged (its checksum is wrong); expected a whole archive"
        );
    }

    proptest! {
        #[test]
        fn parts_are_read_one_behind_the_other(parts in prop::collection::vec("[ab \n]{0,300}", 1..4), piece in 1..99usize) {
            let text = parts.concat().into_bytes();
            for pack in [gzip, zstd] {
                let archive: Vec<u8> = parts.iter().flat_map(|part| pack(part.as_bytes())).collect();
                prop_assert_eq!(read(&archive, piece, "-"), Ok(text.clone()));
            }
            prop_assert_eq!(read(&text, piece, "-"), Ok(text.clone()));
        }

        #[test]
        fn what_is_cut_short_is_refused(text in "[ab \n]{0,300}", cut in 4..1_000usize) {
            for pack in [gzip, zstd] {
                let archive = pack(text.as_bytes());
                let cut = 4 + cut % (archive.len() - 4);
                prop_assert!(read(&archive[..cut], 9, "-").is_err_and(|message| message.contains("expected a whole archive")), "{}", cut);
            }
        }

        /// A part of the head of gzip says nothing of the text; all else has a checksum.
        #[test]
        fn a_bit_that_turned_is_noticed(text in "[ab \n]{1,300}", at in any::<prop::sample::Index>(), bit in 0..8) {
            let mut archive = gzip(text.as_bytes());
            let at = 2 + at.index(archive.len() - 2);
            archive[at] ^= 1u8 << bit;
            if let Ok(read) = read(&archive, 9, "-") {
                prop_assert_eq!(read, text.into_bytes());
            }
        }

        #[test]
        fn no_bytes_panic(rest in prop::collection::vec(any::<u8>(), 0..60), zstd in any::<bool>()) {
            let head = if zstd { &[0x28, 0xb5, 0x2f, 0xfd][..] } else { &[0x1f, 0x8b, 8, 0] };
            let _ = read(&[head, &rest].concat(), 9, "-");
        }
    }
}
