//! Checkpoint file format: named sections of bytes with checksums, so that damage to a file is detected on reading.
//!
//! All numbers are little-endian. A file begins with an opening of 28 bytes, the same in every version of the format:
//! eight magic bytes, the format version (4 bytes), the number of sections (4), the length of the file in bytes (8) and
//! the checksum (4) of these 24 bytes. A section consists of the length of its name (4), the length of its content (8),
//! the name, the checksum (4) of these three, the content, and the checksum (4) of the content. The file ends with the
//! checksum (4) of the opening and all sections in sequence, without the checksums they contain. Checksums are CRC-32
//! as in zlib: they detect accidental but not intentional damage.

mod writing;

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use crc32fast::Hasher;

use crate::regular_file::open_regular_file;
use crate::{FileError, write_atomically_with};
use writing::{format_opening, write_parts};

pub use writing::SectionPieces;

/// Magic bytes: the first is not ASCII, and text-mode transfers would alter the line ends.
const MAGIC: [u8; 8] = *b"\x89seal\r\n\x1a";
/// Version of the format written and read by this module.
const FORMAT_VERSION: u32 = 1;
/// Length of the opening (file header), bytes.
const OPENING_LENGTH: usize = 28;
/// Length of the lengths of name and content before each section, bytes.
const SECTION_HEAD_LENGTH: usize = 12;
/// Length of a checksum, bytes.
const CHECKSUM_LENGTH: usize = 4;

/// Error of reading a file of sections.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct SectionFileError {
    /// Path of the file.
    pub path: PathBuf,
    /// Cause of the error.
    #[source]
    pub problem: SectionFileProblem,
}

/// Cause of a [`SectionFileError`].
#[derive(Debug, thiserror::Error)]
pub enum SectionFileProblem {
    /// The operating system refused to open or to read the file.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// The file does not begin with the magic bytes of this format.
    #[error("is not a file of sealed sections")]
    UnknownFormat,
    /// The file has a different version of the format.
    #[error("has format version {found} where this program reads version {FORMAT_VERSION}")]
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
    DamagedOpening,
    /// The name or the lengths of a section are damaged.
    #[error("is damaged in the name or the lengths of section {number}")]
    DamagedSectionHead {
        /// Number of the section, counted from 1.
        number: u32,
    },
    /// The content of a section is damaged.
    #[error("is damaged in section \"{name}\"")]
    DamagedSection {
        /// Name of the section.
        name: String,
    },
    /// Each section is valid, but the checksum of the entire file does not match or is not the last part of the file.
    #[error("is damaged: the checksum of the whole does not match")]
    DamagedFile,
    /// There is not enough memory for a section.
    #[error("section \"{name}\" of {length} bytes does not fit into memory")]
    OutOfMemory {
        /// Name of the section.
        name: String,
        /// Length of the section, in bytes.
        length: u64,
    },
}

/// Writes sections to a file atomically (see [`crate::write_atomically`]), without copying the contents. Duplicate
/// names are refused.
pub fn write_sections(path: &Path, sections: &[(&str, &[u8])]) -> Result<(), FileError> {
    let lengths: Vec<(&str, usize)> =
        sections.iter().map(|(name, content)| (*name, content.len())).collect();
    write_sections_with(path, &lengths, |index| Cow::Borrowed(sections[index].1))
}

/// Writes sections of given names and lengths to a file as [`write_sections`] does, of which only one is in memory at a
/// time: `content` returns that of the section at an index.
pub fn write_sections_with<'a>(
    path: &Path,
    sections: &[(&str, usize)],
    content: impl Fn(usize) -> Cow<'a, [u8]>,
) -> Result<(), FileError> {
    write_sections_in_pieces(path, sections, |pieces| {
        (0..sections.len()).try_for_each(|index| pieces.append(index, &content(index)))
    })
}

/// Writes sections of given names and lengths to a file as [`write_sections`] does, whose contents `fill` appends in
/// pieces, those of a section in order, those of different sections in any order.
pub fn write_sections_in_pieces(
    path: &Path,
    sections: &[(&str, usize)],
    fill: impl FnOnce(&mut SectionPieces) -> io::Result<()>,
) -> Result<(), FileError> {
    let opening = format_opening(sections).map_err(|source| FileError {
        path: path.to_path_buf(),
        action: "write",
        source,
    })?;
    write_atomically_with(path, |file| write_parts(file, &opening, sections, fill))
}

/// Reads the sections of a file, in the order of writing. Any changed byte is an error; stated lengths are checked
/// against the length of the file before memory is allocated.
pub fn read_sections(path: &Path) -> Result<Vec<(String, Vec<u8>)>, SectionFileError> {
    let opened = open_regular_file(path).and_then(|file| Ok((file.metadata()?.len(), file)));
    opened
        .map_err(SectionFileProblem::Io)
        .and_then(|(length, file)| parse_sections(BufReader::new(file), length))
        .map_err(|problem| SectionFileError { path: path.to_path_buf(), problem })
}

/// Passes the sections of a file to `visit` in the order of writing, without reading them into memory: name, length and
/// content, of which `visit` may read a part. Damage to a section is reported after its visit.
///
/// # Errors
/// As [`read_sections`]; also the first error of `visit`.
pub fn visit_sections(
    path: &Path,
    visit: impl FnMut(&str, u64, &mut dyn Read) -> io::Result<()>,
) -> Result<(), SectionFileError> {
    visit_sections_if(path, |_| true, visit)
}

/// Passes the section `name` of a file to `visit` as [`visit_sections`] does, without reading the contents of others; none if
/// there is no such section. Damage to other sections is not found.
///
/// # Errors
/// As [`visit_sections`].
pub fn visit_section(
    path: &Path,
    name: &str,
    mut visit: impl FnMut(u64, &mut dyn Read) -> io::Result<()>,
) -> Result<(), SectionFileError> {
    visit_sections_if(path, |own| own == name, |_, length, content| visit(length, content))
}

/// Visits the sections whose names `is_visited` selects; the checksum of the whole is verified if all are.
fn visit_sections_if(
    path: &Path,
    is_visited: impl Fn(&str) -> bool,
    mut visit: impl FnMut(&str, u64, &mut dyn Read) -> io::Result<()>,
) -> Result<(), SectionFileError> {
    let mut read = || -> Result<(), SectionFileProblem> {
        let file = open_regular_file(path)?;
        let length = file.metadata()?.len();
        let reader = BufReader::with_capacity(1 << 18, file);
        let mut reader = ChecksumReader { reader, file_hasher: Hasher::new(), remaining: length };
        let mut is_complete = true;
        for number in 1..=read_opening(&mut reader, length)? {
            let head = reader.read_section_head()?;
            let (name, length) = head.ok_or(SectionFileProblem::DamagedSectionHead { number })?;
            if !is_visited(&name) {
                is_complete = false;
                reader.skip(length + CHECKSUM_LENGTH as u64)?;
                continue;
            }
            let mut content =
                SectionContent { reader: &mut reader, hasher: Hasher::new(), remaining: length };
            visit(&name, length, &mut content)?;
            io::copy(&mut content, &mut io::sink())?;
            let hasher = content.hasher;
            reader.file_hasher.combine(&hasher);
            if !reader.verify_checksum(hasher)? {
                return Err(SectionFileProblem::DamagedSection { name });
            }
        }
        let whole = reader.file_hasher.clone();
        let is_end = reader.remaining == CHECKSUM_LENGTH as u64;
        match is_end && (!is_complete || reader.verify_checksum(whole)?) {
            true => Ok(()),
            false => Err(SectionFileProblem::DamagedFile),
        }
    };
    read().map_err(|problem| SectionFileError { path: path.to_path_buf(), problem })
}

/// Reader of the content of a section.
struct SectionContent<'a, R> {
    reader: &'a mut ChecksumReader<R>,
    hasher: Hasher,
    /// Number of bytes of the content that have not been read.
    remaining: u64,
}

impl<R: Read> Read for SectionContent<'_, R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let length = usize::try_from(self.remaining).unwrap_or(usize::MAX).min(bytes.len());
        let count = self.reader.reader.read(&mut bytes[..length])?;
        if count == 0 && length > 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        self.hasher.update(&bytes[..count]);
        self.remaining -= count as u64;
        self.reader.remaining = self.reader.remaining.saturating_sub(count as u64);
        Ok(count)
    }
}

/// Reader with the running checksum of all parts and the number of remaining bytes.
struct ChecksumReader<R> {
    reader: R,
    file_hasher: Hasher,
    remaining: u64,
}

impl ChecksumReader<BufReader<File>> {
    /// Skips bytes, of which the checksum of the file then lacks those of the content.
    fn skip(&mut self, length: u64) -> io::Result<()> {
        self.remaining = self.remaining.saturating_sub(length);
        let offset = i64::try_from(length).map_err(|_| io::ErrorKind::InvalidInput)?;
        self.reader.seek_relative(offset)
    }
}

impl<R: Read> ChecksumReader<R> {
    /// Reads exactly the next `bytes.len()` bytes.
    fn read_exact(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self.remaining = self.remaining.saturating_sub(bytes.len() as u64);
        self.reader.read_exact(bytes)
    }

    /// Fills `bytes` with the next bytes of a part and returns their CRC-32 hasher.
    fn read_part(&mut self, bytes: &mut [u8]) -> io::Result<Hasher> {
        self.read_exact(bytes)?;
        let mut hasher = Hasher::new();
        hasher.update(bytes);
        self.file_hasher.combine(&hasher);
        Ok(hasher)
    }

    /// Reads a checksum and compares it with that of `hasher`.
    fn verify_checksum(&mut self, hasher: Hasher) -> io::Result<bool> {
        let mut stored = [0; CHECKSUM_LENGTH];
        self.read_exact(&mut stored)?;
        Ok(hasher.finalize() == u32::from_le_bytes(stored))
    }

    /// Whether `length` bytes and two checksums fit into the remaining bytes.
    fn can_hold(&self, length: u64) -> bool {
        length
            .checked_add(2 * CHECKSUM_LENGTH as u64)
            .is_some_and(|length| length <= self.remaining)
    }

    /// Reads name and content length of the next section; `None` if damaged.
    fn read_section_head(&mut self) -> io::Result<Option<(String, u64)>> {
        if !self.can_hold(SECTION_HEAD_LENGTH as u64) {
            return Ok(None);
        }
        let mut lengths = [0; SECTION_HEAD_LENGTH];
        let mut hasher = self.read_part(&mut lengths)?;
        let (name_length, length) = (read_u32(&lengths, 0), read_u64(&lengths, 4));
        if !self.can_hold(name_length.into()) {
            return Ok(None);
        }
        let Some(mut name) = allocate_zeros(name_length.into()) else { return Ok(None) };
        hasher.combine(&self.read_part(&mut name)?);
        if !self.verify_checksum(hasher)? || !self.can_hold(length) {
            return Ok(None);
        }
        Ok(String::from_utf8(name).ok().map(|name| (name, length)))
    }

    /// Reads the next section, with number `number`.
    fn read_section(&mut self, number: u32) -> Result<(String, Vec<u8>), SectionFileProblem> {
        let head = self.read_section_head()?;
        let (name, length) = head.ok_or(SectionFileProblem::DamagedSectionHead { number })?;
        let Some(mut content) = allocate_zeros(length) else {
            return Err(SectionFileProblem::OutOfMemory { name, length });
        };
        let hasher = self.read_part(&mut content)?;
        if !self.verify_checksum(hasher)? {
            return Err(SectionFileProblem::DamagedSection { name });
        }
        Ok((name, content))
    }
}

/// Allocates a zeroed buffer of a verified length; `None` if it does not fit into memory.
fn allocate_zeros(length: u64) -> Option<Vec<u8>> {
    let length = usize::try_from(length).ok()?;
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length).ok()?;
    bytes.resize(length, 0);
    Some(bytes)
}

fn read_u32(bytes: &[u8], start: usize) -> u32 {
    let read = |number, &byte: &u8| number << 8 | u32::from(byte);
    bytes[start..start + 4].iter().rev().fold(0, read)
}

fn read_u64(bytes: &[u8], start: usize) -> u64 {
    u64::from(read_u32(bytes, start)) | u64::from(read_u32(bytes, start + 4)) << 32
}

fn parse_sections(
    reader: impl Read,
    file_length: u64,
) -> Result<Vec<(String, Vec<u8>)>, SectionFileProblem> {
    let mut checksum_reader =
        ChecksumReader { reader, file_hasher: Hasher::new(), remaining: file_length };
    let count = read_opening(&mut checksum_reader, file_length)?;
    // No capacity is reserved, since the number of sections has not been checked against the length of the file.
    let mut sections = Vec::new();
    for number in 1..=count {
        sections.push(checksum_reader.read_section(number)?);
    }
    let whole = checksum_reader.file_hasher.clone();
    let is_intact = checksum_reader.remaining == CHECKSUM_LENGTH as u64
        && checksum_reader.verify_checksum(whole)?;
    if is_intact { Ok(sections) } else { Err(SectionFileProblem::DamagedFile) }
}

/// Reads the opening, checks the stated length against the length `file_length`, and returns the number of sections.
fn read_opening(
    checksum_reader: &mut ChecksumReader<impl Read>,
    file_length: u64,
) -> Result<u32, SectionFileProblem> {
    let mut bytes = [0; OPENING_LENGTH];
    let available = usize::try_from(file_length).unwrap_or(OPENING_LENGTH).min(OPENING_LENGTH);
    checksum_reader.read_exact(&mut bytes[..available])?;
    let magic_length = available.min(MAGIC.len());
    if magic_length == 0 || bytes[..magic_length] != MAGIC[..magic_length] {
        return Err(SectionFileProblem::UnknownFormat);
    }
    let min_length = (OPENING_LENGTH + CHECKSUM_LENGTH) as u64;
    if file_length < min_length {
        return Err(SectionFileProblem::Truncated { found: file_length, expected: min_length });
    }
    checksum_reader.file_hasher.update(&bytes[..OPENING_LENGTH - CHECKSUM_LENGTH]);
    if checksum_reader.file_hasher.clone().finalize()
        != read_u32(&bytes, OPENING_LENGTH - CHECKSUM_LENGTH)
    {
        return Err(SectionFileProblem::DamagedOpening);
    }
    let (version, count, expected) =
        (read_u32(&bytes, 8), read_u32(&bytes, 12), read_u64(&bytes, 16));
    if version != FORMAT_VERSION {
        return Err(SectionFileProblem::Version { found: version });
    }
    match file_length.cmp(&expected) {
        std::cmp::Ordering::Less => {
            Err(SectionFileProblem::Truncated { found: file_length, expected })
        }
        std::cmp::Ordering::Greater => {
            Err(SectionFileProblem::TooLong { found: file_length, expected })
        }
        std::cmp::Ordering::Equal => Ok(count),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    const SECTIONS: [(&str, &[u8]); 4] =
        [("state", b"\x00\x01\xff and more"), ("empty", b""), ("", b"nameless"), ("σ", b"x")];

    fn format_sections(sections: &[(&str, &[u8])]) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sections");
        write_sections(&path, sections).unwrap();
        fs::read(path).unwrap()
    }

    fn parse_bytes(bytes: &[u8]) -> Result<Vec<(String, Vec<u8>)>, SectionFileProblem> {
        parse_sections(bytes, bytes.len() as u64)
    }

    /// Replaces bytes at `at` in the opening or a section head, and updates the checksum that follows the range
    /// `checked`.
    fn forge_bytes(
        mut bytes: Vec<u8>,
        at: usize,
        new: &[u8],
        checked: std::ops::Range<usize>,
    ) -> Vec<u8> {
        bytes[at..at + new.len()].copy_from_slice(new);
        let checksum = crc32fast::hash(&bytes[checked.clone()]).to_le_bytes();
        bytes[checked.end..checked.end + CHECKSUM_LENGTH].copy_from_slice(&checksum);
        bytes
    }

    fn assert_sections(found: &[(String, Vec<u8>)], expected: &[(&str, &[u8])]) {
        let found: Vec<_> = found.iter().map(|(name, content)| (&name[..], &content[..])).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn sections_are_read_back_unchanged() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoints/last");
        write_sections(&path, &SECTIONS).unwrap();
        assert_sections(&read_sections(&path).unwrap(), &SECTIONS);
        assert_eq!(fs::read(&path).unwrap(), format_sections(&SECTIONS));
        write_sections(&path, &[]).unwrap();
        assert_sections(&read_sections(&path).unwrap(), &[]);
        let large: Vec<u8> = (0..3_000_000_u32).map(|i| (i.wrapping_mul(i) >> 7) as u8).collect();
        let sections = [("large", &large[..]), ("small", b"s")];
        write_sections(&path, &sections).unwrap();
        assert_sections(&read_sections(&path).unwrap(), &sections);
    }

    /// Verifies that contents in pieces, of several sections in turn, give the same bytes, and that one section is read alone.
    #[test]
    fn pieces_give_the_same_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sections");
        let lengths = SECTIONS.map(|(name, content)| (name, content.len()));
        write_sections_in_pieces(&path, &lengths, |pieces| {
            for start in 0..SECTIONS[0].1.len() {
                for index in [3, 2, 1, 0] {
                    let content = SECTIONS[index].1;
                    pieces.append(index, content.get(start..start + 1).unwrap_or_default())?;
                }
            }
            Ok(())
        })
        .unwrap();
        assert_eq!(fs::read(&path).unwrap(), format_sections(&SECTIONS));
        let mut found = Vec::new();
        visit_section(&path, "", |_, content| content.read_to_end(&mut found).map(drop)).unwrap();
        assert_eq!(found, SECTIONS[2].1);
        for wrong in [&b"longer than stated"[..], b"less"] {
            let written =
                write_sections_in_pieces(&path, &lengths, |pieces| pieces.append(0, wrong));
            assert!(written.unwrap_err().to_string().contains("has another length"));
        }
    }

    #[test]
    fn byte_layout_is_stable() {
        let bytes = format_sections(&[("a", b"bc")]);
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
    fn every_truncation_is_reported() {
        let bytes = format_sections(&SECTIONS);
        assert!(matches!(parse_bytes(b""), Err(SectionFileProblem::UnknownFormat)));
        for length in 1..bytes.len() {
            let problem = parse_bytes(&bytes[..length]).unwrap_err();
            let min_length = if length < 32 { 32 } else { bytes.len() as u64 };
            let told = matches!(problem, SectionFileProblem::Truncated { found, expected }
                if found == length as u64 && expected == min_length);
            assert!(told, "{length}: {problem}");
            // The file was truncated while it was read.
            assert!(parse_sections(&bytes[..length], bytes.len() as u64).is_err(), "{length}");
        }
        let longer = [&bytes[..], b"\0"].concat();
        assert!(matches!(parse_bytes(&longer), Err(SectionFileProblem::TooLong { .. })));
    }

    #[test]
    fn every_changed_bit_is_refused() {
        let bytes = format_sections(&SECTIONS);
        for bit in 0..8 * bytes.len() {
            let mut changed = bytes.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            assert!(parse_bytes(&changed).is_err(), "bit {bit}");
        }
    }

    #[test]
    fn damaged_part_is_reported() {
        let bytes = format_sections(&[("a", b"bc"), ("d", b"e")]);
        let problem = |at: usize| {
            let mut changed = bytes.clone();
            changed[at] ^= 1;
            parse_bytes(&changed).unwrap_err()
        };
        assert!(matches!(problem(0), SectionFileProblem::UnknownFormat));
        assert!(matches!(problem(16), SectionFileProblem::DamagedOpening));
        assert!(matches!(problem(28), SectionFileProblem::DamagedSectionHead { number: 1 }));
        assert!(matches!(problem(45), SectionFileProblem::DamagedSection { name } if name == "a"));
        assert!(matches!(problem(51), SectionFileProblem::DamagedSectionHead { number: 2 }));
        assert!(matches!(problem(bytes.len() - 1), SectionFileProblem::DamagedFile));
    }

    #[test]
    fn mixture_of_two_files_is_refused() {
        let one = format_sections(&[("a", b"bc"), ("d", b"e")]);
        let other = format_sections(&[("a", b"xy"), ("d", b"f")]);
        let mixed = [&one[..51], &other[51..]].concat();
        assert!(matches!(parse_bytes(&mixed), Err(SectionFileProblem::DamagedFile)));
    }

    #[test]
    fn forged_lengths_are_refused() {
        let bytes = format_sections(&[("a", b"bc")]);
        for length in [3, 1 << 40, u64::MAX - 7, u64::MAX] {
            let forged = forge_bytes(bytes.clone(), 32, &length.to_le_bytes(), 28..41);
            assert!(matches!(
                parse_bytes(&forged),
                Err(SectionFileProblem::DamagedSectionHead { number: 1 })
            ));
        }
        let forged_name = forge_bytes(bytes.clone(), 28, &u32::MAX.to_le_bytes(), 28..41);
        assert!(matches!(
            parse_bytes(&forged_name),
            Err(SectionFileProblem::DamagedSectionHead { number: 1 })
        ));
        let forged_count = forge_bytes(bytes.clone(), 12, &u32::MAX.to_le_bytes(), 0..24);
        assert!(matches!(
            parse_bytes(&forged_count),
            Err(SectionFileProblem::DamagedSectionHead { number: 2 })
        ));
        let forged_count = forge_bytes(bytes.clone(), 12, &0_u32.to_le_bytes(), 0..24);
        assert!(matches!(parse_bytes(&forged_count), Err(SectionFileProblem::DamagedFile)));
        let forged_text = forge_bytes(bytes, 40, b"\xff", 28..41);
        assert!(matches!(
            parse_bytes(&forged_text),
            Err(SectionFileProblem::DamagedSectionHead { number: 1 })
        ));
        assert!(allocate_zeros(u64::MAX).is_none());
    }

    #[test]
    fn other_formats_and_versions_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let problem = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            read_sections(&path).unwrap_err()
        };
        assert!(matches!(
            problem(b"time,energy\n0,1\n").problem,
            SectionFileProblem::UnknownFormat
        ));
        let later = forge_bytes(format_sections(&SECTIONS), 8, &2_u32.to_le_bytes(), 0..24);
        let error = problem(&later);
        assert!(matches!(error.problem, SectionFileProblem::Version { found: 2 }));
        let expected = "file: has format version 2 where this program reads version 1";
        assert!(error.to_string().ends_with(expected), "{error}");
        for nowhere in [folder.path().join("absent"), folder.path().to_path_buf()] {
            let error = read_sections(&nowhere).unwrap_err();
            assert!(matches!(error.problem, SectionFileProblem::Io(_)), "{error}");
        }
    }

    #[test]
    fn duplicate_name_is_refused_and_previous_file_remains() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        write_sections(&path, &SECTIONS).unwrap();
        let error = write_sections(&path, &[("a", b"1"), ("a", b"2")]).unwrap_err();
        assert_eq!((error.path, error.source.kind()), (path.clone(), io::ErrorKind::InvalidInput));
        assert_sections(&read_sections(&path).unwrap(), &SECTIONS);
    }
}
