//! Files that commands write. Each appears under its name only when it is complete.

use std::fs::{self, File, Permissions};
use std::io::{self, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use tempfile::NamedTempFile;

use crate::process::remove_on_interrupt;
use console::cli::{Refused, unwritable};

/// A file that is being written. It implements [`Write`], without a buffer.
///
/// Two commands may write to one name at the same time. The file that is completed last then has
/// the name. If this is dropped before [`OutFile::finish`], or the process is interrupted, the
/// temporary file is removed and an existing file of this name remains unchanged. A process that is
/// killed leaves the temporary file, `.double-pendulum-*`. A device or a pipe is written directly
/// and keeps the bytes written so far.
#[derive(Debug)]
pub struct OutFile {
    /// The option in errors.
    option: &'static str,
    path: PathBuf,
    content: Content,
}

#[derive(Debug)]
enum Content {
    /// A temporary file of this process in the folder of the final one.
    Temporary(NamedTempFile),
    /// A device or a pipe, which is written directly.
    Device(File),
}

impl OutFile {
    /// Begins the file that `option` names (such as `--out`), as a temporary file in the same
    /// folder, or in the folder of the target of a symbolic link that has one. The folder must
    /// exist and be writable, and an existing file must be writable, too, and no folder; else this
    /// is refused. A device or a pipe is opened and written directly; a named pipe without a reader
    /// blocks this. From now on an interrupt ends the process ([`remove_on_interrupt`]).
    pub fn create(option: &'static str, path: &Path) -> Result<Self, Refused> {
        let content = Content::create(path).map_err(|error| unwritable(option, path, &error))?;
        Ok(Self {
            option,
            path: path.to_owned(),
            content,
        })
    }

    /// Gives the file its name and replaces an existing file, with the access rights that it had at
    /// [`OutFile::create`]. A new file can be read and written by everybody. The umask reduces
    /// both. A symbolic link stays, and its target is replaced; without a target the link is. If
    /// that is not possible, the written file is removed and the error names the option. For a
    /// device or a pipe it does nothing. It does not wait for the disk.
    pub fn finish(self) -> anyhow::Result<()> {
        let Self {
            option,
            path,
            content,
        } = self;
        match content {
            Content::Device(_) => Ok(()),
            Content::Temporary(file) => {
                // A link stays one, and its target is replaced.
                let target = path.canonicalize().unwrap_or_else(|_| path.clone());
                let named = file.persist(target).map(drop);
                named.map_err(|failure| {
                    anyhow!(unwritable(option, &path, &failure.error).to_string())
                })
            }
        }
    }

    /// Writes the rest of the file: all bytes, after those written so far, then
    /// [`OutFile::finish`]. An error, which names the option and the file, leaves an existing file
    /// unchanged.
    pub fn write_whole(mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.write_all(bytes).map_err(|error| self.failed(&error))?;
        self.finish()
    }

    /// Returns the error of a command whose file could not be written to the end. It has the words
    /// of [`unwritable`], with the option and the file, but is no refusal: its exit code is 1.
    pub fn failed(&self, error: &io::Error) -> anyhow::Error {
        anyhow!(unwritable(self.option, &self.path, error).to_string())
    }
}

impl Content {
    /// Opens a device or makes the temporary file.
    fn create(path: &Path) -> io::Result<Self> {
        const ANYONE: u32 = 0o666; // reduced by the umask
        let mut mode = ANYONE;
        match fs::metadata(path) {
            Ok(metadata) => {
                // A file that may not be changed is not replaced either.
                let opened = File::options().append(true).open(path)?;
                if !metadata.is_file() {
                    return Ok(Self::Device(opened));
                }
                mode = metadata.permissions().mode();
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            // No file can have this name.
            Err(error) => return Err(error),
        }

        // The temporary file is in the same folder, so that it can be renamed.
        let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let file = tempfile::Builder::new()
            .prefix(".double-pendulum-")
            .permissions(Permissions::from_mode(mode))
            .tempfile_in(folder)
            .map_err(without_path)?;
        remove_on_interrupt(file.path());
        Ok(Self::Temporary(file))
    }
}

/// Returns the system's own words, which do not name the temporary file.
fn without_path(error: io::Error) -> io::Error {
    let text = error.to_string();
    let reason = text.split(" at path ").next().unwrap_or_default();
    io::Error::new(error.kind(), reason)
}

impl Write for OutFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.content {
            Content::Temporary(file) => file.as_file_mut().write(bytes),
            Content::Device(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.content {
            Content::Temporary(file) => file.as_file_mut().flush(),
            Content::Device(file) => file.flush(),
        }
    }
}

/// Returns an error if a file cannot be written, before the work for it begins. An existing file
/// remains unchanged, and a new one is not left behind. The refusal names the option and the file.
/// It tries by [`OutFile::create`], with the same effects on a pipe and on interrupts. The reader
/// of a named pipe then sees its end.
pub fn check_writable(option: &'static str, path: &Path) -> Result<(), Refused> {
    OutFile::create(option, path).map(drop)
}

/// Writes a complete file in the folder that `--out` names, and creates the folder and those above
/// it. `path` is that of the file. It replaces an existing file, as an [`OutFile`] does. An error
/// names the option and the file. A folder or a file that cannot be created is refused.
pub fn write(path: &Path, bytes: impl AsRef<[u8]>) -> anyhow::Result<()> {
    create_in_folder(path)?.write_whole(bytes.as_ref())
}

/// Returns an error if [`write`] would refuse this file, before the work for it begins. Creates the
/// folders.
pub fn check_in_folder(path: &Path) -> Result<(), Refused> {
    create_in_folder(path).map(drop)
}

/// Creates the folders of a file for `--out`, and begins the file.
fn create_in_folder(path: &Path) -> Result<OutFile, Refused> {
    let made = path.parent().map_or(Ok(()), fs::create_dir_all);
    made.map_err(|error| unwritable("--out", path, &error))?;
    OutFile::create("--out", path)
}
