//! Files that are whole or not there at all.

use crate::error::{Error, Result};
use std::io::Write;
use std::path::Path;

/// Writes `bytes` to `path`: to a new file beside it, which is flushed to the disk and then renamed.
///
/// # Errors
/// When the system refuses; whatever stood at `path` is then still there.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let refused = |source| Error::io("write", path, source);
    let mut builder = tempfile::Builder::new();
    builder.prefix(".rollin-");
    // As any new file: what the user's mask allows, not only its owner.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(refused)?;
    file.write_all(bytes).map_err(refused)?;
    file.as_file().sync_all().map_err(refused)?;
    file.persist(path).map_err(|error| refused(error.error))?;
    Ok(())
}
