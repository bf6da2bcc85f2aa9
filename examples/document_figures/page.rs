//! The page of all figures, and the tables and plots beside it.

use std::path::{Path, PathBuf};

use qsplat::format::write_file;
use qsplat::{Error, Result};

/// A page of sections, written to a folder with the files that it shows.
pub struct Page {
    folder: PathBuf,
    text: String,
}

impl Page {
    /// An empty page.
    pub fn new(folder: PathBuf) -> Self {
        let text = "# The documents' figures\n\nMade by `scripts/figures`. `T` is Ivo's thesis \
                    (Universidade Federal do Ceará, 2020), `P` the paper by Ivo, Vidal and \
                    Cavalcante-Neto on clip partners. `D` is the diagonal of a model's bounding \
                    box.\n"
            .to_owned();
        Self { folder, text }
    }

    /// Begins a section.
    pub fn section(&mut self, title: &str) {
        self.text += &format!("\n## {title}\n");
    }

    /// Adds a paragraph.
    pub fn say(&mut self, paragraph: &str) {
        self.text += &format!("\n{paragraph}\n");
    }

    /// Adds a table, and writes it as `NAME.csv`.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn table(&mut self, name: &str, columns: &[&str], rows: &[Vec<String>]) -> Result<()> {
        self.text += &format!("\n| {} |\n|{}\n", columns.join(" | "), "---|".repeat(columns.len()));
        let mut csv = record(columns.iter().copied());
        for row in rows {
            self.text += &format!("| {} |\n", row.join(" | "));
            csv += &record(row.iter().map(String::as_str));
        }
        let file = format!("{name}.csv");
        self.text += &format!("\nThe same rows: [{file}]({file}).\n");
        self.file(&file, csv.as_bytes())
    }

    /// Adds a picture, and writes it as `NAME.svg`.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn picture(&mut self, name: &str, what: &str, svg: &str) -> Result<()> {
        let file = format!("{name}.svg");
        self.text += &format!("\n![{what}]({file})\n");
        self.file(&file, svg.as_bytes())
    }

    /// All of it.
    pub fn markdown(&self) -> &str {
        &self.text
    }

    /// Writes the page as `figures.md`.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(&self) -> Result<()> {
        self.file("figures.md", self.text.as_bytes())
    }

    fn file(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let folder: &Path = &self.folder;
        std::fs::create_dir_all(folder).map_err(Error::io(folder))?;
        write_file(&folder.join(name), bytes)
    }
}

/// A line of a CSV (RFC 4180): fields with commas or quotes are quoted.
fn record<'a>(fields: impl Iterator<Item = &'a str>) -> String {
    let quoted = |field: &str| match field.contains([',', '"']) {
        true => format!("\"{}\"", field.replace('"', "\"\"")),
        false => field.to_owned(),
    };
    fields.map(quoted).collect::<Vec<_>>().join(",") + "\n"
}
