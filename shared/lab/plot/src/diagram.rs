//! Line charts as SVG: curves in diagrams, diagrams in a grid.
//!
//! The plotting library (plotters) is an implementation detail: callers describe curves and axes.

use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::{
    ChartBuilder, Color as _, DrawingArea, IntoDrawingArea, IntoLogRange, LineSeries, Palette,
    Palette99, PathElement, RGBColor, SVGBackend, SeriesLabelPosition, Text, WHITE,
};
use std::error::Error;
use std::ops::Range;

/// Error of the plotting library.
#[derive(Debug, thiserror::Error)]
#[error("the figure could not be drawn: {0}")]
pub struct DrawingError(String);

impl<E: Error + Send + Sync> From<DrawingAreaErrorKind<E>> for DrawingError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self(error.to_string())
    }
}

/// Area of an SVG picture.
pub type SvgArea<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Draws an SVG picture of a size in pixels on a white ground.
///
/// # Errors
/// [`DrawingError`] of the plotting library.
pub fn svg_picture(
    size_px: (u32, u32),
    draw: impl FnOnce(&SvgArea<'_>) -> Result<(), DrawingError>,
) -> Result<String, DrawingError> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, size_px).into_drawing_area();
        area.fill(&WHITE)?;
        draw(&area)?;
        area.present()?;
    }
    Ok(svg)
}

/// RGB colour, 8 bits per channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Color(pub u8, pub u8, pub u8);

impl Color {
    /// Colour blue.
    pub const BLUE: Self = Self(0, 0, 255);
    /// Colour red.
    pub const RED: Self = Self(255, 0, 0);
    /// Colour light grey, for reference curves.
    pub const GREY: Self = Self(190, 190, 190);

    /// Qualitative palette of 99 distinguishable colours; `index` wraps around.
    pub fn of_series(index: usize) -> Self {
        let (red, green, blue) = Palette99::COLORS[index % Palette99::COLORS.len()];
        Self(red, green, blue)
    }
}

impl From<Color> for RGBColor {
    fn from(Color(red, green, blue): Color) -> Self {
        Self(red, green, blue)
    }
}

/// Position of a diagram's legend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Legend {
    /// Legend inside the diagram, upper left.
    UpperLeft,
    /// Legend inside the diagram, upper right.
    UpperRight,
    /// Legend inside the diagram, lower left.
    LowerLeft,
    /// Legend outside, right of the diagram: for curves that fill the whole plot area.
    Outside,
}

impl Legend {
    /// Position inside the plot area; `None` for a legend outside.
    fn position(self) -> Option<SeriesLabelPosition> {
        match self {
            Self::UpperLeft => Some(SeriesLabelPosition::UpperLeft),
            Self::UpperRight => Some(SeriesLabelPosition::UpperRight),
            Self::LowerLeft => Some(SeriesLabelPosition::LowerLeft),
            Self::Outside => None,
        }
    }
}

/// Width and height of a diagram, and width of a legend outside it, pixels.
const SIZE_PX: (u32, u32) = (520, 420);
const LEGEND_PX: u32 = 150;
/// Line height of a legend outside the diagram and its top margin, pixels.
const LEGEND_LINE_PX: i32 = 18;
const LEGEND_TOP_PX: i32 = 44;

/// Axis of a diagram: label, range, scale.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis<'a> {
    /// Axis label: quantity and unit.
    pub label: &'a str,
    /// Range of the axis; positive when the axis is logarithmic.
    pub range: Range<f64>,
    /// `true` if the axis has a logarithmic scale.
    pub is_logarithmic: bool,
}

impl<'a> Axis<'a> {
    /// Axis with a linear scale.
    pub fn linear(label: &'a str, range: Range<f64>) -> Self {
        Self {
            label,
            range,
            is_logarithmic: false,
        }
    }

    /// Axis with a logarithmic scale; the range must be positive.
    pub fn logarithmic(label: &'a str, range: Range<f64>) -> Self {
        Self {
            label,
            range,
            is_logarithmic: true,
        }
    }

    fn tick_label(&self, value: f64) -> String {
        if self.is_logarithmic {
            // Only 1, 2, 5 and 10 of a decade are labelled; ten labels would overlap.
            let digit = (value / 10_f64.powf(value.log10().floor() + 1e-9)).round();
            if ![1.0, 2.0, 5.0, 10.0].contains(&digit) {
                return String::new();
            }
            let n_decimals = (-value.log10()).ceil().clamp(0.0, 9.0) as usize;
            format!("{value:.n_decimals$}")
        } else {
            tick_label(value, &self.range)
        }
    }
}

/// Curve of a diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve<'a> {
    /// Name of the curve in the legend; empty to leave the curve out of it.
    pub name: &'a str,
    /// Line colour of the curve.
    pub color: Color,
    /// Points in drawing order, joined by lines; positive where an axis is logarithmic.
    pub points: Vec<(f64, f64)>,
    /// `true` to draw a marker at each point, as for measurements.
    pub is_marked: bool,
}

impl<'a> Curve<'a> {
    /// Line through the points.
    pub fn line(name: &'a str, color: Color, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self {
            name,
            color,
            points: points.into_iter().collect(),
            is_marked: false,
        }
    }

    /// Line with a marker at each point.
    pub fn marked(
        name: &'a str,
        color: Color,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        Self {
            is_marked: true,
            ..Self::line(name, color, points)
        }
    }
}

/// Line chart: title, axes, curves, legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagram<'a> {
    /// Caption of the diagram.
    pub title: &'a str,
    /// Horizontal axis of the diagram.
    pub x: Axis<'a>,
    /// Vertical axis of the diagram.
    pub y: Axis<'a>,
    /// Curves; later ones are drawn on top.
    pub curves: Vec<Curve<'a>>,
    /// Position of the legend.
    pub legend: Legend,
}

/// Diagrams in one row, as SVG text.
///
/// # Errors
/// If the plotting library fails.
pub fn side_by_side(diagrams: &[Diagram<'_>]) -> Result<String, DrawingError> {
    in_columns(diagrams, diagrams.len())
}

/// Diagrams in a grid, filled row by row, as SVG text.
///
/// # Errors
/// If the plotting library fails.
pub fn in_columns(diagrams: &[Diagram<'_>], n_columns: usize) -> Result<String, DrawingError> {
    let n_columns = n_columns.max(1);
    let n_rows = diagrams.len().div_ceil(n_columns).max(1);
    let size_px = (SIZE_PX.0 * n_columns as u32, SIZE_PX.1 * n_rows as u32);
    svg_picture(size_px, |whole| {
        let areas = whole.split_evenly((n_rows, n_columns));
        let mut drawn = areas.iter().zip(diagrams);
        drawn.try_for_each(|(area, diagram)| draw(area, diagram))
    })
}

/// Draws a diagram with its legend into a drawing area.
///
/// # Errors
/// If the area is too small.
pub fn draw(area: &SvgArea<'_>, diagram: &Diagram<'_>) -> Result<(), DrawingError> {
    if diagram.legend.position().is_some() {
        return draw_with_scales(area, diagram);
    }
    let width_px = area.dim_in_pixel().0.saturating_sub(LEGEND_PX);
    let (own, outside) = area.split_horizontally(width_px);
    draw_with_scales(&own, diagram)?;
    draw_outside_legend(&outside, &diagram.curves)
}

/// Draws a legend outside the diagram: one line per named curve.
fn draw_outside_legend(area: &SvgArea<'_>, curves: &[Curve<'_>]) -> Result<(), DrawingError> {
    let named = curves.iter().filter(|curve| !curve.name.is_empty());
    for (curve, y) in named.zip((LEGEND_TOP_PX..).step_by(LEGEND_LINE_PX as usize)) {
        let line = [(0, y), (18, y)];
        let color = RGBColor::from(curve.color).stroke_width(2);
        area.draw(&PathElement::new(line, color))?;
        let place = (24, y - LEGEND_LINE_PX / 2 + 3);
        let name = Text::new(curve.name.to_owned(), place, ("sans-serif", 12));
        area.draw(&name)?;
    }
    Ok(())
}

fn draw_with_scales(area: &SvgArea<'_>, diagram: &Diagram<'_>) -> Result<(), DrawingError> {
    let (x, y) = (diagram.x.range.clone(), diagram.y.range.clone());
    match (diagram.x.is_logarithmic, diagram.y.is_logarithmic) {
        (false, false) => draw_chart(area, diagram, x, y),
        (false, true) => draw_chart(area, diagram, x, y.log_scale()),
        (true, false) => draw_chart(area, diagram, x.log_scale(), y),
        (true, true) => draw_chart(area, diagram, x.log_scale(), y.log_scale()),
    }
}

fn draw_chart<X, Y>(
    area: &SvgArea<'_>,
    diagram: &Diagram<'_>,
    x: X,
    y: Y,
) -> Result<(), DrawingError>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let mut chart = ChartBuilder::on(area)
        .caption(diagram.title, ("sans-serif", 17))
        .margin(12)
        // Space for half of the last axis label.
        .margin_right(26)
        .x_label_area_size(40)
        .y_label_area_size(52)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .x_desc(diagram.x.label)
        .y_desc(diagram.y.label)
        .x_label_formatter(&|value| diagram.x.tick_label(*value))
        .y_label_formatter(&|value| diagram.y.tick_label(*value))
        .light_line_style(WHITE)
        .draw()?;
    for curve in &diagram.curves {
        let color = RGBColor::from(curve.color);
        let mut series = LineSeries::new(curve.points.iter().copied(), color.stroke_width(2));
        if curve.is_marked {
            series = series.point_size(3);
        }
        let series = chart.draw_series(series)?;
        if !curve.name.is_empty() {
            series.label(curve.name).legend(move |(x, y)| {
                PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2))
            });
        }
    }
    let has_names = diagram.curves.iter().any(|curve| !curve.name.is_empty());
    let Some(position) = diagram.legend.position().filter(|_| has_names) else {
        return Ok(());
    };
    chart
        .configure_series_labels()
        .position(position)
        .background_style(WHITE)
        .draw()?;
    Ok(())
}

/// Axis label of a number, with as many decimals as the length of the axis requires.
pub fn tick_label(value: f64, range: &Range<f64>) -> String {
    let length = (range.end - range.start).abs().max(f64::MIN_POSITIVE);
    let n_decimals = (2.0 - length.log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.n_decimals$}");
    if n_decimals == 0 {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn diagram(x: Axis<'static>, y: Axis<'static>) -> Diagram<'static> {
        Diagram {
            title: "times & counts",
            x,
            y,
            curves: vec![Curve {
                name: "timer",
                color: Color::of_series(100),
                points: vec![(0.1, 1.0), (10.0, 1000.0), (100.0, 1.0)],
                is_marked: false,
            }],
            legend: Legend::UpperRight,
        }
    }

    #[test]
    fn every_combination_of_scales_is_drawn() {
        let axes = |range: Range<f64>| {
            [
                Axis::linear("a", range.clone()),
                Axis::logarithmic("a", range),
            ]
        };
        for x in axes(0.1..100.0) {
            for y in axes(0.5..2000.0) {
                let svg = side_by_side(&[diagram(x.clone(), y)]).unwrap();
                assert!(svg.contains("times &amp; counts") && svg.contains("timer"));
            }
        }
    }

    #[test]
    fn logarithmic_tick_labels_have_the_decimals_they_need() {
        let axis = Axis::logarithmic("", 0.01..1e4);
        let numbers = [0.01, 0.1, 1.0, 10.0, 10_000.0].map(|value| axis.tick_label(value));
        assert_eq!(numbers, ["0.01", "0.1", "1", "10", "10000"]);
        let within = [20.0, 30.0, 50.0, 0.07, 0.2].map(|value| axis.tick_label(value));
        assert_eq!(within, ["20", "", "50", "", "0.2"]);
    }

    #[test]
    fn tick_labels_have_no_superfluous_decimals() {
        let numbers = |range: Range<f64>| [0.0, 0.5, 20.0].map(|value| tick_label(value, &range));
        assert_eq!(numbers(0.0..8.0), ["0", "0.5", "20"]);
        assert_eq!(numbers(0.0..300.0), ["0", "0", "20"]);
        assert_eq!(tick_label(0.025, &(0.0..0.1)), "0.025");
    }

    #[test]
    fn outside_legend_lists_every_curve() {
        let mut one = diagram(Axis::linear("", 0.0..1.0), Axis::linear("", 0.0..1.0));
        one.legend = Legend::Outside;
        one.curves.push(one.curves[0].clone());
        one.curves[1].name = "wake-up";
        let svg = side_by_side(&[one]).unwrap();
        assert!(svg.contains("timer") && svg.contains("wake-up"));
    }

    #[test]
    fn grid_has_as_many_rows_as_needed() {
        let one = diagram(Axis::linear("", 0.0..1.0), Axis::linear("", 0.0..1.0));
        let svg = in_columns(&vec![one; 3], 2).unwrap();
        assert!(svg.contains("width=\"1040\" height=\"840\""), "{svg}");
        assert!(in_columns(&[], 0).is_ok());
    }
}
