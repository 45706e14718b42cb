//! Confusion matrix as an SVG heat map.

use super::confusion_matrix::ConfusionMatrix;
use plot::diagram::{DrawingError, SvgArea, svg_picture};
use plotters::prelude::{
    BLACK, Color, FontTransform, IntoFont, RGBColor, Rectangle, Text, TextStyle, WHITE,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Side of a cell, pixels; doubled up to [`FEW_CATEGORIES`] categories.
const CELL_PX: i32 = 18;
/// Maximum number of categories for large cells.
const FEW_CATEGORIES: usize = 25;
/// Space for names and titles, pixels.
const NAMES_PX: i32 = 190;
/// Font size of names, and of percentages in large cells, pixels.
const FONT_PX: i32 = 12;

/// Row-normalised confusion matrix as SVG: a row per true category, a column per answer and one
/// for "unknown". Cells above 0.5 % show their percentage; darker means more. Blue is right, red
/// is wrong.
///
/// # Errors
/// If the plotting library fails.
pub fn svg(confusion: &ConfusionMatrix, names: &[String]) -> Result<String, DrawingError> {
    let n = confusion.n_categories();
    let cell_px = if n <= FEW_CATEGORIES {
        2 * CELL_PX
    } else {
        CELL_PX
    };
    let side_px = NAMES_PX + cell_px * (n as i32 + 1) + 10;
    svg_picture((side_px as u32, side_px as u32), |area| {
        let unknown = "unknown".to_owned();
        for (index, name) in names.iter().take(n).chain([&unknown]).enumerate() {
            let middle_px = NAMES_PX + cell_px * index as i32 + cell_px / 2;
            draw_column_name(area, name, middle_px)?;
            if index < n {
                draw_row_name(area, name, middle_px)?;
            }
        }
        for truth in 0..n {
            draw_row(area, confusion.row(truth), truth, cell_px)?;
        }
        Ok(())
    })
}

fn draw_row(
    area: &SvgArea<'_>,
    row: &[u32],
    truth: usize,
    cell_px: i32,
) -> Result<(), DrawingError> {
    let n_asked: u32 = row.iter().sum();
    for (answer, &count) in row.iter().enumerate() {
        let share = f64::from(count) / f64::from(n_asked.max(1));
        let corner = |i: i32| {
            let [column, row] = [answer, truth].map(|index| index as i32 + i);
            (NAMES_PX + cell_px * column, NAMES_PX + cell_px * row)
        };
        let cell = [corner(0), corner(1)];
        let color = cell_color(share, answer == truth);
        area.draw(&Rectangle::new(cell, color.filled()))?;
        let border = RGBColor(225, 225, 225).stroke_width(1);
        area.draw(&Rectangle::new(cell, border))?;
        if 100.0 * share > 0.5 {
            let ink = if share > 0.6 { WHITE } else { BLACK };
            let font_px = if cell_px > CELL_PX { FONT_PX } else { 9 };
            let style = ("sans-serif", font_px).into_font().color(&ink);
            let middle = (cell[0].0 + cell_px / 2, cell[0].1 + cell_px / 2);
            let style = style.pos(Pos::new(HPos::Center, VPos::Center));
            let text = format!("{:.0}", 100.0 * share);
            area.draw(&Text::new(text, middle, style))?;
        }
    }
    Ok(())
}

/// Cell colour: white for 0, blue for right answers, red for wrong ones.
fn cell_color(share: f64, is_right: bool) -> RGBColor {
    let [r, g, b] = if is_right {
        [20.0, 80.0, 160.0]
    } else {
        [200.0, 30.0, 30.0]
    };
    // Square root, so that small shares remain visible.
    let weight = share.sqrt();
    let [r, g, b] = [r, g, b].map(|value: f64| (255.0 + (value - 255.0) * weight) as u8);
    RGBColor(r, g, b)
}

fn draw_row_name(area: &SvgArea<'_>, name: &str, middle_px: i32) -> Result<(), DrawingError> {
    let style = TextStyle::from(("sans-serif", FONT_PX));
    let style = style.pos(Pos::new(HPos::Right, VPos::Center));
    let text = Text::new(name.to_owned(), (NAMES_PX - 6, middle_px), style);
    Ok(area.draw(&text)?)
}

fn draw_column_name(area: &SvgArea<'_>, name: &str, middle_px: i32) -> Result<(), DrawingError> {
    let font = ("sans-serif", FONT_PX).into_font();
    let font = font.transform(FontTransform::Rotate270);
    let style = TextStyle::from(font).pos(Pos::new(HPos::Left, VPos::Center));
    let text = Text::new(name.to_owned(), (middle_px, NAMES_PX - 6), style);
    Ok(area.draw(&text)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figure_shows_names_and_percentages() {
        let mut confusion = ConfusionMatrix::new(2);
        (0..3).for_each(|_| confusion.count(0, Some(0)));
        confusion.count(0, Some(1));
        confusion.count(1, None);
        let names = ["cup & saucer".to_owned(), "bowl".to_owned()];
        let svg = svg(&confusion, &names).unwrap();
        for part in [
            "cup &amp; saucer",
            "bowl",
            "unknown",
            "\n75",
            "\n25",
            "\n100",
        ] {
            assert!(svg.contains(part), "{part} is not in {svg}");
        }
    }
}
