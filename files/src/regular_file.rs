//! Safe opening of untrusted paths: refuses devices, pipes and, for writing, symbolic links.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use crc32fast::Hasher;

/// Length and checksum of a file or of its first bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FileDigest {
    /// Length, in bytes.
    pub length: u64,
    /// CRC-32 of these bytes as in zlib; detects accidental but not intentional damage.
    pub checksum: u32,
}

impl FileDigest {
    /// Length and checksum of bytes in memory.
    pub fn from_bytes(bytes: &[u8]) -> Self {
        Self { length: bytes.len() as u64, checksum: crate::checksum(bytes) }
    }

    /// Length and checksum of a file, read in blocks.
    ///
    /// # Errors
    /// The path is not a regular file or cannot be read.
    pub fn from_file(path: &Path) -> io::Result<Self> {
        Self::from_reader(open_regular_file(path)?)
    }

    /// Length and checksum of the first `length` bytes of a file, or of all bytes of a shorter one.
    ///
    /// # Errors
    /// The path is not a regular file or cannot be read.
    pub fn from_prefix(path: &Path, length: u64) -> io::Result<Self> {
        Self::from_reader(open_regular_file(path)?.take(length))
    }

    fn from_reader(mut reader: impl Read) -> io::Result<Self> {
        let (mut hasher, mut bytes, mut length) = (Hasher::new(), vec![0; 1 << 16], 0);
        loop {
            match reader.read(&mut bytes) {
                Ok(0) => return Ok(Self { length, checksum: hasher.finalize() }),
                Ok(count) => {
                    hasher.update(&bytes[..count]);
                    length += count as u64;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }
}

/// Writer that computes the length and the checksum of the bytes it writes. If bytes are overwritten, it computes the
/// checksum from the finished file instead.
pub struct DigestWriter<W> {
    writer: W,
    hasher: Hasher,
    length: u64,
    position: u64,
    /// Whether bytes have been overwritten that the hasher has processed.
    is_overwritten: bool,
}

impl<W: Write> DigestWriter<W> {
    /// Creates a writer to `writer`, whose position is its beginning.
    pub fn new(writer: W) -> Self {
        Self { writer, hasher: Hasher::new(), length: 0, position: 0, is_overwritten: false }
    }
}

impl<W: Read + Write + Seek> DigestWriter<W> {
    /// Returns length and checksum of all bytes.
    ///
    /// # Errors
    /// Overwritten bytes cannot be read again.
    pub fn finish(mut self) -> io::Result<FileDigest> {
        self.writer.flush()?;
        if !self.is_overwritten {
            return Ok(FileDigest { length: self.length, checksum: self.hasher.finalize() });
        }
        self.writer.rewind()?;
        FileDigest::from_reader(self.writer)
    }
}

impl<W: Write> Write for DigestWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.writer.write(bytes)?;
        // Bytes beyond a gap would be missing too.
        self.is_overwritten |= self.position != self.length;
        if !self.is_overwritten {
            self.hasher.update(&bytes[..count]);
        }
        self.position += count as u64;
        self.length = self.length.max(self.position);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl<W: Seek> Seek for DigestWriter<W> {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.position = self.writer.seek(position)?;
        Ok(self.position)
    }
}

/// Opens a regular file for reading; refuses pipes and devices, which may block or never end.
///
/// # Errors
/// The path, after following symbolic links, is not a regular file or cannot be opened.
pub fn open_regular_file(path: &Path) -> io::Result<File> {
    let file = set_nonblocking(File::options().read(true)).open(path)?;
    refuse_irregular(&file.metadata()?)?;
    Ok(file)
}

/// Reads a regular file into memory.
///
/// # Errors
/// The path, after following symbolic links, is not a regular file, cannot be read, or does not fit into memory.
pub fn read_regular_file(path: &Path) -> io::Result<Vec<u8>> {
    read_regular_file_up_to(path, u64::MAX)
}

/// Reads a regular file of at most `max_length` bytes into memory.
///
/// # Errors
/// The file is larger, or an error of [`read_regular_file`].
pub fn read_regular_file_up_to(path: &Path, max_length: u64) -> io::Result<Vec<u8>> {
    let file = open_regular_file(path)?;
    let length = file.metadata()?.len();
    if length > max_length {
        let found = format!("{length} bytes, more than the {max_length} that it may have");
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, found));
    }
    let mut bytes = Vec::new();
    try_read_to_end(file.take(length), length, &mut bytes)?;
    Ok(bytes)
}

/// Reads a reader to its end, about `expected_length` bytes, into a buffer; failure to allocate memory is an error.
pub(crate) fn try_read_to_end(
    mut reader: impl Read,
    expected_length: u64,
    bytes: &mut Vec<u8>,
) -> io::Result<()> {
    let no_memory = |_| io::Error::from(io::ErrorKind::OutOfMemory);
    let mut block = vec![0; (1 << 16).min(expected_length as usize).max(1)];
    loop {
        match reader.read(&mut block) {
            Ok(0) => return Ok(()),
            Ok(count) => {
                if bytes.capacity() - bytes.len() < count {
                    // Reserve the expected length, at most 64 MiB at a time.
                    let expected = usize::try_from(expected_length).unwrap_or(usize::MAX);
                    let more = expected.saturating_sub(bytes.len()).clamp(count, 1 << 26);
                    bytes.try_reserve(more.max(count)).map_err(no_memory)?;
                }
                bytes.extend_from_slice(&block[..count]);
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// Opens a regular file for reading and writing without following symbolic links.
///
/// # Errors
/// The path is not a regular file or cannot be opened.
pub(crate) fn open_for_update(path: &Path) -> io::Result<File> {
    refuse_link(path)?;
    let file = set_no_follow(File::options().read(true).write(true)).open(path)?;
    refuse_irregular(&file.metadata()?)?;
    Ok(file)
}

/// Opens a regular file for appending, created if missing, without following symbolic links.
///
/// # Errors
/// The path is not a regular file or cannot be opened.
pub fn open_to_append(path: &Path) -> io::Result<File> {
    refuse_link(path)?;
    let file = set_no_follow(File::options().append(true).create(true)).open(path)?;
    refuse_irregular(&file.metadata()?)?;
    Ok(file)
}

/// Checks that the path is not a symbolic link; its message is clearer than that of the operating system.
fn refuse_link(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(metadata) if metadata.is_symlink() => {
            Err(io::Error::new(io::ErrorKind::InvalidInput, "a symbolic link"))
        }
        _ => Ok(()),
    }
}

fn refuse_irregular(metadata: &Metadata) -> io::Result<()> {
    match metadata.is_file() {
        true => Ok(()),
        false if metadata.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        false => Err(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file")),
    }
}

/// Whether an open file is the file at `path`, by device and inode number; always true on systems other than Unix.
pub(crate) fn is_file_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let identity = |metadata: Metadata| (metadata.dev(), metadata.ino());
        let found = fs::symlink_metadata(path).map(identity);
        matches!((file.metadata().map(identity), found), (Ok(opened), Ok(found)) if opened == found)
    }
    #[cfg(not(unix))]
    {
        let _ = (file, path);
        true
    }
}

/// Sets, on Unix, non-blocking mode, so that opening a pipe does not wait.
fn set_nonblocking(options: &mut OpenOptions) -> &mut OpenOptions {
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(libc::O_NONBLOCK | libc::O_NOCTTY);
    }
    options
}

/// Sets, on Unix, non-blocking mode, and refuses symbolic links.
fn set_no_follow(options: &mut OpenOptions) -> &mut OpenOptions {
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(libc::O_NONBLOCK | libc::O_NOCTTY | libc::O_NOFOLLOW);
    }
    options
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digests_of_files_and_prefixes_match_those_of_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let bytes: Vec<u8> = (0..200_000_u32).map(|i| (i.wrapping_mul(i) >> 5) as u8).collect();
        fs::write(&path, &bytes).unwrap();
        assert_eq!(FileDigest::from_file(&path).unwrap(), FileDigest::from_bytes(&bytes));
        // Published check value of CRC-32 for these nine digits.
        assert_eq!(
            FileDigest::from_bytes(b"123456789"),
            FileDigest { length: 9, checksum: 0xcbf4_3926 }
        );
        for length in [0, 1, 65_536, 70_001, 200_000, 300_000] {
            let start = &bytes[..length.min(bytes.len())];
            assert_eq!(
                FileDigest::from_prefix(&path, length as u64).unwrap(),
                FileDigest::from_bytes(start)
            );
        }
        assert!(read_regular_file(&path).unwrap() == bytes);
        assert!(read_regular_file_up_to(&path, 200_000).unwrap() == bytes);
        let error = read_regular_file_up_to(&path, 199_999).unwrap_err();
        assert_eq!(error.to_string(), "200000 bytes, more than the 199999 that it may have");
        assert!(FileDigest::from_file(folder.path()).is_err());
    }

    #[test]
    fn digests_count_overwritten_bytes() {
        use std::io::Cursor;
        let mut writer = DigestWriter::new(Cursor::new(Vec::new()));
        writer.write_all(b"0000").unwrap();
        writer.write_all(b"56789").unwrap();
        writer.rewind().unwrap();
        writer.write_all(b"1234").unwrap();
        writer.seek(SeekFrom::End(0)).unwrap();
        writer.write_all(b"0").unwrap();
        assert_eq!(writer.finish().unwrap(), FileDigest::from_bytes(b"1234567890"));
        let mut writer = DigestWriter::new(Cursor::new(Vec::new()));
        writer.write_all(b"123456").unwrap();
        writer.write_all(b"789").unwrap();
        assert_eq!(writer.finish().unwrap(), FileDigest::from_bytes(b"123456789"));
    }

    #[cfg(unix)]
    #[test]
    fn pipes_devices_and_links_are_refused_without_blocking() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for path in [pipe.as_path(), Path::new("/dev/zero"), folder.path()] {
            assert!(open_regular_file(path).is_err(), "{}", path.display());
            assert!(open_for_update(path).is_err(), "{}", path.display());
            assert!(open_to_append(path).is_err(), "{}", path.display());
        }
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "kept").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        assert_eq!(read_regular_file(&link).unwrap(), b"kept");
        for refused in [open_for_update(&link), open_to_append(&link)] {
            assert_eq!(refused.unwrap_err().to_string(), "a symbolic link");
        }
        assert_eq!(fs::read(&file).unwrap(), b"kept");
    }
}
