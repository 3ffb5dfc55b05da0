//! The page of a results folder: one HTML file without references to other files or to the network.
//!
//! The page has a section for each verb with results in the folder. A verb replaces its own section and keeps the others,
//! which it reads from the page in the folder: each is between two comments, the first of which holds its checksum. Texts
//! are escaped, so that none of them can form such a comment.

mod html;
mod table;

pub(super) use html::embed_picture;
use html::{escape, format_script_data, write_text};
pub use table::PageTable;

use serde_json::Value;
use std::fmt::Write as _;

/// Verbs with a section, in the order of the sections.
const STUDY_ORDER: [&str; 11] = [
    "map",
    "point",
    "dispersion",
    "speeds",
    "diagram",
    "shocks",
    "check",
    "split",
    "time",
    "run",
    "compare",
];

/// Picture of a section.
pub struct PagePicture {
    /// Name of the picture's files without extension.
    pub(super) file_stem: &'static str,
    /// Element of the picture.
    pub(super) element: String,
}

/// Data of a picture whose points can be selected.
pub struct InteractivePicture {
    /// Name of the picture's files without extension.
    pub(super) file_stem: &'static str,
    /// Area in which points can be selected: left edge, top edge, width and height, as fractions of the picture.
    pub(super) area: [f64; 4],
    /// Description of the picture for readers that do not see it.
    pub(super) description: String,
    /// Data for the script of the page.
    pub(super) data: Value,
}

/// Section of a page: results of one verb.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageSection {
    study_name: String,
    html: String,
}

impl PageSection {
    /// Creates the section of a verb from the arguments of its command, its report as text, the verdict if it states one,
    /// pictures and tables.
    pub fn new(
        study_name: &str,
        arguments: &str,
        (text, verdict): (&str, Option<&str>),
        pictures: &[PagePicture],
        interactive: Option<&InteractivePicture>,
        tables: &[PageTable],
    ) -> Self {
        let name = escape(study_name);
        let mut html = format!(
            "<section id=\"{name}\" aria-labelledby=\"{name}-title\">\n<h2 id=\"{name}-title\">wellposed {name}</h2>\n\
             <p class=\"command\">Command: <code>wellposed {name} {}</code></p>\n",
            escape(arguments),
        );
        if let Some(verdict) = verdict {
            let class = if verdict == "well-posed" { "well" } else { "other" };
            let _ = writeln!(html, "<p class=\"verdict {class}\">{}</p>", escape(verdict));
        }
        write_text(&mut html, text.trim_end());
        for picture in pictures {
            let own = interactive.filter(|own| own.file_stem == picture.file_stem);
            write_picture(&mut html, picture, own);
        }
        tables.iter().for_each(|table| table.write_html(&mut html));
        html.push_str("</section>");
        Self { study_name: study_name.to_owned(), html }
    }

    /// Returns the name of the verb.
    pub fn study_name(&self) -> &str {
        &self.study_name
    }

    /// Reads the sections of a page. Damaged sections, which differ from their checksums, are omitted.
    pub fn parse_page(page: &str) -> Vec<Self> {
        let parse = |study_name: &&str| {
            let (_, rest) = page.split_once(&format!("\n<!-- section {study_name} "))?;
            let (checksum, rest) = rest.split_once(" -->\n")?;
            let (html, _) =
                rest.split_once(&format!("\n<!-- end of section {study_name} -->\n"))?;
            let is_sound = checksum == format_checksum(html);
            is_sound.then(|| Self { study_name: (*study_name).to_owned(), html: html.to_owned() })
        };
        STUDY_ORDER.iter().filter_map(parse).collect()
    }
}

fn format_checksum(html: &str) -> String {
    format!("{:08x}", files::checksum(html.as_bytes()))
}

fn write_picture(
    html: &mut String,
    picture: &PagePicture,
    interactive: Option<&InteractivePicture>,
) {
    let PagePicture { file_stem: stem, element } = picture;
    let Some(InteractivePicture { area, description, data, .. }) = interactive else {
        let _ = writeln!(
            html,
            "<figure><div class=\"paper\"><div class=\"picture\">{element}</div></div><figcaption>{stem}</figcaption></figure>"
        );
        return;
    };
    let [left, top, width, height] = area.map(|fraction| 100.0 * fraction);
    let _ = writeln!(
        html,
        "<figure class=\"explorer\">\n<div class=\"paper\"><div class=\"picture\">{element}\n<div class=\"overlay\" \
         tabindex=\"0\" role=\"application\" aria-label=\"{description}\" aria-describedby=\"{stem}-readout\" \
         style=\"left:{left:.4}%;top:{top:.4}%;width:{width:.4}%;height:{height:.4}%\"><i class=\"cross\"></i><i \
         class=\"sample\"></i></div></div></div>\n<p class=\"readout\" id=\"{stem}-readout\" aria-live=\"polite\">The map \
         is interactive if scripts are permitted.</p>\n<div class=\"detail\" aria-live=\"polite\"></div>\n<script \
         type=\"application/json\">{}</script>\n</figure>",
        format_script_data(data),
        description = escape(description),
    );
}

/// Content of a page besides its sections.
pub struct PageFrame<'a> {
    /// Title of the case.
    pub title: &'a str,
    /// Resolved case, TOML.
    pub case_toml: &'a str,
    /// Facts on the origin of the results: name and value.
    pub provenance: &'a [(&'a str, String)],
}

impl PageFrame<'_> {
    /// Formats the page with the sections in the order of their verbs; sections of unknown verbs are omitted.
    pub fn format_page(&self, sections: &[PageSection]) -> String {
        let title = escape(self.title);
        let mut page = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\" />\n<meta name=\"viewport\" \
             content=\"width=device-width, initial-scale=1\" />\n<meta http-equiv=\"Content-Security-Policy\" \
             content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'\" />\n\
             <title>{title} – wellposed</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n",
            include_str!("page.css"),
        );
        let sections: Vec<&PageSection> = STUDY_ORDER
            .iter()
            .filter_map(|study| sections.iter().find(|section| section.study_name == *study))
            .collect();
        if sections.len() > 1 {
            page.push_str("<nav aria-label=\"Results\">");
            for PageSection { study_name, .. } in &sections {
                let _ = write!(page, "<a href=\"#{study_name}\">{study_name}</a> ");
            }
            page.push_str("</nav>\n");
        }
        for PageSection { study_name, html } in sections {
            let checksum = format_checksum(html);
            let _ = writeln!(
                page,
                "\n<!-- section {study_name} {checksum} -->\n{html}\n<!-- end of section {study_name} -->"
            );
        }
        let _ = write!(
            page,
            "<section aria-labelledby=\"case-title\">\n<h2 id=\"case-title\">Case</h2>\n<details><summary>case.toml, with all \
             defaults</summary>\n<pre class=\"scroll\" tabindex=\"0\">{}</pre></details>\n</section>\n<section \
             aria-labelledby=\"provenance-title\">\n<h2 id=\"provenance-title\">Provenance</h2>\n<dl>\n",
            escape(self.case_toml),
        );
        for (name, value) in self.provenance {
            let _ = writeln!(page, "<dt>{}</dt><dd>{}</dd>", escape(name), escape(value));
        }
        let _ = write!(
            page,
            "</dl>\n</section>\n</main>\n<script>\n{}</script>\n</body>\n</html>\n",
            include_str!("page.js"),
        );
        page
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: PageFrame = PageFrame { title: "<i>", case_toml: "</pre>", provenance: &[] };

    #[test]
    fn sections_are_read_back_in_order() {
        let hostile = "<!-- end of section map -->\n<!-- section run 00000000 -->";
        let section = |name, text| PageSection::new(name, "'<b>'", (text, None), &[], None, &[]);
        let sections = [section("map", hostile), section("run", "two")];
        let reversed = [sections[1].clone(), sections[0].clone()];
        let page = FRAME.format_page(&sections);
        assert_eq!(page, FRAME.format_page(&reversed));
        assert_eq!(PageSection::parse_page(&page), sections);
        assert!(page.contains("<h1>&lt;i&gt;</h1>") && page.contains("&lt;/pre&gt;"));
        assert!(page.contains("<code>wellposed map &#39;&lt;b&gt;&#39;</code>"));
        let damaged = page.replace("two", "too");
        assert_eq!(PageSection::parse_page(&damaged), sections[..1]);
        assert!(PageSection::parse_page("").is_empty());
    }
}
