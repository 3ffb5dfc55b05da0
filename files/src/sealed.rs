//! Checkpoint file format: named sections of bytes with checksums, so that damage to a file is detected on reading.
//!
//! All numbers are little-endian. A file begins with an opening of 28 bytes, the same in every version of the format:
//! eight magic bytes, the format version (4 bytes), the number of sections (4), the length of the file in bytes (8)
//! and the checksum (4) of these 24 bytes. A section consists of the length of its name (4), the length of its
//! content (8), the name, the checksum (4) of these three, the content, and the checksum (4) of the content. The file
//! ends with the checksum (4) of the concatenation of all these parts without their checksums. Checksums are CRC-32
//! as in zlib: they detect accidental but not intentional damage.

use std::collections::HashSet;
use std::io::{self, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use crc32fast::Hasher;

use crate::open::open_regular;
use crate::{FileError, write_atomically_with};

// The first byte is not ASCII, and the line ends are altered by text-mode transfers.
const MAGIC: [u8; 8] = *b"\x89seal\r\n\x1a";
/// Version of the format written and read by this module.
const VERSION: u32 = 1;
/// Length of the opening, bytes.
const OPENING: usize = 28;
const SECTION_HEAD: usize = 12;
const CHECKSUM: usize = 4;

/// Error of reading a file of sections.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct SealedError {
    /// Path of the file.
    pub path: PathBuf,
    /// Cause of the error.
    #[source]
    pub problem: Problem,
}

/// Cause of a [`SealedError`].
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The operating system refused to open or to read the file.
    #[error("cannot be read: {0}")]
    Read(#[from] io::Error),
    /// The file is not of this format.
    #[error("is not a file of sealed sections")]
    NotSealed,
    /// The file has a different version of the format.
    #[error("has format version {found} where this program reads version {VERSION}")]
    Version {
        /// Version of the file.
        found: u32,
    },
    /// The file is shorter than stated in it, or than the minimum length.
    #[error("is truncated at {found} bytes: {expected} are needed")]
    Truncated {
        /// Length of the file, in bytes.
        found: u64,
        /// Length stated in the file, or the minimum length, bytes.
        expected: u64,
    },
    /// The file is longer than stated in it.
    #[error("has {found} bytes where it says {expected}")]
    TooLong {
        /// Length of the file, in bytes.
        found: u64,
        /// Length stated in the file, bytes.
        expected: u64,
    },
    /// The opening before the first section is damaged.
    #[error("is damaged in its opening")]
    Opening,
    /// The name or the lengths of a section are damaged.
    #[error("is damaged in the name or the lengths of section {number}")]
    SectionHead {
        /// Number of the section, counted from 1.
        number: u32,
    },
    /// The content of a section is damaged.
    #[error("is damaged in section \"{name}\"")]
    Section {
        /// Name of the section.
        name: String,
    },
    /// Each section is valid, but the checksum of the entire file does not match.
    #[error("is damaged: the checksum of the whole does not match")]
    Whole,
    /// There is not enough memory for a section.
    #[error("section \"{name}\" of {length} bytes does not fit into memory")]
    Memory {
        /// Name of the section.
        name: String,
        /// Length of the section, in bytes.
        length: u64,
    },
}

/// Writes sections to a file atomically (see [`crate::write_atomically`]), without copying the contents. Duplicate
/// names are refused.
pub fn write_sealed(path: &Path, sections: &[(&str, &[u8])]) -> Result<(), FileError> {
    let opening = opening(sections).map_err(|source| FileError {
        path: path.to_path_buf(),
        action: "write",
        source,
    })?;
    write_atomically_with(path, |file| write(file, &opening, sections))
}

/// Reads the sections of a file, in the order of writing. Any changed byte is an error; stated lengths are checked
/// against the length of the file before memory is allocated.
pub fn read_sealed(path: &Path) -> Result<Vec<(String, Vec<u8>)>, SealedError> {
    let opened = open_regular(path).and_then(|file| Ok((file.metadata()?.len(), file)));
    opened
        .map_err(Problem::Read)
        .and_then(|(length, file)| read(BufReader::new(file), length))
        .map_err(|problem| SealedError { path: path.to_path_buf(), problem })
}

fn refused(reason: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, reason)
}

/// Writer with the running checksum of all parts. The checksums of the parts are excluded, since the CRC of data
/// followed by their own CRC is constant.
struct Sealing<W> {
    writer: W,
    whole: Hasher,
}

impl<W: Write> Sealing<W> {
    /// Writes bytes and their checksum.
    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut own = Hasher::new();
        own.update(bytes);
        self.whole.combine(&own);
        self.writer.write_all(bytes)?;
        self.writer.write_all(&own.finalize().to_le_bytes())
    }
}

fn write(writer: impl Write, opening: &[u8], sections: &[(&str, &[u8])]) -> io::Result<()> {
    let mut sealing = Sealing { writer, whole: Hasher::new() };
    sealing.put(opening)?;
    for (name, content) in sections {
        let mut head = (name.len() as u32).to_le_bytes().to_vec();
        head.extend((content.len() as u64).to_le_bytes());
        head.extend(name.as_bytes());
        sealing.put(&head)?;
        sealing.put(content)?;
    }
    let Sealing { mut writer, whole } = sealing;
    writer.write_all(&whole.finalize().to_le_bytes())
}

/// Formats the opening of the file without its checksum; an error if the sections cannot be represented.
fn opening(sections: &[(&str, &[u8])]) -> io::Result<Vec<u8>> {
    let mut names = HashSet::new();
    if let Some((name, _)) = sections.iter().find(|(name, _)| !names.insert(name)) {
        return Err(refused(format!("two sections are named \"{name}\"")));
    }
    if sections.iter().any(|(name, _)| u32::try_from(name.len()).is_err()) {
        return Err(refused("the name of a section is too long".to_owned()));
    }
    let count = u32::try_from(sections.len())
        .map_err(|_| refused("there are too many sections".to_owned()))?;
    let length = |&(name, content): &(&str, &[u8])| {
        (SECTION_HEAD + 2 * CHECKSUM) as u64 + name.len() as u64 + content.len() as u64
    };
    let total = (OPENING + CHECKSUM) as u64 + sections.iter().map(length).sum::<u64>();
    let mut bytes = MAGIC.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(count.to_le_bytes());
    bytes.extend(total.to_le_bytes());
    Ok(bytes)
}

/// Reader with the running checksum of all parts and the number of remaining bytes.
struct Unsealing<R> {
    reader: R,
    whole: Hasher,
    left: u64,
}

impl<R: Read> Unsealing<R> {
    /// Reads exactly the next `bytes.len()` bytes.
    fn fill(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self.left = self.left.saturating_sub(bytes.len() as u64);
        self.reader.read_exact(bytes)
    }

    /// Reads the next bytes of a part and returns their hash.
    fn take(&mut self, bytes: &mut [u8]) -> io::Result<Hasher> {
        self.fill(bytes)?;
        let mut own = Hasher::new();
        own.update(bytes);
        self.whole.combine(&own);
        Ok(own)
    }

    /// Reads a checksum and compares it with the hash `own`.
    fn confirms(&mut self, own: Hasher) -> io::Result<bool> {
        let mut stored = [0; CHECKSUM];
        self.fill(&mut stored)?;
        Ok(own.finalize() == u32::from_le_bytes(stored))
    }

    /// Whether `length` bytes and two checksums fit into the remaining bytes.
    fn can_hold(&self, length: u64) -> bool {
        length.checked_add(2 * CHECKSUM as u64).is_some_and(|length| length <= self.left)
    }

    /// Reads name and content length of the next section; `None` if damaged.
    fn section_head(&mut self) -> io::Result<Option<(String, u64)>> {
        if !self.can_hold(SECTION_HEAD as u64) {
            return Ok(None);
        }
        let mut lengths = [0; SECTION_HEAD];
        let mut own = self.take(&mut lengths)?;
        let (name_length, length) = (u32_at(&lengths, 0), u64_at(&lengths, 4));
        if !self.can_hold(name_length.into()) {
            return Ok(None);
        }
        let Some(mut name) = zeros(name_length.into()) else { return Ok(None) };
        own.combine(&self.take(&mut name)?);
        if !self.confirms(own)? || !self.can_hold(length) {
            return Ok(None);
        }
        Ok(String::from_utf8(name).ok().map(|name| (name, length)))
    }

    /// Reads the next section, with number `number`.
    fn section(&mut self, number: u32) -> Result<(String, Vec<u8>), Problem> {
        let head = self.section_head()?;
        let (name, length) = head.ok_or(Problem::SectionHead { number })?;
        let Some(mut content) = zeros(length) else {
            return Err(Problem::Memory { name, length });
        };
        let own = self.take(&mut content)?;
        if !self.confirms(own)? {
            return Err(Problem::Section { name });
        }
        Ok((name, content))
    }
}

/// Allocates a zeroed buffer of a verified length; `None` if it does not fit into memory.
fn zeros(length: u64) -> Option<Vec<u8>> {
    let length = usize::try_from(length).ok()?;
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length).ok()?;
    bytes.resize(length, 0);
    Some(bytes)
}

fn u32_at(bytes: &[u8], start: usize) -> u32 {
    let read = |number, &byte: &u8| number << 8 | u32::from(byte);
    bytes[start..start + 4].iter().rev().fold(0, read)
}

fn u64_at(bytes: &[u8], start: usize) -> u64 {
    u64::from(u32_at(bytes, start)) | u64::from(u32_at(bytes, start + 4)) << 32
}

fn read(reader: impl Read, found: u64) -> Result<Vec<(String, Vec<u8>)>, Problem> {
    let mut unsealing = Unsealing { reader, whole: Hasher::new(), left: found };
    let count = read_opening(&mut unsealing, found)?;
    // No capacity is reserved, since the number of sections has not been checked against the length of the file.
    let mut sections = Vec::new();
    for number in 1..=count {
        sections.push(unsealing.section(number)?);
    }
    let whole = unsealing.whole.clone();
    let confirmed = unsealing.left == CHECKSUM as u64 && unsealing.confirms(whole)?;
    if confirmed { Ok(sections) } else { Err(Problem::Whole) }
}

/// Reads the opening, checks the stated length against the length `found`, and returns the number of sections.
fn read_opening(unsealing: &mut Unsealing<impl Read>, found: u64) -> Result<u32, Problem> {
    let mut bytes = [0; OPENING];
    let there = usize::try_from(found).unwrap_or(OPENING).min(OPENING);
    unsealing.fill(&mut bytes[..there])?;
    let magic = there.min(MAGIC.len());
    if magic == 0 || bytes[..magic] != MAGIC[..magic] {
        return Err(Problem::NotSealed);
    }
    let least = (OPENING + CHECKSUM) as u64;
    if found < least {
        return Err(Problem::Truncated { found, expected: least });
    }
    unsealing.whole.update(&bytes[..OPENING - CHECKSUM]);
    if unsealing.whole.clone().finalize() != u32_at(&bytes, OPENING - CHECKSUM) {
        return Err(Problem::Opening);
    }
    let (version, count, expected) = (u32_at(&bytes, 8), u32_at(&bytes, 12), u64_at(&bytes, 16));
    if version != VERSION {
        return Err(Problem::Version { found: version });
    }
    match found.cmp(&expected) {
        std::cmp::Ordering::Less => Err(Problem::Truncated { found, expected }),
        std::cmp::Ordering::Greater => Err(Problem::TooLong { found, expected }),
        std::cmp::Ordering::Equal => Ok(count),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    const SECTIONS: [(&str, &[u8]); 4] =
        [("state", b"\x00\x01\xff and more"), ("empty", b""), ("", b"nameless"), ("σ", b"x")];

    fn sealed(sections: &[(&str, &[u8])]) -> Vec<u8> {
        let mut bytes = Vec::new();
        write(&mut bytes, &opening(sections).unwrap(), sections).unwrap();
        bytes
    }

    fn unsealed(bytes: &[u8]) -> Result<Vec<(String, Vec<u8>)>, Problem> {
        read(bytes, bytes.len() as u64)
    }

    /// Replaces bytes at `at` in the opening or a section head, and updates the checksum that follows the range
    /// `checked`.
    fn forged(
        mut bytes: Vec<u8>,
        at: usize,
        new: &[u8],
        checked: std::ops::Range<usize>,
    ) -> Vec<u8> {
        bytes[at..at + new.len()].copy_from_slice(new);
        let checksum = crc32fast::hash(&bytes[checked.clone()]).to_le_bytes();
        bytes[checked.end..checked.end + CHECKSUM].copy_from_slice(&checksum);
        bytes
    }

    fn assert_sections(found: &[(String, Vec<u8>)], expected: &[(&str, &[u8])]) {
        let found: Vec<_> = found.iter().map(|(name, content)| (&name[..], &content[..])).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn sections_come_back_from_disk() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoints/last");
        write_sealed(&path, &SECTIONS).unwrap();
        assert_sections(&read_sealed(&path).unwrap(), &SECTIONS);
        assert_eq!(fs::read(&path).unwrap(), sealed(&SECTIONS));
        write_sealed(&path, &[]).unwrap();
        assert_sections(&read_sealed(&path).unwrap(), &[]);
        let large: Vec<u8> = (0..3_000_000_u32).map(|i| (i.wrapping_mul(i) >> 7) as u8).collect();
        let sections = [("large", &large[..]), ("small", b"s")];
        write_sealed(&path, &sections).unwrap();
        assert_sections(&read_sealed(&path).unwrap(), &sections);
    }

    #[test]
    fn the_format_stays_as_it_is() {
        let bytes = sealed(&[("a", b"bc")]);
        let expected = "897365616c0d0a1a 01000000 01000000 3700000000000000";
        let text: String = bytes[..24].iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(text, expected.replace(' ', ""));
        assert_eq!(bytes[28..41], *b"\x01\0\0\0\x02\0\0\0\0\0\0\0a");
        assert_eq!(bytes[45..47], *b"bc");
        assert_eq!(bytes[47..51], crc32fast::hash(b"bc").to_le_bytes());
        let parts = [&bytes[..24], &bytes[28..41], b"bc"].concat();
        assert_eq!(bytes[51..], crc32fast::hash(&parts).to_le_bytes());
    }

    #[test]
    fn every_truncation_is_refused_by_name() {
        let bytes = sealed(&SECTIONS);
        assert!(matches!(unsealed(b""), Err(Problem::NotSealed)));
        for length in 1..bytes.len() {
            let problem = unsealed(&bytes[..length]).unwrap_err();
            let least = if length < 32 { 32 } else { bytes.len() as u64 };
            let told = matches!(problem, Problem::Truncated { found, expected }
                if found == length as u64 && expected == least);
            assert!(told, "{length}: {problem}");
            // The file was truncated while it was read.
            assert!(read(&bytes[..length], bytes.len() as u64).is_err(), "{length}");
        }
        let longer = [&bytes[..], b"\0"].concat();
        assert!(matches!(unsealed(&longer), Err(Problem::TooLong { .. })));
    }

    #[test]
    fn every_changed_bit_is_refused() {
        let bytes = sealed(&SECTIONS);
        for bit in 0..8 * bytes.len() {
            let mut changed = bytes.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            assert!(unsealed(&changed).is_err(), "bit {bit}");
        }
    }

    #[test]
    fn damage_is_said_where_it_is() {
        let bytes = sealed(&[("a", b"bc"), ("d", b"e")]);
        let problem = |at: usize| {
            let mut changed = bytes.clone();
            changed[at] ^= 1;
            unsealed(&changed).unwrap_err()
        };
        assert!(matches!(problem(0), Problem::NotSealed));
        assert!(matches!(problem(16), Problem::Opening));
        assert!(matches!(problem(28), Problem::SectionHead { number: 1 }));
        assert!(matches!(problem(45), Problem::Section { name } if name == "a"));
        assert!(matches!(problem(51), Problem::SectionHead { number: 2 }));
        assert!(matches!(problem(bytes.len() - 1), Problem::Whole));
    }

    #[test]
    fn sections_of_two_files_do_not_mix() {
        let one = sealed(&[("a", b"bc"), ("d", b"e")]);
        let other = sealed(&[("a", b"xy"), ("d", b"f")]);
        let mixed = [&one[..51], &other[51..]].concat();
        assert!(matches!(unsealed(&mixed), Err(Problem::Whole)));
    }

    #[test]
    fn lengths_are_not_believed() {
        let bytes = sealed(&[("a", b"bc")]);
        for length in [3, 1 << 40, u64::MAX - 7, u64::MAX] {
            let forged = forged(bytes.clone(), 32, &length.to_le_bytes(), 28..41);
            assert!(matches!(unsealed(&forged), Err(Problem::SectionHead { number: 1 })));
        }
        let forged_name = forged(bytes.clone(), 28, &u32::MAX.to_le_bytes(), 28..41);
        assert!(matches!(unsealed(&forged_name), Err(Problem::SectionHead { number: 1 })));
        let forged_count = forged(bytes.clone(), 12, &u32::MAX.to_le_bytes(), 0..24);
        assert!(matches!(unsealed(&forged_count), Err(Problem::SectionHead { number: 2 })));
        let forged_count = forged(bytes.clone(), 12, &0_u32.to_le_bytes(), 0..24);
        assert!(matches!(unsealed(&forged_count), Err(Problem::Whole)));
        let forged_text = forged(bytes, 40, b"\xff", 28..41);
        assert!(matches!(unsealed(&forged_text), Err(Problem::SectionHead { number: 1 })));
        assert!(zeros(u64::MAX).is_none());
    }

    #[test]
    fn other_files_and_other_versions() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let problem = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            read_sealed(&path).unwrap_err()
        };
        assert!(matches!(problem(b"time,energy\n0,1\n").problem, Problem::NotSealed));
        let later = forged(sealed(&SECTIONS), 8, &2_u32.to_le_bytes(), 0..24);
        let error = problem(&later);
        assert!(matches!(error.problem, Problem::Version { found: 2 }));
        let expected = "file: has format version 2 where this program reads version 1";
        assert!(error.to_string().ends_with(expected), "{error}");
        for nowhere in [folder.path().join("absent"), folder.path().to_path_buf()] {
            let error = read_sealed(&nowhere).unwrap_err();
            assert!(matches!(error.problem, Problem::Read(_)), "{error}");
        }
    }

    #[test]
    fn a_name_used_twice_is_refused_and_the_earlier_file_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        write_sealed(&path, &SECTIONS).unwrap();
        let error = write_sealed(&path, &[("a", b"1"), ("a", b"2")]).unwrap_err();
        assert_eq!((error.path, error.source.kind()), (path.clone(), io::ErrorKind::InvalidInput));
        assert_sections(&read_sealed(&path).unwrap(), &SECTIONS);
    }
}
