//! Atomic files: whoever opens the path sees the old content or the new one, never a part of either.
//!
//! ```text
//! write to a temporary file in the same directory → fsync → rename over the target → fsync of the directory
//! ```
//!
//! After `Ok` the content survives a power loss; after `Err` the target is as it was and the temporary file is gone.
//! A symbolic link is followed, so the file it points to is replaced and the link stays.
//! Leaves out: locking. Of two writers at once the last rename wins, whole; with [`write_new`] the first.

use std::fs::{self, File, Permissions};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use crate::error::LogError;

/// What a writer writes into, whatever it is: one type, so that writers are compiled once.
pub trait Output: Write + Seek + Send {}

impl<T: Write + Seek + Send> Output for T {}

/// Replaces the file at `path` by what `write` writes.
///
/// ```
/// let directory = tempfile::tempdir()?;
/// tribo_files::write_atomic(directory.path().join("a.txt"), |file| file.write_all(b"whole"))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LogError::IsDirectory`], [`LogError::NotRegularFile`], [`LogError::NotFound`] if the directory of `path` does not
/// exist, [`LogError::DirectoryNotWritable`], [`LogError::Io`] for an error of `write` or of the disk.
pub fn write_atomic(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), LogError> {
    let path = path.as_ref();
    replace(path, |file| write(file).map_err(|source| failed(path, "write", source)))
}

/// Creates the file at `path` with what `write` writes, unless there is one: of several who do so at once one succeeds, and all see its
/// whole content. Whether it was this one.
///
/// # Errors
/// Those of [`write_atomic`].
pub fn write_new(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<bool, LogError> {
    let path = path.as_ref();
    let temporary = written(path, |file| write(file).map_err(|source| failed(path, "write", source)))?;
    match temporary.persist_noclobber(path) {
        Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => return Ok(false),
        persisted => persisted.map_err(|e| failed(path, "create", e.error))?,
    };
    let directory = directory_of(path);
    sync_directory(directory).map_err(|e| failed(directory, "sync", e))?;
    Ok(true)
}

/// [`write_atomic`] for writers that seek and have errors of their own.
pub fn replace(path: &Path, write: impl FnOnce(&mut dyn Output) -> Result<(), LogError>) -> Result<(), LogError> {
    let target = resolve(path)?;
    let temporary = written(&target, write)?;
    named(temporary, &target)
}

/// A file that somebody fills little by little and that replaces the one at its path at the end.
pub struct AtomicFile {
    target: PathBuf,
}

impl AtomicFile {
    /// The file, and what to write into; dropping the latter leaves nothing.
    pub fn begin(path: &Path) -> Result<(Self, NamedTempFile), LogError> {
        let target = resolve(path)?;
        let temporary = create_in(directory_of(&target), &target)?;
        Ok((Self { target }, temporary))
    }

    /// Path of the file.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Puts what was written in its place.
    pub fn commit(&self, temporary: NamedTempFile) -> Result<(), LogError> {
        temporary.as_file().sync_all().map_err(|e| failed(&self.target, "sync", e))?;
        named(temporary, &self.target)
    }
}

/// Content under its name: the name, then the directory that holds it.
fn named(temporary: NamedTempFile, target: &Path) -> Result<(), LogError> {
    let directory = directory_of(target);
    temporary.persist(target).map_err(|e| failed(target, "replace", e.error))?;
    sync_directory(directory).map_err(|e| failed(directory, "sync", e))
}

/// Content, on disk under another name.
fn written(
    target: &Path,
    write: impl FnOnce(&mut dyn Output) -> Result<(), LogError>,
) -> Result<NamedTempFile, LogError> {
    let mut temporary = create_in(directory_of(target), target)?;
    let mut buffered = BufWriter::new(temporary.as_file_mut());
    write(&mut buffered)?;
    buffered.flush().map_err(|e| failed(target, "write", e))?;
    drop(buffered);
    temporary.as_file().sync_all().map_err(|e| failed(target, "sync", e))?;
    Ok(temporary)
}

fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// The file to replace: links followed, directories and devices refused.
fn resolve(path: &Path) -> Result<PathBuf, LogError> {
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => {
            Err(LogError::IsDirectory { path: path.to_path_buf(), expected: "regular (to be written)" })
        }
        Ok(found) if !found.is_file() => Err(LogError::NotRegularFile { path: path.to_path_buf() }),
        Ok(_) => fs::canonicalize(path).map_err(|e| failed(path, "open", e)),
        Err(_) => Ok(path.to_path_buf()),
    }
}

/// A temporary file beside the target, hidden, with the permissions the target has or a new file would get.
fn create_in(directory: &Path, target: &Path) -> Result<NamedTempFile, LogError> {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let prefix = format!(".{name}.");
    let existing = fs::metadata(target).map(|found| found.permissions()).ok();
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(".tmp");
    if let Some(permissions) = new_file_permissions() {
        builder.permissions(permissions);
    }
    let temporary = builder.tempfile_in(directory).map_err(|source| match source.kind() {
        io::ErrorKind::NotFound if !directory.exists() => LogError::NotFound { path: directory.to_path_buf() },
        _ => LogError::DirectoryNotWritable { directory: directory.to_path_buf(), source },
    })?;
    if let Some(permissions) = existing {
        temporary.as_file().set_permissions(permissions).map_err(|e| failed(target, "write", e))?;
    }
    Ok(temporary)
}

/// What `open` asks for; the umask takes its part. (`tempfile` would make the file private.)
#[cfg(unix)]
fn new_file_permissions() -> Option<Permissions> {
    Some(std::os::unix::fs::PermissionsExt::from_mode(0o666))
}

#[cfg(not(unix))]
fn new_file_permissions() -> Option<Permissions> {
    None
}

/// Makes the rename durable. File systems that cannot sync a directory say so with `InvalidInput`; that is not ours
/// to repair.
#[cfg(unix)]
fn sync_directory(directory: &Path) -> io::Result<()> {
    match File::open(directory)?.sync_all() {
        Err(e) if matches!(e.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => Ok(()),
        other => other,
    }
}

#[cfg(not(unix))]
fn sync_directory(_: &Path) -> io::Result<()> {
    Ok(())
}

/// An error of the disk.
pub fn failed(path: &Path, action: &'static str, source: io::Error) -> LogError {
    LogError::Io { path: path.to_path_buf(), action, source }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_failing_writer_leaves_the_old_content_and_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a");
        write_atomic(&path, |file| file.write_all(b"old")).unwrap();
        let failing =
            |file: &mut dyn Write| file.write_all(&[b'x'; 100_000]).and(Err(io::Error::other("disk on fire")));
        let error = write_atomic(&path, failing).unwrap_err();
        assert_eq!(error.to_string(), format!("{}: cannot write: disk on fire", path.display()));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(directory.path()), ["a"]);
    }

    #[test]
    fn a_missing_directory_and_a_directory_in_place_are_named() {
        let directory = tempfile::tempdir().unwrap();
        let missing = directory.path().join("no/file");
        assert!(matches!(write_atomic(&missing, |_| Ok(())), Err(LogError::NotFound { path }) if path.ends_with("no")));
        assert!(matches!(write_atomic(directory.path(), |_| Ok(())), Err(LogError::IsDirectory { .. })));
        assert!(
            matches!(write_atomic("/dev/null", |_| Ok(())), Err(LogError::NotRegularFile { .. })) || cfg!(not(unix))
        );
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_and_permissions_are_those_of_the_target() {
        use std::os::unix::fs::PermissionsExt;
        let directory = tempfile::tempdir().unwrap();
        let (path, link) = (directory.path().join("real"), directory.path().join("link"));
        write_atomic(&path, |file| file.write_all(b"1")).unwrap();
        assert_ne!(fs::metadata(&path).unwrap().permissions().mode() & 0o044, 0, "readable by others under umask 022");
        fs::set_permissions(&path, Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        write_atomic(&link, |file| file.write_all(b"2")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"2");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    }
}
