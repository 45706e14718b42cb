//! Text tables with aligned columns.

use std::borrow::Cow;
use unicode_text::escape_unprintable;

/// Formats a table with a heading and columns as wide as their widest cell. Control characters
/// and line feeds are escaped, so that no cell passes for a row.
pub fn format_table(heading: &[&str], rows: &[Vec<String>]) -> String {
    let printable = |row: &Vec<String>| -> Vec<String> {
        let cells = row.iter().map(|cell| escape_unprintable(cell));
        cells.map(Cow::into_owned).collect()
    };
    let rows: Vec<_> = rows.iter().map(printable).collect();
    let width = |column: usize| {
        let cells = rows
            .iter()
            .filter_map(|row| row.get(column))
            .map(|cell| cell.chars().count());
        cells
            .chain([heading[column].chars().count()])
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..heading.len()).map(width).collect();
    let line = |cells: &mut dyn Iterator<Item = &str>| {
        let padded = cells
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:<width$}"));
        padded.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    let mut lines = vec![line(&mut heading.iter().copied())];
    lines.extend(
        rows.iter()
            .map(|row| line(&mut row.iter().map(String::as_str))),
    );
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let rows = [
            vec!["1".into(), "mug".into()],
            vec!["22".into(), "cereal box".into()],
        ];
        let expected = "id  label\n1   mug\n22  cereal box";
        assert_eq!(format_table(&["id", "label"], &rows), expected);
        assert_eq!(format_table(&["id"], &[]), "id");
    }

    #[test]
    fn cell_with_a_line_feed_stays_one_row() {
        let rows = [vec!["1".into(), "anna\n2  ben".into()]];
        let table = format_table(&["id", "by"], &rows);
        assert_eq!(table, "id  by\n1   anna\\u{a}2  ben");
    }
}
