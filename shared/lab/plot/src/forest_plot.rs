//! Forest plot: one row per variant with its estimate and confidence interval, as SVG.

use crate::diagram::{DrawingError, SvgArea, svg_picture};
use plotters::prelude::{
    BLACK, BLUE, ChartBuilder, Circle, Color, PathElement, RGBColor, Text, TextStyle, WHITE,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use statistics::bootstrap::Estimate;
use std::ops::Range;

/// Width of the plot, height without rows, and height of a row, pixels.
const WIDTH_PX: u32 = 820;
const FRAME_PX: u32 = 110;
const ROW_PX: u32 = 36;
/// Width of the column of names, pixels.
const NAMES_PX: u32 = 190;
/// Minimum length of the value axis.
const LENGTH_MIN: f64 = 0.02;
/// Colour of the vertical line at the reference estimate.
const PALE_BLUE: RGBColor = RGBColor(130, 170, 245);

/// Row of a forest plot.
#[derive(Debug, Clone, PartialEq)]
pub struct ForestPlotRow {
    /// Name of the compared variant.
    pub name: String,
    /// Estimate with its interval; `None` leaves the row empty.
    pub estimate: Option<Estimate>,
    /// `true` for the reference: a vertical line marks its estimate.
    pub is_reference: bool,
}

/// Forest plot as SVG text: a dot with its confidence interval for each row, top to bottom.
///
/// # Errors
/// If the plotting library fails.
pub fn svg(title: &str, x_label: &str, rows: &[ForestPlotRow]) -> Result<String, DrawingError> {
    let size_px = (WIDTH_PX, FRAME_PX + ROW_PX * rows.len() as u32);
    svg_picture(size_px, |area| draw(area, title, x_label, rows))
}

fn draw(
    area: &SvgArea<'_>,
    title: &str,
    x_label: &str,
    rows: &[ForestPlotRow],
) -> Result<(), DrawingError> {
    let n_rows = rows.len().max(1) as f64;
    let x_range = range(rows);
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 17))
        .margin(12)
        .margin_right(30)
        .margin_left(NAMES_PX)
        .x_label_area_size(40)
        .build_cartesian_2d(x_range, n_rows..0.0)?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .x_desc(x_label)
        .x_label_formatter(&|value| format!("{value:.2}"))
        .light_line_style(WHITE)
        .draw()?;
    for (index, row) in rows.iter().enumerate() {
        let y = index as f64 + 0.5;
        let place_px = (NAMES_PX as i32 - 8, chart.backend_coord(&(0.0, y)).1);
        draw_name(area, &row.name, place_px)?;
        let Some(Estimate { value, low, high }) = row.estimate else {
            continue;
        };
        if row.is_reference {
            let line = PathElement::new([(value, 0.0), (value, n_rows)], PALE_BLUE.stroke_width(2));
            chart.draw_series([line])?;
        }
        let bar = |from, to| PathElement::new([from, to], BLUE.stroke_width(2));
        let end = |x| bar((x, y - 0.15), (x, y + 0.15));
        let lines = [bar((low, y), (high, y)), end(low), end(high)];
        chart.draw_series(lines)?;
        let dot = Circle::new((value, y), 5, BLUE.filled());
        chart.draw_series([dot])?;
    }
    Ok(())
}

/// Value range: all intervals with a margin of 5 %.
fn range(rows: &[ForestPlotRow]) -> Range<f64> {
    let estimates = || rows.iter().filter_map(|row| row.estimate);
    let low = estimates().map(|estimate| estimate.low).reduce(f64::min);
    let high = estimates().map(|estimate| estimate.high).reduce(f64::max);
    let (low, high) = (low.unwrap_or(0.0), high.unwrap_or(1.0));
    let margin = (0.05 * (high - low)).max(0.5 * (LENGTH_MIN - (high - low)));
    low - margin..high + margin
}

fn draw_name(area: &SvgArea<'_>, name: &str, place_px: (i32, i32)) -> Result<(), DrawingError> {
    let style = TextStyle::from(("sans-serif", 14)).color(&BLACK);
    let style = style.pos(Pos::new(HPos::Right, VPos::Center));
    Ok(area.draw(&Text::new(name.to_owned(), place_px, style))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(name: &str, low: f64, high: f64) -> ForestPlotRow {
        ForestPlotRow {
            name: name.to_owned(),
            estimate: Some(Estimate {
                value: f64::midpoint(low, high),
                low,
                high,
            }),
            is_reference: false,
        }
    }

    #[test]
    fn row_without_estimate_has_a_name_but_no_dot() {
        let mut rows = vec![row("ours", 0.8, 0.9), row("no & size", 0.7, 0.75)];
        let lacking = ForestPlotRow {
            estimate: None,
            ..row("published", 0.0, 0.0)
        };
        rows.push(lacking);
        let svg = svg("accuracy", "share", &rows).unwrap();
        for part in ["ours", "no &amp; size", "published", "accuracy", "share"] {
            assert!(svg.contains(part), "{part} is not in {svg}");
        }
        assert_eq!(svg.matches("<circle").count(), 2);
    }

    #[test]
    fn the_axis_covers_all_intervals_and_is_never_empty() {
        let wide = range(&[row("a", 0.2, 0.4), row("b", 0.7, 0.8)]);
        assert!(wide.start < 0.2 && wide.end > 0.8);
        let narrow = range(&[row("a", 0.5, 0.5)]);
        assert!((narrow.end - narrow.start - LENGTH_MIN).abs() < 1e-12);
        assert!(svg("", "", &[]).is_ok());
    }
}
