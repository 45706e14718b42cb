//! Figures as SVG.

use plotters::coord::Shift;
use plotters::prelude::{
    ChartBuilder, Color, DrawingArea, IntoDrawingArea, LineSeries, PathElement, RGBColor,
    SVGBackend, SeriesLabelPosition, WHITE,
};
use std::fmt;
use std::ops::Range;

/// Why a figure could not be drawn.
#[derive(Debug)]
pub struct DrawingError(String);

impl fmt::Display for DrawingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the figure could not be drawn: {}", self.0)
    }
}

impl std::error::Error for DrawingError {}

pub(crate) fn failed(error: impl fmt::Display) -> DrawingError {
    DrawingError(error.to_string())
}

/// One curve.
pub(crate) struct Curve<'a> {
    /// What it is in the legend; empty when it is not there.
    pub(crate) name: &'a str,
    pub(crate) color: RGBColor,
    pub(crate) points: Vec<(f64, f64)>,
    /// Whether the points are marked, as measurements are.
    pub(crate) is_marked: bool,
}

/// One diagram.
pub(crate) struct Diagram<'a> {
    pub(crate) title: &'a str,
    pub(crate) x_label: &'a str,
    pub(crate) y_label: &'a str,
    pub(crate) x_range: Range<f64>,
    pub(crate) y_range: Range<f64>,
    pub(crate) curves: Vec<Curve<'a>>,
    /// Where the legend is out of the way.
    pub(crate) legend: SeriesLabelPosition,
}

/// Diagrams side by side, as SVG text.
pub(crate) fn side_by_side(diagrams: &[Diagram<'_>]) -> Result<String, DrawingError> {
    let mut svg = String::new();
    {
        let width = 520 * diagrams.len() as u32;
        let whole = SVGBackend::with_string(&mut svg, (width, 420)).into_drawing_area();
        whole.fill(&WHITE).map_err(failed)?;
        for (area, diagram) in whole.split_evenly((1, diagrams.len())).iter().zip(diagrams) {
            draw(area, diagram)?;
        }
        whole.present().map_err(failed)?;
    }
    Ok(svg)
}

pub(crate) fn draw(
    area: &DrawingArea<SVGBackend<'_>, Shift>,
    diagram: &Diagram<'_>,
) -> Result<(), DrawingError> {
    let mut chart = ChartBuilder::on(area)
        .caption(diagram.title, ("sans-serif", 17))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(52)
        .build_cartesian_2d(diagram.x_range.clone(), diagram.y_range.clone())
        .map_err(failed)?;
    chart
        .configure_mesh()
        .x_desc(diagram.x_label)
        .y_desc(diagram.y_label)
        .x_label_formatter(&|value| number(*value, &diagram.x_range))
        .y_label_formatter(&|value| number(*value, &diagram.y_range))
        .light_line_style(WHITE)
        .draw()
        .map_err(failed)?;
    for curve in &diagram.curves {
        let color = curve.color;
        let mut series = LineSeries::new(curve.points.iter().copied(), color.stroke_width(2));
        if curve.is_marked {
            series = series.point_size(3);
        }
        let series = chart.draw_series(series).map_err(failed)?;
        if !curve.name.is_empty() {
            series.label(curve.name).legend(move |(x, y)| {
                PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2))
            });
        }
    }
    if diagram.curves.iter().all(|curve| curve.name.is_empty()) {
        return Ok(());
    }
    chart
        .configure_series_labels()
        .position(diagram.legend.clone())
        .background_style(WHITE)
        .draw()
        .map_err(failed)
}

/// A number at an axis: without decimals when the axis is long.
pub(crate) fn number(value: f64, range: &Range<f64>) -> String {
    if range.end - range.start > 5.0 {
        format!("{value:.0}")
    } else {
        format!("{value:.1}")
    }
}
