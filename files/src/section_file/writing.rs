//! Writing of a file of sections, whose contents may be appended in pieces.

use super::{CHECKSUM_LENGTH, FORMAT_VERSION, MAGIC, OPENING_LENGTH, SECTION_HEAD_LENGTH};
use crc32fast::Hasher;
use std::collections::HashSet;
use std::fs::File;
use std::io::{self, Seek as _, SeekFrom, Write as _};

/// Sections of a file that is being written, whose contents are appended in pieces.
pub struct SectionPieces<'a> {
    file: &'a mut File,
    sections: Vec<UnfinishedSection>,
}

/// Section of which a part of the content has been written.
struct UnfinishedSection {
    name: String,
    /// Checksum of what precedes the content since the content of the section before.
    head_hasher: Hasher,
    content_hasher: Hasher,
    /// Position of the next byte of the content in the file.
    position: u64,
    /// Number of bytes of the content that have not been written.
    remaining: u64,
}

impl SectionPieces<'_> {
    /// Appends a piece to the content of the section at an index.
    ///
    /// # Errors
    /// The file cannot be written, or the content is longer than stated.
    pub fn append(&mut self, index: usize, piece: &[u8]) -> io::Result<()> {
        let section = &mut self.sections[index];
        let length = piece.len() as u64;
        section.remaining =
            section.remaining.checked_sub(length).ok_or_else(|| other_length(&section.name))?;
        self.file.seek(SeekFrom::Start(section.position))?;
        self.file.write_all(piece)?;
        section.content_hasher.update(piece);
        section.position += length;
        Ok(())
    }
}

fn invalid_input(reason: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, reason)
}

fn other_length(name: &str) -> io::Error {
    invalid_input(format!("section \"{name}\" has another length"))
}

/// Writes opening and heads of sections, then their contents by `fill`, then the checksums. The checksums of the parts are
/// excluded from that of the whole, since the CRC of data followed by their own CRC is constant.
pub(super) fn write_parts(
    file: &mut File,
    opening: &[u8],
    sections: &[(&str, usize)],
    fill: impl FnOnce(&mut SectionPieces) -> io::Result<()>,
) -> io::Result<()> {
    let hash = |bytes: &[u8]| {
        let mut hasher = Hasher::new();
        hasher.update(bytes);
        hasher
    };
    let mut write_part = |position: u64, bytes: &[u8]| -> io::Result<(Hasher, u64)> {
        let hasher = hash(bytes);
        file.seek(SeekFrom::Start(position))?;
        file.write_all(bytes)?;
        file.write_all(&hasher.clone().finalize().to_le_bytes())?;
        Ok((hasher, position + (bytes.len() + CHECKSUM_LENGTH) as u64))
    };
    let (mut whole, mut position) = write_part(0, opening)?;
    let mut unfinished = Vec::new();
    for (name, length) in sections {
        let mut head = (name.len() as u32).to_le_bytes().to_vec();
        head.extend((*length as u64).to_le_bytes());
        head.extend(name.as_bytes());
        let (head_hasher, start) = write_part(position, &head)?;
        let (name, remaining) = ((*name).to_owned(), *length as u64);
        position = start + remaining + CHECKSUM_LENGTH as u64;
        let content_hasher = Hasher::new();
        unfinished.push(UnfinishedSection {
            name,
            head_hasher,
            content_hasher,
            position: start,
            remaining,
        });
    }
    let mut pieces = SectionPieces { file, sections: unfinished };
    fill(&mut pieces)?;
    let SectionPieces { file, sections } = pieces;
    for UnfinishedSection { name, head_hasher, content_hasher, position, remaining } in sections {
        if remaining > 0 {
            return Err(other_length(&name));
        }
        whole.combine(&head_hasher);
        whole.combine(&content_hasher);
        file.seek(SeekFrom::Start(position))?;
        file.write_all(&content_hasher.finalize().to_le_bytes())?;
    }
    file.seek(SeekFrom::Start(position))?;
    file.write_all(&whole.finalize().to_le_bytes())
}

/// Formats the opening of the file without its checksum; an error if the sections cannot be represented.
pub(super) fn format_opening(sections: &[(&str, usize)]) -> io::Result<Vec<u8>> {
    let mut names = HashSet::new();
    if let Some((name, _)) = sections.iter().find(|(name, _)| !names.insert(name)) {
        return Err(invalid_input(format!("two sections are named \"{name}\"")));
    }
    if sections.iter().any(|(name, _)| u32::try_from(name.len()).is_err()) {
        return Err(invalid_input("the name of a section is too long".to_owned()));
    }
    let count = u32::try_from(sections.len())
        .map_err(|_| invalid_input("there are too many sections".to_owned()))?;
    let length = |&(name, length): &(&str, usize)| {
        (SECTION_HEAD_LENGTH + 2 * CHECKSUM_LENGTH) as u64 + name.len() as u64 + length as u64
    };
    let total =
        (OPENING_LENGTH + CHECKSUM_LENGTH) as u64 + sections.iter().map(length).sum::<u64>();
    let mut bytes = MAGIC.to_vec();
    bytes.extend(FORMAT_VERSION.to_le_bytes());
    bytes.extend(count.to_le_bytes());
    bytes.extend(total.to_le_bytes());
    Ok(bytes)
}
