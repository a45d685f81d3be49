//! Files that commands write. Each appears under its name only when it is complete.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use nix::errno::Errno;
use nix::fcntl::{Flock, FlockArg};
use tempfile::TempPath;

use crate::console::cli::{Refused, unwritable};
use crate::console::progress::complain_above;
use crate::process::on_interrupt;

/// A file that is being written, without a buffer.
///
/// Until [`OutFile::finish`] it is a hidden file beside its name, `.NAME.part`, so that an existing
/// file survives an error, Ctrl-C and a full disk. The part is locked: a second command that writes
/// to the same name is refused. A part that a killed process left is used again.
#[derive(Debug)]
pub struct OutFile {
    option: &'static str,
    path: PathBuf,
    content: Content,
}

#[derive(Debug)]
enum Content {
    /// The part, which is removed when this is dropped, and its open file.
    Part(TempPath, Flock<File>),
    /// A device or a pipe, which is written directly.
    Device(File),
}

impl OutFile {
    /// A file that cannot be written is refused, so a command calls this before its work.
    pub fn create(option: &'static str, path: &Path) -> Result<Self, Refused> {
        let content = create(path).map_err(|error| unwritable(option, path, &error))?;
        Ok(Self {
            option,
            path: path.to_owned(),
            content,
        })
    }

    /// A symbolic link stays one, and its target is replaced.
    pub fn finish(self) -> anyhow::Result<()> {
        let Content::Part(part, _lock) = self.content else {
            return Ok(());
        };
        let named = part.persist(target(&self.path));
        named.map_err(|failure| {
            anyhow!(unwritable(self.option, &self.path, &failure.error).to_string())
        })
    }

    pub fn write_whole(mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.write_all(bytes).map_err(|error| self.failed(&error))?;
        self.finish()
    }

    /// The error has the words of a refusal, but the exit code 1.
    pub fn failed(&self, error: &io::Error) -> anyhow::Error {
        anyhow!(unwritable(self.option, &self.path, error).to_string())
    }

    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Write for OutFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.content {
            Content::Part(_, file) => file.write(bytes),
            Content::Device(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.content {
            Content::Part(_, file) => file.flush(),
            Content::Device(file) => file.flush(),
        }
    }
}

pub fn write(option: &'static str, path: &Path, bytes: impl AsRef<[u8]>) -> anyhow::Result<()> {
    let made = path.parent().map_or(Ok(()), fs::create_dir_all);
    made.map_err(|error| unwritable(option, path, &error))?;
    OutFile::create(option, path)?.write_whole(bytes.as_ref())
}

fn target(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

fn create(path: &Path) -> io::Result<Content> {
    let mut rights = None;
    match fs::metadata(path) {
        Ok(metadata) => {
            // A file that may not be changed is not replaced either.
            let opened = File::options().append(true).open(path)?;
            if !metadata.is_file() {
                return Ok(Content::Device(opened));
            }
            rights = Some(metadata.permissions());
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }

    let target = target(path);
    let name = target.file_name().ok_or(ErrorKind::InvalidInput)?;
    let hidden = [".".as_ref(), name, ".part".as_ref()];
    let part = target.with_file_name(hidden.into_iter().collect::<OsString>());
    let file = File::options()
        .write(true)
        .create(true)
        .truncate(false)
        .open(&part)?;

    // Between opening and locking, the other command may have renamed what was opened.
    let taken = || io::Error::other("another command is writing it");
    let file = Flock::lock(file, FlockArg::LockExclusiveNonblock).map_err(|(_, errno)| {
        if errno == Errno::EWOULDBLOCK {
            taken()
        } else {
            errno.into()
        }
    })?;
    let is_part = fs::metadata(&part).is_ok_and(|named| {
        file.metadata()
            .is_ok_and(|opened| named.ino() == opened.ino())
    });
    if !is_part {
        return Err(taken());
    }

    let (unfinished, path) = (part.clone(), path.to_owned());
    on_interrupt(move || {
        if fs::remove_file(unfinished).is_ok() {
            complain_above(format_args!("interrupted: {} not written", path.display()));
        }
    });
    let part = TempPath::try_from_path(part)?;
    file.set_len(0)?;
    if let Some(rights) = rights {
        file.set_permissions(rights)?;
    }
    Ok(Content::Part(part, file))
}
