//! Publication of all files of a verb at once.

use super::names::{
    CASE_FILE, FINISHED_RUN_FILE, PROGRAM_FILE, REPORT_PAGE_FILE, is_result_file_name,
};
use super::{AppendedFile, OutputError, ResultFolder, create_write_error, remove_file_if_exists};
use crate::report::page::PageSection;
use files::{DigestWriter, FileDigest, StagedFile, stage_file_with};
use std::fs::File;
use std::io::{self, Write as _};

/// Kind of the published files, by the verb that produced them.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PublicationKind {
    /// Results of a case, from a verb that computes them.
    CaseResults,
    /// Pictures of the results of a verb, from the verb `plot`.
    RedrawnPictures { verb: &'static str },
}

/// Files of a verb that have been written under temporary names; files that have not been published are removed on
/// drop.
pub struct Publication<'a> {
    folder: &'a ResultFolder,
    kind: PublicationKind,
    staged_files: Vec<(String, StagedFile, FileDigest)>,
    /// Names of files to be removed at publication if they exist.
    names_to_remove: Vec<String>,
    /// Section of the page, which is formatted at publication with those of other verbs.
    page_section: Option<PageSection>,
}

impl ResultFolder {
    /// Starts a publication of results of the case.
    pub fn start_publication(&self) -> Publication<'_> {
        self.start(PublicationKind::CaseResults)
    }

    /// Starts a publication of redrawn pictures of the results of a verb in this folder.
    pub fn start_redrawing(&self, verb: &'static str) -> Publication<'_> {
        self.start(PublicationKind::RedrawnPictures { verb })
    }

    fn start(&self, kind: PublicationKind) -> Publication<'_> {
        Publication {
            folder: self,
            kind,
            staged_files: Vec::new(),
            names_to_remove: Vec::new(),
            page_section: None,
        }
    }
}

impl Publication<'_> {
    /// Adds one of the [`result_file_names`](super::result_file_names) under a temporary name.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn stage_file(&mut self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        self.stage_with(name, |file| file.write_all(bytes))
    }

    /// Adds one of the result files as [`stage_file`](Self::stage_file) does, with the content that `write` produces.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn stage_with(
        &mut self,
        name: &str,
        write: impl FnOnce(&mut DigestWriter<&mut File>) -> io::Result<()>,
    ) -> Result<(), OutputError> {
        debug_assert!(is_result_file_name(name), "{name} is not listed");
        let path = self.folder.path.join(name);
        let mut digest = FileDigest::default();
        let staged = stage_file_with(&path, |file| {
            let mut writer = DigestWriter::new(file);
            write(&mut writer)?;
            digest = writer.finish()?;
            Ok(())
        });
        let staged = staged.map_err(|error| create_write_error(&path, &error))?;
        self.staged_files.push((name.to_owned(), staged, digest));
        Ok(())
    }

    /// Sets the section of the verb in the page.
    pub fn set_page_section(&mut self, section: PageSection) {
        self.page_section = Some(section);
    }

    /// Adds the page, without the sections of other verbs if the results in the folder are to be removed.
    fn stage_page(&mut self, is_foreign: bool) -> Result<(), OutputError> {
        let Some(section) = self.page_section.take() else { return Ok(()) };
        let page = match is_foreign {
            true => self.folder.format_page(&[section]),
            false => self.folder.format_page_with(&section),
        };
        self.stage_file(REPORT_PAGE_FILE, &page)
    }

    /// Marks one of the [`result_file_names`](super::result_file_names) for removal if it exists.
    pub fn schedule_removal(&mut self, name: &str) {
        self.names_to_remove.push(name.to_owned());
    }

    /// Publishes all files with the resolved case, the program version and checksums, and removes results of another
    /// case and files of killed processes. The files of a run in progress are not changed.
    ///
    /// # Errors
    /// The folder meanwhile received other content or a run in progress, its finished run was removed, the publication
    /// lock cannot be acquired, the checksum list is damaged, or a file cannot be written or removed.
    pub fn publish(mut self) -> Result<(), OutputError> {
        let folder = self.folder;
        let _brief = folder.acquire_publication_lock()?;
        let lives = folder.has_run_lock();
        match self.kind {
            PublicationKind::CaseResults => {
                let is_foreign = folder.has_foreign_results()?;
                if is_foreign && lives {
                    return Err(folder.create_active_run_error());
                }
                self.stage_page(is_foreign)?;
                if is_foreign {
                    folder.remove_results()?;
                }
            }
            PublicationKind::RedrawnPictures { verb }
                if lives || !folder.path.join(format!("{verb}.json")).exists() =>
            {
                return Err(folder.create_active_run_error());
            }
            PublicationKind::RedrawnPictures { .. } => self.stage_page(false)?,
        }
        let Self { kind, staged_files, names_to_remove: removed_names, .. } = self;
        folder.remove_abandoned_files()?;
        if !lives && folder.path.join(FINISHED_RUN_FILE).exists() {
            // A run that was killed after it had written its last result left these files.
            remove_file_if_exists(&folder.file_path(AppendedFile::Checkpoint))?;
            remove_file_if_exists(&folder.file_path(AppendedFile::Lock))?;
        }
        let mut list = folder.load_checksums()?;
        let changed = staged_files
            .iter()
            .filter(|(name, _, own)| list.digest(name).is_some_and(|old| old != *own))
            .map(|(name, ..)| name);
        let gone: Vec<&String> = changed.chain(&removed_names).collect();
        if !gone.is_empty() {
            gone.into_iter().for_each(|name| list.remove(name));
            folder.write_checksums(&list)?;
        }
        if kind == PublicationKind::CaseResults && !lives {
            folder.write_origin()?;
        }
        removed_names.iter().try_for_each(|name| remove_file_if_exists(&folder.path.join(name)))?;
        for (name, staged, written) in staged_files {
            let path = folder.path.join(&name);
            staged.publish().map_err(|error| create_write_error(&path, &error))?;
            list.insert(&name, written);
        }
        match kind {
            PublicationKind::CaseResults => {
                for (name, bytes) in folder.origin_files() {
                    list.insert(name, FileDigest::from_bytes(&bytes));
                }
            }
            // The user may have edited the plot options in the case file, hence its present checksum is recorded.
            PublicationKind::RedrawnPictures { .. } => {
                folder.add_current_checksums(&mut list, &[CASE_FILE, PROGRAM_FILE])?
            }
        }
        folder.write_checksums(&list)
    }
}
