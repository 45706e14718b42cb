//! Report of an experiment as text, HTML page and JSON file, from one description of its tables.

use crate::output_files::{write, write_figure};
use command_line::{Output, format_table};
use plot::figure_page::{PageFigure, PageTable, html};
use plot::forest_plot::{self, ForestPlotRow};
use serde::Serialize;
use service::Failure;
use statistics::bootstrap::Estimate;
use std::path::Path;
use std::process::ExitCode;

/// Heading and cells of a table's column, from the item of each row.
pub(crate) type Column<'c, T> = (&'static str, &'c dyn Fn(&T) -> String);

/// Table of a report: title, column headings, rows of cells.
#[derive(Debug, Clone)]
pub(crate) struct ReportTable {
    title: &'static str,
    heads: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

/// Everything that a report shows beside its JSON document.
#[derive(Debug, Default)]
pub(crate) struct TabularReport<'r> {
    /// Title of the HTML page.
    pub(crate) title: &'r str,
    /// Tables in order; those without rows are not shown.
    pub(crate) tables: Vec<ReportTable>,
    /// Notes below the tables, one sentence each.
    pub(crate) notes: Vec<String>,
    /// Figures of the HTML page.
    pub(crate) figures: Vec<PageFigure>,
    /// Note about the figures, for the HTML page only.
    pub(crate) figure_note: Option<&'static str>,
    /// Paths of the written files, for the text only.
    pub(crate) files: Vec<String>,
}

impl ReportTable {
    /// Table with a row for each item.
    pub(crate) fn of<T>(
        title: &'static str,
        items: impl IntoIterator<Item = T>,
        columns: &[Column<'_, T>],
    ) -> Self {
        let row = |item: T| columns.iter().map(|(_, cell)| cell(&item)).collect();
        Self {
            title,
            heads: columns.iter().map(|(head, _)| *head).collect(),
            rows: items.into_iter().map(row).collect(),
        }
    }

    /// Table with given cells.
    pub(crate) fn new(
        title: &'static str,
        heads: Vec<&'static str>,
        rows: Vec<Vec<String>>,
    ) -> Self {
        Self { title, heads, rows }
    }

    /// Appends the rows of a table with the same columns.
    pub(crate) fn and(mut self, below: Self) -> Self {
        self.rows.extend(below.rows);
        self
    }

    /// Last cells of a row from a column on, joined by commas.
    pub(crate) fn joined(&self, row: usize, first_column: usize) -> String {
        self.rows[row][first_column..].join(", ")
    }
}

impl TabularReport<'_> {
    /// Report as text for the terminal.
    pub(crate) fn text(&self) -> String {
        let shown = self.tables.iter().filter(|table| !table.rows.is_empty());
        let has_titles = self.tables.len() > 1;
        let tables = shown.flat_map(|table| {
            let title = has_titles.then(|| table.title.to_owned());
            let table = [format_table(&table.heads, &table.rows), String::new()];
            title.into_iter().chain(table)
        });
        let lines = tables.chain(self.notes.iter().chain(&self.files).cloned());
        lines.collect::<Vec<_>>().join("\n")
    }

    /// HTML page with the tables and the figures.
    fn html(&self) -> String {
        let shown = self.tables.iter().filter(|table| !table.rows.is_empty());
        let tables =
            shown.map(|table| PageTable::new(table.title, &table.heads, table.rows.clone()));
        let about_figures = self.figure_note.map(str::to_owned);
        let notes: Vec<String> = about_figures
            .into_iter()
            .chain(self.notes.clone())
            .collect();
        html(
            self.title,
            &notes,
            &tables.collect::<Vec<_>>(),
            &self.figures,
        )
    }

    /// Writes the HTML page as `index.html`, and the JSON document under a name.
    pub(crate) fn write(
        &self,
        out: &Path,
        name: &str,
        document: &impl Serialize,
    ) -> Result<(), Failure> {
        let json = serde_json::to_string_pretty(document).map_err(Failure::general)?;
        write(&out.join(name), json.as_bytes())?;
        write(&out.join("index.html"), self.html().as_bytes())
    }

    /// Writes the page and the document, and answers with the document or the text.
    pub(crate) fn publish(
        &self,
        out: &Path,
        name: &str,
        document: &impl Serialize,
        output: &Output,
    ) -> Result<ExitCode, Failure> {
        self.write(out, name, document)?;
        output.answer(document, || self.text());
        Ok(ExitCode::SUCCESS)
    }
}

/// Figure of a page, with its caption.
pub(crate) fn figure(picture: &str, caption: impl Into<String>) -> PageFigure {
    PageFigure {
        caption: caption.into(),
        picture: picture.to_owned(),
    }
}

/// Writes a forest plot; returns the figure of the page.
pub(crate) fn forest_figure(
    out: &Path,
    picture: &str,
    (caption, axis): (&str, &str),
    rows: &[ForestPlotRow],
) -> Result<PageFigure, Failure> {
    write_figure(out, picture, forest_plot::svg(caption, axis, rows))?;
    Ok(figure(picture, caption))
}

/// Cell of a number; a dash where there is none.
pub(crate) fn number(value: impl Into<Option<f64>>, n_decimals: usize) -> String {
    let value = value.into().filter(|value| value.is_finite());
    value.map_or("-".to_owned(), |value| format!("{value:.n_decimals$}"))
}

/// Cell of a share, 0 to 1, in percent; a dash where there is none.
pub(crate) fn percent(share: impl Into<Option<f64>>) -> String {
    number(share.into().map(|share| 100.0 * share), 1)
}

/// Cell of an interval, `0.712 (0.690 to 0.731)`; a dash where there is none.
pub(crate) fn interval(estimate: Option<Estimate>, n_decimals: usize) -> String {
    estimate.map_or("-".to_owned(), |Estimate { value, low, high }| {
        format!("{value:.n_decimals$} ({low:.n_decimals$} to {high:.n_decimals$})")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_page_show_the_same_rows() {
        let columns: [Column<'_, (&str, f64)>; 2] = [
            ("name", &|row| row.0.to_owned()),
            ("share", &|row| percent(row.1)),
        ];
        let table = ReportTable::of("Shares", [("mug", 0.5)], &columns);
        let report = TabularReport {
            title: "Report",
            tables: vec![
                table.and(ReportTable::of("", [("box", f64::NAN)], &columns)),
                ReportTable::of("Nothing", [], &columns),
            ],
            notes: vec!["a note".to_owned()],
            figure_note: Some("blue is right"),
            ..TabularReport::default()
        };
        assert_eq!(
            report.text(),
            "Shares\nname  share\nmug   50.0\nbox   -\n\na note"
        );
        let page = report.html();
        for part in ["<td>50.0</td>", "<td>-</td>", "a note", "blue is right"] {
            assert!(page.contains(part), "{part} is not in {page}");
        }
        assert!(!page.contains("Nothing"));
    }
}
