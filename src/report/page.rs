//! Pages that need nothing but themselves.

use super::markup::escaped;
use super::matrix::Matrix;
use super::plot::{Plot, STYLE};
use super::table::Table;
use std::fmt::Write;

const PAGE_STYLE: &str = include_str!("page.css");
/// The most dots in a figure: some 300 bytes each, and a page is to be light.
const MOST_DOTS: usize = 400;
const SCRIPT: &str = include_str!("page.js");

/// A figure: what is drawn, and the numbers behind it.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// Its name in a word, for files and links.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// What one has to know to read it; may be empty.
    pub note: String,
    svg: String,
    table: Table,
    /// Whether it has axes to be switched.
    axes: bool,
}

impl Figure {
    /// The figure of a plot, with its numbers: about 400 of them, evenly chosen, where there are more.
    pub fn plot(name: &str, title: &str, note: &str, plot: &Plot) -> Self {
        let (name, title, mut note) = (name.to_owned(), title.to_owned(), note.to_owned());
        let thinned = plot.thinned(MOST_DOTS);
        if thinned.is_some() {
            note += " Not all is drawn: there are too many numbers for a page.";
        }
        let plot = thinned.as_ref().unwrap_or(plot);
        Figure { name, title, note, svg: plot.svg(), table: plot.table(), axes: true }
    }

    /// The figure of a matrix, with its mistakes, the commonest first.
    pub fn matrix(name: &str, title: &str, note: &str, matrix: &Matrix) -> Self {
        let (name, title, note) = (name.to_owned(), title.to_owned(), note.to_owned());
        Figure { name, title, note, svg: matrix.svg(), table: matrix.table(), axes: false }
    }

    /// The figure as an SVG file of its own, with its style.
    pub fn file(&self) -> String {
        let inside = format!("<title>{}</title>\n<style>\n{STYLE}</style>\n", escaped(&self.title));
        let start = self.svg.find(">\n").map_or(0, |end| end + 2);
        format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}{inside}{}", &self.svg[..start], &self.svg[start..])
    }

    fn html(&self) -> String {
        let (name, title, note) = (escaped(&self.name), escaped(&self.title), escaped(&self.note));
        let (note, controls) = (
            if note.is_empty() { note } else { format!("<p>{note}</p>\n") },
            if self.axes {
                "<p class=\"controls\" hidden=\"hidden\">logarithmic: <label><input type=\"checkbox\" data-axis=\"x\"/> across</label> \
                 <label><input type=\"checkbox\" data-axis=\"y\"/> up</label></p>\n"
            } else {
                ""
            },
        );
        format!(
            "<figure id=\"{name}\">\n<figcaption><h2>{title}</h2>\n{note}</figcaption>\n{controls}<div class=\"scroll\">{}</div>\n\
             <details><summary>The numbers</summary>\n{}</details>\n</figure>\n",
            self.svg,
            html(&self.table)
        )
    }
}

/// Something to know of how the page came to be.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fact {
    /// What it is about.
    pub name: String,
    /// What is so.
    pub text: String,
}

/// A page: figures, tables and where all of it comes from, in one file of HTML that is well-formed XML, too.
///
/// ```
/// use rollin::report::{Page, Table};
///
/// let mut table = Table::new(["label", "times"]);
/// table.row(["<b>", "3"]);
/// let page = Page { title: "Labels".into(), tables: vec![("All".into(), table)], ..Page::default() };
/// assert!(page.html().contains("<td>&lt;b&gt;</td>"));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// What it is about.
    pub title: String,
    /// What comes first, in a sentence or two; may be empty.
    pub lead: String,
    /// What is drawn.
    pub figures: Vec<Figure>,
    /// Further tables, by their titles.
    pub tables: Vec<(String, Table)>,
    /// How it came to be.
    pub facts: Vec<Fact>,
}

impl Page {
    /// Adds something to know.
    pub fn fact(&mut self, name: &str, text: impl Into<String>) {
        self.facts.push(Fact { name: name.to_owned(), text: text.into() });
    }

    /// The page.
    pub fn html(&self) -> String {
        let title = escaped(&self.title);
        let lead = if self.lead.is_empty() { String::new() } else { format!("<p>{}</p>\n", escaped(&self.lead)) };
        let figures: String = self.figures.iter().map(Figure::html).collect();
        let mut tables = String::new();
        for (name, table) in &self.tables {
            let _ = write!(
                tables,
                "<details open=\"open\"><summary>{}</summary>\n{}</details>\n",
                escaped(name),
                html(table)
            );
        }
        let mut facts = String::new();
        for fact in &self.facts {
            let _ = writeln!(facts, "<dt>{}</dt><dd>{}</dd>", escaped(&fact.name), escaped(&fact.text));
        }
        // The script stands in a section that HTML takes for a comment of the script's, and XML for text as it is.
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n<meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>{title}</title>\n\
             <style>\n{STYLE}{PAGE_STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n{lead}<main>\n{figures}</main>\n{tables}\
             <h2>How this came to be</h2>\n<dl>\n{facts}</dl>\n<div id=\"tip\" role=\"status\" hidden=\"hidden\"></div>\n\
             <script>\n//<![CDATA[\n{SCRIPT}//]]>\n</script>\n</body>\n</html>\n"
        )
    }
}

/// A table as HTML, which scrolls where it is too wide.
fn html(table: &Table) -> String {
    let mut out = String::from("<div class=\"scroll\"><table>\n");
    for (i, row) in table.rows().iter().enumerate() {
        let cell = if i == 0 { "th" } else { "td" };
        let cells: String = row.iter().map(|text| format!("<{cell}>{}</{cell}>", escaped(text))).collect();
        let _ = writeln!(out, "<tr>{cells}</tr>");
    }
    out + "</table></div>\n"
}
