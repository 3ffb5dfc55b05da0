//! `wellposed plot`: redraws the pictures of a results folder from its files.

use super::load::print_hints;
use super::map::add_samples;
use super::progress::{DelayedProgressBar, run_with_progress};
use super::run::{AnimationOutput, create_page_section, draw_animation, read_records};
use crate::case::{Case, TimeDomainRun};
use crate::cli::CommandError;
use crate::cli::folder::{
    AppendedFile, CASE_FILE, FIELDS_ARCHIVE_FILE, JOINT_ARCHIVE_FILE, OutputError, Publication,
    REPORT_PAGE_FILE, ResultFolder, SNAPSHOT_LIST_FILE, has_joint_files, is_snapshot_name,
    list_part_names,
};
use crate::cli::options::create_thread_pool;
use crate::report::page::PagePicture;
use crate::report::point::CertifiedPoint;
use crate::report::{self, PictureOptions, RenderedReport, Report};
use crate::study::check::CheckExtent;
use crate::study::{self, BoxRange, MapOptions, ProgressCallback};
use analysis::flows::Route;
use files::csv::read_first_rows;
use rayon::ThreadPool;
use serde_json::Value;
use std::io::{Read, Write};
use std::path::Path;

/// Number of bytes of the table of a map among which its column names are searched.
const MAX_HEADER_LENGTH: u64 = 1 << 16;

/// Verbs whose pictures follow from the case alone.
const STUDIES: [&str; 8] =
    ["map", "point", "dispersion", "diagram", "speeds", "shocks", "check", "split"];

/// Runs the verb `plot`: redraws the pictures of all results in a folder from the files of the folder. A run is redrawn
/// from its fields and tables. Other results are computed again from `case.toml`, since they take little time, and must
/// be those of the folder.
///
/// # Errors
/// The folder holds no finished results, its case was changed in more than the plot options, a result file is damaged,
/// cannot be read or written, or is not what this program computes.
pub fn plot(
    path: &Path,
    options: &PictureOptions,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let has_results = |verb: &&str| path.join(format!("{verb}.json")).exists();
    let studies: Vec<&str> = STUDIES.into_iter().filter(has_results).collect();
    if studies.is_empty() && !path.join(CASE_FILE).exists() {
        return Err(OutputError {
            path: path.to_owned(),
            cause: if path.is_dir() { "no results" } else { "no such folder" }.to_owned(),
            remedy: "name a folder with results of wellposed map, point, dispersion, diagram, speeds, shocks, check, \
                     split or run",
        }
        .into());
    }
    let mut names = Vec::new();
    if has_results(&"run") || studies.is_empty() {
        names.extend(redraw_run(path, options)?);
    }
    if !studies.is_empty() {
        let (folder, case) = ResultFolder::open_study(path)?;
        print_hints(&case);
        let redrawing = Redrawing { folder: &folder, case: &case, options };
        let pool = create_thread_pool(None)?;
        for verb in studies {
            names.extend(redrawing.redraw_study(verb, &pool)?);
        }
    }
    if names.is_empty() && options.has_page {
        names.push(REPORT_PAGE_FILE.to_owned());
    }
    for name in names {
        writeln!(stdout, "picture: {}", path.join(name).display())?;
    }
    Ok(())
}

/// Redraws the pictures of a run; returns the name of the first.
pub(super) fn redraw_run(
    path: &Path,
    options: &PictureOptions,
) -> Result<Option<String>, CommandError> {
    let (folder, case) = ResultFolder::open_finished_run(path)?;
    print_hints(&case);
    if !list_part_names(path)?.is_empty() {
        return Err(OutputError {
            path: path.to_owned(),
            cause: "its fields are in parts, which several processes have written".to_owned(),
            remedy: "join them with wellposed gather, which also draws the pictures",
        }
        .into());
    }
    folder.check_files(|name| {
        let is_table = [AppendedFile::Receivers, AppendedFile::Ledger, AppendedFile::Spectrum];
        is_snapshot_name(name)
            || [FIELDS_ARCHIVE_FILE, JOINT_ARCHIVE_FILE, SNAPSHOT_LIST_FILE].contains(&name)
            || is_table.iter().any(|table| table.name() == name)
            || (options.has_page && ["run.txt", "run.json", "joints.csv"].contains(&name))
    })?;
    let archive = folder.path().join(FIELDS_ARCHIVE_FILE);
    let bytes = files::read_regular_file(&archive)
        .map_err(|error| OutputError::from_read_error(&archive, &error))?;
    let cells = match case.time_domain_run()? {
        TimeDomainRun::Solid(own) => own.grid.cell_count(),
        TimeDomainRun::Flow(own) => own.grid.point_count(),
    };
    let mut fields = report::run::read_fields(&bytes, cells)
        .map_err(|error| OutputError::from_invalid_content(&archive, error))?;
    if let Some(own) = case.solid_run.as_ref().filter(|_| has_joint_files(&case)) {
        let archive = folder.path().join(JOINT_ARCHIVE_FILE);
        let bytes = files::read_regular_file(&archive)
            .map_err(|error| OutputError::from_read_error(&archive, &error))?;
        fields.joint_faces = report::run::read_joints(&bytes, &own.grid)
            .map_err(|error| OutputError::from_invalid_content(&archive, error))?;
    }
    let pictures = report::run::create_pictures(&case, &fields, &read_records(&case, &folder)?)?;
    let mut publication = folder.start_redrawing("run");
    let of_page = stage_pictures(&mut publication, &pictures, options)?;
    if options.has_page {
        let read = |name: &str| {
            let path = folder.path().join(name);
            let bytes = files::read_regular_file(&path)
                .map_err(|error| OutputError::from_read_error(&path, &error))?;
            Ok::<_, OutputError>(String::from_utf8_lossy(&bytes).into_owned())
        };
        let reports = [read("run.txt")?, read("run.json")?];
        publication.set_page_section(create_page_section(&case, &folder, &reports, &of_page)?);
    }
    match draw_animation(&case, &folder, options)? {
        AnimationOutput::NoAnimation => {}
        AnimationOutput::AllZero(names) => {
            names.iter().for_each(|name| publication.schedule_removal(name));
        }
        AnimationOutput::Files(animations) => {
            for (name, bytes) in animations {
                publication.stage_file(&name, &bytes)?;
            }
        }
    }
    publication.publish()?;
    Ok(options.file_names("run").next())
}

/// Draws pictures and shows the progress; returns those of the page.
fn stage_pictures(
    publication: &mut Publication,
    pictures: &[report::ReportPicture],
    options: &PictureOptions,
) -> Result<Vec<PagePicture>, CommandError> {
    let file_count = (pictures.len() * options.formats.len()) as u64;
    let progress = DelayedProgressBar::new("pictures", file_count);
    let mut done = 0;
    report::draw_pictures(pictures, options, |name, bytes| {
        done += 1;
        progress.advance_to(done, file_count);
        publication.stage_file(name, bytes).map_err(CommandError::from)
    })
}

/// Folder with results of studies, whose pictures are redrawn.
struct Redrawing<'a> {
    folder: &'a ResultFolder,
    case: &'a Case,
    options: &'a PictureOptions,
}

impl Redrawing<'_> {
    /// Computes the results of a verb again and draws their pictures; returns the name of the first.
    fn redraw_study(&self, verb: &str, pool: &ThreadPool) -> Result<Option<String>, CommandError> {
        let case = self.case;
        match verb {
            "map" => {
                let options = self.read_map_options()?;
                let compute =
                    |progress: ProgressCallback| study::compute_map(case, options, progress);
                let mut found = run_with_progress(pool, "map", compute)?;
                if self.options.has_page {
                    add_samples(&mut found, case, pool)?;
                }
                self.redraw_result(&found)
            }
            "point" => match self.read_proof_ranges()? {
                Some(ranges) => self.redraw(pool, |progress| {
                    let point = study::analyse_point(case, progress)?;
                    let certified = study::certify_state(case, &ranges)?;
                    Ok(CertifiedPoint { point, certified })
                }),
                None => self.redraw(pool, |progress| study::analyse_point(case, progress)),
            },
            "dispersion" if case.has_joints() => {
                self.redraw(pool, |progress| study::compute_bloch_waves(case, progress))
            }
            "dispersion" => self.redraw(pool, |progress| study::compute_dispersion(case, progress)),
            "diagram" => self.redraw(pool, |_| study::compute_diagram(case)),
            "speeds" => self.redraw(pool, |progress| study::compute_speeds(case, progress)),
            "shocks" => self.redraw(pool, |_| study::compute_shocks(case)),
            "split" => {
                let (ranks, threads) = self.read_split_options()?;
                self.redraw(pool, |_| study::simulate::plan_split(case, ranks, threads))
            }
            _ => self
                .redraw(pool, |progress| study::check_agreement(case, CheckExtent::Full, progress)),
        }
    }

    fn redraw<R: Report + Send>(
        &self,
        pool: &ThreadPool,
        compute: impl FnOnce(ProgressCallback) -> Result<R, crate::Error> + Send,
    ) -> Result<Option<String>, CommandError> {
        self.redraw_result(&run_with_progress(pool, R::NAME, compute)?)
    }

    fn redraw_result<R: Report>(&self, found: &R) -> Result<Option<String>, CommandError> {
        let path = self.folder.path().join(format!("{}.json", R::NAME));
        let mut rendered = RenderedReport::new(found, self.case)?;
        // Texts, since numbers may change by a unit in the last place when they are parsed.
        if self.read(&path)? != rendered.json().as_bytes() {
            return Err(OutputError {
                path,
                cause: "not what this version of the program computes from case.toml".to_owned(),
                remedy: "compute it again with --force",
            }
            .into());
        }
        let pictures = rendered.pictures();
        let first = pictures.first().map(report::ReportPicture::file_stem);
        let mut publication = self.folder.start_redrawing(R::NAME);
        let of_page = stage_pictures(&mut publication, pictures, self.options)?;
        if self.options.has_page {
            publication.set_page_section(rendered.create_page_section(&of_page)?);
        }
        publication.publish()?;
        Ok(first.and_then(|stem| self.options.file_names(stem).next()))
    }

    fn read(&self, path: &Path) -> Result<Vec<u8>, OutputError> {
        files::read_regular_file(path).map_err(|error| OutputError::from_read_error(path, &error))
    }

    fn read_report(&self, name: &str) -> Result<Value, OutputError> {
        let path = self.folder.path().join(name);
        serde_json::from_slice(&self.read(&path)?)
            .map_err(|error| OutputError::from_invalid_content(&path, error))
    }

    /// Reads the ranges of numbers over which a verdict was proved from the report of `point`; `None` if none was proved.
    fn read_proof_ranges(&self) -> Result<Option<Vec<BoxRange>>, OutputError> {
        let point = self.read_report("point.json")?;
        let Some(axes) = point["certified"]["box"].as_array() else { return Ok(None) };
        let read = |own: &Value| {
            let ends = [own["from"].as_f64()?, own["to"].as_f64()?];
            Some(BoxRange { key: own["key"].as_str()?.to_owned(), ends })
        };
        let ranges: Option<Vec<BoxRange>> = axes.iter().map(read).collect();
        ranges.map(Some).ok_or_else(|| {
            let path = self.folder.path().join("point.json");
            OutputError::from_invalid_content(&path, "no ranges of the proof")
        })
    }

    /// Reads the numbers of ranks and of threads of each from the report of `split`.
    fn read_split_options(&self) -> Result<(usize, usize), OutputError> {
        let split = self.read_report("split.json")?;
        let ranks = split["ranks"].as_array().map(Vec::len);
        let threads = split["thread_count"].as_u64().and_then(|own| usize::try_from(own).ok());
        ranks.zip(threads).ok_or_else(|| {
            let path = self.folder.path().join("split.json");
            OutputError::from_invalid_content(&path, "no numbers of ranks and threads")
        })
    }

    /// Determines the options with which the map was computed from its table and its report. Without a verdict by closed
    /// form, the map is the one with all verdicts from the linearised equations.
    fn read_map_options(&self) -> Result<MapOptions, OutputError> {
        let path = self.folder.path().join("map.csv");
        let table = files::open_regular_file(&path)
            .and_then(|file| read_first_rows(file.take(MAX_HEADER_LENGTH), 0));
        let table = table.map_err(|error| OutputError::from_read_error(&path, &error))?;
        let has_column = |name: &str| table.header.iter().any(|column| column == name);
        let map = self.read_report("map.json")?;
        Ok(MapOptions {
            computes_bound: has_column("bound"),
            computes_growth_rate: has_column("growth_rate"),
            is_model_blind: map["route"][Route::ClosedForm.name()] == 0,
            is_certified: map.get("certified").is_some(),
        })
    }
}
