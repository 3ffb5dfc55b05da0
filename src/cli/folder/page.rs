//! The report page of a results folder.

use super::names::{CASE_FILE, PROGRAM_FILE, REPORT_PAGE_FILE};
use super::origin::describe_program;
use super::{OutputError, ResultFolder, remove_file_if_exists, write_file};
use crate::report::page::{PageFrame, PageSection};
use files::checksums::Checksums;
use files::{FileDigest, read_regular_file};

impl ResultFolder {
    /// Formats the page with the section of a verb and those of other verbs that are in the page of the folder.
    pub(super) fn format_page_with(&self, section: &PageSection) -> Vec<u8> {
        let mut sections = self.read_page_sections();
        sections.retain(|own| own.study_name() != section.study_name());
        sections.push(section.clone());
        self.format_page(&sections)
    }

    /// Formats the page with these sections.
    pub(super) fn format_page(&self, sections: &[PageSection]) -> Vec<u8> {
        let program = describe_program(&self.case_without_plot_options);
        let text = |key: &str| program[key].as_str().unwrap_or_default();
        let provenance = [
            ("program", format!("{} {}", text("name"), text("version"))),
            ("commit", text("commit").to_owned()),
            (
                "commands",
                format!(
                    "as each section states; {CASE_FILE} is the case below, with all overrides"
                ),
            ),
            ("checksum of the case", format!("{} (CRC-32)", text("case"))),
            (
                "files",
                format!(
                    "{CASE_FILE} and {PROGRAM_FILE} state the same; wellposed verify checks all files"
                ),
            ),
        ];
        let frame = PageFrame {
            title: &self.case_title,
            case_toml: &self.case_toml,
            provenance: &provenance,
        };
        frame.format_page(sections).into_bytes()
    }

    /// Reads the sections of the page in the folder; none if there is no page or it cannot be read.
    fn read_page_sections(&self) -> Vec<PageSection> {
        let page = read_regular_file(&self.path.join(REPORT_PAGE_FILE)).unwrap_or_default();
        PageSection::parse_page(&String::from_utf8_lossy(&page))
    }

    /// Writes the page with the section of a verb, and its entry in the checksum list.
    ///
    /// # Errors
    /// The page or the list cannot be written.
    pub(super) fn write_page_with(
        &self,
        list: &mut Checksums,
        section: &PageSection,
    ) -> Result<(), OutputError> {
        let bytes = self.format_page_with(section);
        self.remove_page_entry(list)?;
        write_file(&self.path.join(REPORT_PAGE_FILE), &bytes)?;
        list.insert(REPORT_PAGE_FILE, FileDigest::from_bytes(&bytes));
        Ok(())
    }

    /// Removes the section of a verb from the page in the folder, and the page if it has no other.
    ///
    /// # Errors
    /// The checksum list is damaged, or a file cannot be written or removed.
    pub(super) fn remove_page_section(&self, study_name: &str) -> Result<(), OutputError> {
        let mut sections = self.read_page_sections();
        let count = sections.len();
        sections.retain(|own| own.study_name() != study_name);
        if sections.len() == count {
            return Ok(());
        }
        let path = self.path.join(REPORT_PAGE_FILE);
        let mut list = self.load_checksums()?;
        self.remove_page_entry(&mut list)?;
        if sections.is_empty() {
            return remove_file_if_exists(&path);
        }
        let bytes = self.format_page(&sections);
        write_file(&path, &bytes)?;
        list.insert(REPORT_PAGE_FILE, FileDigest::from_bytes(&bytes));
        self.write_checksums(&list)
    }

    /// Removes the page from the checksum list before it is replaced.
    fn remove_page_entry(&self, list: &mut Checksums) -> Result<(), OutputError> {
        if list.digest(REPORT_PAGE_FILE).is_none() {
            return Ok(());
        }
        list.remove(REPORT_PAGE_FILE);
        self.write_checksums(list)
    }
}
