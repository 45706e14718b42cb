//! HTML page of tables and figures.

use crate::html_page::{self, escaped, linked_picture};

/// Picture with a caption.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PageFigure {
    /// Caption of the picture.
    pub caption: String,
    /// Path of the picture, relative to the page; plain text.
    pub picture: String,
}

/// Table whose first row is the header.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PageTable {
    /// Title of the table.
    pub title: String,
    /// Cells, row by row; the first row is the header.
    pub rows: Vec<Vec<String>>,
}

impl PageTable {
    /// Page table from column headings and rows.
    pub fn new(title: &str, heads: &[&str], rows: Vec<Vec<String>>) -> Self {
        let heads = heads.iter().map(|head| (*head).to_owned()).collect();
        Self {
            title: title.to_owned(),
            rows: std::iter::once(heads).chain(rows).collect(),
        }
    }
}

/// HTML page that depends on no other file but the pictures, in the given order.
pub fn html(title: &str, notes: &[String], tables: &[PageTable], figures: &[PageFigure]) -> String {
    let tables = tables.iter().map(table);
    html_page::html(title, notes, tables.chain(figures.iter().map(figure)))
}

fn table(table: &PageTable) -> String {
    let row = |(index, cells): (usize, &Vec<String>)| {
        let tag = if index == 0 { "th" } else { "td" };
        let cells = cells.iter().enumerate().map(|(column, cell)| {
            let class = if is_text(table, column) {
                " class=\"text\""
            } else {
                ""
            };
            format!("<{tag}{class}>{}</{tag}>", escaped(cell))
        });
        format!("<tr>{}</tr>", cells.collect::<String>())
    };
    let rows: Vec<String> = table.rows.iter().enumerate().map(row).collect();
    format!(
        "<table>\n<caption>{}</caption>\n{}\n</table>",
        escaped(&table.title),
        rows.join("\n")
    )
}

/// True for a column with words, which is aligned to the left, unlike numbers.
fn is_text(table: &PageTable, column: usize) -> bool {
    let mut cells = table.rows.iter().skip(1).filter_map(|row| row.get(column));
    cells.any(|cell| cell.starts_with(|first: char| first.is_alphabetic() || first == '`'))
}

fn figure(figure: &PageFigure) -> String {
    let caption = escaped(&figure.caption);
    let picture = linked_picture(&figure.picture, &caption);
    format!("<figure>\n<figcaption>{caption}</figcaption>\n{picture}\n</figure>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped_on_the_page() {
        let table = PageTable {
            title: "a & b".into(),
            rows: vec![
                vec!["<scene>".into(), "name".into()],
                vec!["1".into(), "table".into()],
            ],
        };
        let run = PageFigure {
            caption: "seed \"1\"".into(),
            picture: "tracks/a b.svg".into(),
        };
        let page = html("t", &["x < y".into()], &[table], &[run]);
        for part in [
            "x &lt; y",
            "<caption>a &amp; b</caption>",
            "<th>&lt;scene&gt;</th>",
            "<th class=\"text\">name</th>",
            "<td>1</td><td class=\"text\">table</td>",
            "seed &quot;1&quot;",
            "src=\"tracks/a%20b.svg\"",
        ] {
            assert!(page.contains(part), "{part} is not in {page}");
        }
    }
}
