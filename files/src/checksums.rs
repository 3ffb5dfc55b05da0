//! List of files with lengths and checksums, which detects damage to itself.
//!
//! A header line is followed by a line `CHECKSUM LENGTH NAME` for each file, sorted by name; the last line contains
//! the checksum of all preceding lines. Checksums are CRC-32 as in zlib, eight hexadecimal digits. A list is valid
//! only if it equals the list written for its content, so that every changed byte is detected.

use std::collections::BTreeMap;

use crate::regular_file::FileDigest;

/// First line of a list.
const HEADER_LINE: &str = "# CRC-32, length in bytes and name of every file but the log; the last line is for those above\n";

/// List of files with lengths and checksums.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Checksums {
    files: BTreeMap<String, FileDigest>,
}

impl Checksums {
    /// File name of the list; its last line has this name, with length and checksum of the lines before it.
    pub const FILE_NAME: &str = "checksums.txt";

    /// Adds a file or replaces its entry.
    ///
    /// # Panics
    /// The name contains a line break or is the name of the list itself.
    pub fn insert(&mut self, name: &str, digest: FileDigest) {
        assert!(
            !name.contains('\n') && name != Self::FILE_NAME,
            "no name of a file in a list: {name}"
        );
        self.files.insert(name.to_owned(), digest);
    }

    /// Removes a file from the list, if listed.
    pub fn remove(&mut self, name: &str) {
        self.files.remove(name);
    }

    /// Length and checksum of a file; `None` if it is not listed.
    pub fn digest(&self, name: &str) -> Option<FileDigest> {
        self.files.get(name).copied()
    }

    /// All files, sorted by name.
    pub fn iter(&self) -> impl Iterator<Item = (&str, FileDigest)> {
        self.files.iter().map(|(name, written)| (name.as_str(), *written))
    }

    /// Formats the list as the bytes of its file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut text = HEADER_LINE.to_owned();
        for (name, written) in &self.files {
            text += &format_line(name, *written);
        }
        text += &format_line(Self::FILE_NAME, FileDigest::from_bytes(text.as_bytes()));
        text.into_bytes()
    }

    /// Parses the bytes of a list; `None` if they are damaged.
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        let text = str::from_utf8(bytes).ok()?;
        let mut list = Self::default();
        for line in text.strip_prefix(HEADER_LINE)?.lines() {
            let [checksum, length, name] =
                line.splitn(3, ' ').collect::<Vec<_>>().try_into().ok()?;
            let checksum = u32::from_str_radix(checksum, 16).ok()?;
            let written = FileDigest { length: length.parse().ok()?, checksum };
            if name != Self::FILE_NAME {
                list.files.insert(name.to_owned(), written);
            }
        }
        (list.to_bytes() == bytes).then_some(list)
    }
}

fn format_line(name: &str, FileDigest { length, checksum }: FileDigest) -> String {
    format!("{checksum:08x} {length} {name}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample_list() -> Checksums {
        let mut list = Checksums::default();
        list.insert("run.json", FileDigest::from_bytes(b"{}\n"));
        list.insert("a name with spaces", FileDigest::from_bytes(b""));
        list.insert("φ.csv", FileDigest { length: u64::MAX, checksum: u32::MAX });
        list
    }

    #[test]
    fn list_is_read_back_unchanged() {
        for list in [sample_list(), Checksums::default()] {
            assert_eq!(Checksums::parse(&list.to_bytes()), Some(list));
        }
        let mut list = sample_list();
        let text = String::from_utf8(list.to_bytes()).unwrap();
        assert!(text.contains("\n00000000 0 a name with spaces\n"), "{text}");
        assert!(text.lines().last().unwrap().ends_with(" checksums.txt"), "{text}");
        list.insert("run.json", FileDigest::from_bytes(b"other"));
        assert_eq!(list.digest("run.json"), Some(FileDigest::from_bytes(b"other")));
        list.remove("run.json");
        assert_eq!(list.iter().count(), 2);
        assert_eq!(list.digest("run.json"), None);
    }

    #[test]
    fn every_changed_bit_and_truncation_is_detected() {
        let bytes = sample_list().to_bytes();
        for bit in 0..8 * bytes.len() {
            let mut changed = bytes.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(Checksums::parse(&changed), None, "bit {bit}");
        }
        for length in 0..bytes.len() {
            assert_eq!(Checksums::parse(&bytes[..length]), None, "{length}");
        }
        assert_eq!(Checksums::parse(&[&bytes[..], b"\n"].concat()), None);
    }

    #[test]
    fn omitted_or_moved_line_is_detected() {
        let text = String::from_utf8(sample_list().to_bytes()).unwrap();
        let lines: Vec<&str> = text.split_inclusive('\n').collect();
        for index in 0..lines.len() {
            let mut fewer = lines.clone();
            fewer.remove(index);
            assert_eq!(Checksums::parse(fewer.concat().as_bytes()), None, "{index}");
            let mut swapped = lines.clone();
            swapped.swap(index, (index + 1) % lines.len());
            assert_eq!(Checksums::parse(swapped.concat().as_bytes()), None, "{index}");
        }
    }
}
