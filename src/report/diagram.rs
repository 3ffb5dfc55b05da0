//! Report on the uniaxial diagram of a rheological scheme.

use super::format::{case_title, format_short};
use super::{DataFile, Report, ReportPicture};
use crate::Error;
use crate::case::Case;
use crate::study::diagram::{DiagramResult, SegmentResult};
use figures::{DiagramCurve, DiagramFigure};
use files::csv::CsvCell;
use models::rheology::element::Element;
use models::rheology::load_path::ResponsePoint;
use std::fmt::Write as _;

/// Maximum number of segments in the text report; the JSON report has all.
const MAX_LISTED_SEGMENTS: usize = 20;

impl Report for DiagramResult {
    const NAME: &'static str = "diagram";
    const UNITS: &'static [(&'static str, &'static str)] = &[
        ("time", "s"),
        ("stress", "Pa"),
        ("slope", "Pa"),
        ("work", "J/m³"),
        ("stored_energy", "J/m³"),
        ("dissipated_energy", "J/m³"),
        ("step_loss", "J/m³"),
    ];

    fn to_text(&self, case: &Case) -> String {
        let mut text = format!(
            "{}\nscheme: {}\ntree: {}\n{} prescribed, {} steps; strains and stresses positive in tension\n",
            case_title(case),
            scheme_title(case),
            self.tree,
            self.control,
            self.steps,
        );
        self.write_segments(&mut text);
        let [low, high] = self.stress_range.map(format_short);
        let _ = writeln!(text, "\nstress from {low} to {high} Pa");
        let [low, high] = self.strain_range.map(format_short);
        let _ = writeln!(text, "strain from {low} to {high}");
        let _ = writeln!(text, "\nenergies at the end (J/m³)");
        let _ = writeln!(text, "  work        {}", format_short(self.work));
        let _ = writeln!(text, "  stored      {}", format_short(self.stored_energy));
        for own in self.elements.iter().filter(|own| own.kind == "spring") {
            let _ = writeln!(text, "    {}: {}", own.name, format_short(own.stored_energy));
        }
        let _ = writeln!(text, "  dissipated  {}", format_short(self.dissipated_energy));
        for own in self.elements.iter().filter(|own| ["damper", "hinge"].contains(&own.kind)) {
            let _ = writeln!(text, "    {}: {}", own.name, format_short(own.dissipated_energy));
        }
        let _ = writeln!(
            text,
            "  lost        {}: half of the work of each jump of the load, and the loss of implicit steps, \
             which vanishes with their length",
            format_short(self.step_loss)
        );
        let residual = format_short(self.ledger_residual);
        let _ = writeln!(text, "  ledger residual: {residual} of the largest energy");
        text
    }

    fn create_pictures(&self, case: &Case) -> Result<Vec<ReportPicture>, Error> {
        let figure = self.create_figure(case);
        Ok(vec![ReportPicture::new(Self::NAME, move |format| figure.draw(format))])
    }

    fn create_tables(&self, _case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        Ok(vec![("diagram.csv", self.create_table())])
    }
}

/// Returns the title of the scheme of a case.
fn scheme_title(case: &Case) -> &'static str {
    case.rheology.as_ref().map_or("rheological scheme", |rheology| rheology.title)
}

impl DiagramResult {
    fn write_segments(&self, text: &mut String) {
        let range = |ends: [f64; 2]| {
            let [from, to] = ends.map(format_short);
            format!("{from} … {to}")
        };
        let row = |segment: &SegmentResult| {
            let is_vertical = segment.strain[0] == segment.strain[1];
            let no_slope = if is_vertical { "vertical" } else { "curved" };
            let slope = segment.slope.map_or_else(|| no_slope.to_owned(), format_short);
            let activities = self.describe_activities(segment);
            [range(segment.strain), range(segment.stress), slope, activities]
        };
        let header = ["strain", "stress (Pa)", "slope (Pa)", ""].map(str::to_owned);
        let listed = self.segments.iter().take(MAX_LISTED_SEGMENTS).map(row);
        let rows: Vec<[String; 4]> = std::iter::once(header).chain(listed).collect();
        let width =
            |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths = [0, 1, 2].map(width);
        text.push('\n');
        for [strain, stress, slope, activities] in &rows {
            let [a, b, c] = widths;
            let line = format!("  {strain:<a$}  {stress:<b$}  {slope:<c$}  {activities}");
            let _ = writeln!(text, "{}", line.trim_end());
        }
        let others = self.segments.len().saturating_sub(MAX_LISTED_SEGMENTS);
        if others > 0 {
            let _ = writeln!(text, "  … and {others} more: diagram.json");
        }
    }

    /// Describes flowing hinges and contacts: `hinge flows in compression, open`.
    fn describe_activities(&self, segment: &SegmentResult) -> String {
        let mut parts = Vec::new();
        for (names, direction) in
            [(&segment.tensile_flow, "tension"), (&segment.compressive_flow, "compression")]
        {
            parts.extend(names.iter().map(|name| format!("{name} flows in {direction}")));
        }
        match segment.closed.is_empty() {
            false => parts.push(format!("{} closed", segment.closed.join(", "))),
            true if self.has_contact() => parts.push("open".to_owned()),
            true => {}
        }
        parts.join(", ")
    }

    /// Energy that an element has stored and dissipated, J/m³.
    fn energy_of_element(&self, point: &ResponsePoint, index: usize) -> f64 {
        let (element, state) =
            (&self.rheological_scheme.elements()[index].element, &point.state.elements[index]);
        element.stored_energy(state) + state.dissipated_energy
    }

    fn create_table(&self) -> DataFile<'_> {
        let scheme = &self.rheological_scheme;
        let fixed =
            ["time", "strain", "stress", "work", "stored_energy", "dissipated_energy", "step_loss"];
        let mut header: Vec<String> = fixed.iter().map(|name| (*name).to_owned()).collect();
        for own in scheme.elements() {
            header.extend(["strain", "stress", "energy"].map(|end| format!("{}_{end}", own.name)));
        }
        let rows = self.response.iter().map(move |point| {
            let state = &point.state;
            let mut row: Vec<CsvCell> = vec![
                point.time.into(),
                state.strain.into(),
                state.stress.into(),
                state.work.into(),
                state.stored_energy(scheme).into(),
                state.dissipated_energy().into(),
                state.step_loss().into(),
            ];
            for (index, own) in state.elements.iter().enumerate() {
                row.extend([own.strain.into(), own.stress.into()]);
                row.push(self.energy_of_element(point, index).into());
            }
            row
        });
        DataFile::table("diagram.csv", header, rows)
    }

    fn create_figure(&self, case: &Case) -> DiagramFigure {
        let curve = |label: String, value: &dyn Fn(&ResponsePoint) -> f64| DiagramCurve {
            label,
            points: self.response.iter().map(|point| [point.time, value(point)]).collect(),
        };
        let mut curves = vec![curve("work".to_owned(), &|point| point.state.work)];
        for (index, own) in self.rheological_scheme.elements().iter().enumerate() {
            let verb = match own.element {
                Element::Spring { .. } => "stored in",
                Element::Damper { .. } | Element::Hinge { .. } => "dissipated by",
                Element::Contact { .. } => continue,
            };
            let label = format!("{verb} {}", own.name);
            curves.push(curve(label, &|point| self.energy_of_element(point, index)));
        }
        curves.push(curve("lost in jumps and steps".to_owned(), &|point| point.state.step_loss()));
        DiagramFigure {
            title: case_title(case),
            subtitle: format!("{}: {}", scheme_title(case), self.tree),
            strain_label: "strain ε, positive in tension".to_owned(),
            stress_label: "stress σ (Pa), positive in tension".to_owned(),
            path: self.response.iter().map(|own| [own.state.strain, own.state.stress]).collect(),
            time_label: "time t (s)".to_owned(),
            curve_label: "energy per volume (J/m³)".to_owned(),
            curves,
            start_label: "start (arrows: direction of time)".to_owned(),
            end_label: "end".to_owned(),
        }
    }
}
