//! Files that are whole or not there at all.

mod seal;

pub use seal::Arrays;
pub(crate) use seal::{Seal, checksum, first_line};

use crate::error::{Error, Result};
use std::io::{self, Write};
use std::path::Path;
use tempfile::NamedTempFile;

/// Checks that a file can be written to `path`, by making one beside it that is gone at once. What takes long asks first.
///
/// # Errors
/// When the system refuses, a directory stands at `path`, or `path` is `-`: standard output takes what a command has to say.
#[cfg(feature = "cli")]
pub fn check_writable(path: &Path) -> Result<()> {
    if path == Path::new("-") {
        let problem = "a file is to be written, and standard output has the report";
        return Err(Error::file(path, problem, "give a name, or ./- for a file of this name"));
    }
    if path.is_dir() {
        return Err(Error::io("write", path, io::ErrorKind::IsADirectory.into()));
    }
    beside(path).map(drop)
}

/// Writes `bytes` to `path`: to a new file beside it, which is flushed to the disk and then renamed; the folder is flushed, too, so that the new name
/// outlives a loss of power.
///
/// # Errors
/// When the system refuses; whatever stood at `path` is then still there.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let refused = |source| Error::io("write", path, source);
    let mut file = beside(path)?;
    file.write_all(bytes).map_err(refused)?;
    file.as_file().sync_all().map_err(refused)?;
    file.persist(path).map_err(|error| refused(error.error))?;
    #[cfg(unix)]
    flush_folder(folder(path)).map_err(refused)?;
    Ok(())
}

/// Flushes the names in a folder, where it may be read and its file system knows of such a thing.
#[cfg(unix)]
fn flush_folder(folder: &Path) -> io::Result<()> {
    let Ok(folder) = std::fs::File::open(folder) else { return Ok(()) };
    match folder.sync_all() {
        Err(error) if matches!(error.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => Ok(()),
        done => done,
    }
}

/// The folder that `path` is in.
fn folder(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// What the names of files begin with that are still being written.
pub(crate) const BESIDE: &str = ".rollin-";

/// A new file beside `path`, which is deleted when dropped.
fn beside(path: &Path) -> Result<NamedTempFile> {
    let folder = folder(path);
    let mut builder = tempfile::Builder::new();
    builder.prefix(BESIDE);
    // As any new file: what the user's mask allows, not only its owner.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder).map_err(|error| {
        // That error names the file beside, of which nobody has heard: what is wrong with the folder says more.
        let source = std::fs::metadata(folder).err().unwrap_or_else(|| error.kind().into());
        Error::io("write", path, source)
    })
}
