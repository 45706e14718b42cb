//! Box plots (Tukey 1977): quartiles and extremes of groups of values, and a reference for each
//! group, as SVG.

use crate::diagram::{Color, DrawingError, SvgArea, svg_picture, tick_label};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::{
    Cartesian2d, ChartBuilder, ChartContext, Color as _, LineSeries, PathElement, RGBColor,
    Rectangle, SVGBackend, SeriesLabelPosition, WHITE,
};
use std::ops::Range;

/// Width and height of a panel, pixels.
const PANEL_PX: (u32, u32) = (980, 340);
/// Half width of a box, groups.
const HALF_BOX: f64 = 0.32;
/// Half width of the end of a whisker, groups.
const HALF_END: f64 = 0.16;
/// Fill of the boxes.
const PALE_BLUE: RGBColor = RGBColor(190, 212, 250);
/// Share of the range of the values that is added to it on each side.
const MARGIN: f64 = 0.05;
/// Least length of the value axis.
const LENGTH_MIN: f64 = 1e-6;

type Chart<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Group of values with the value that they estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct BoxGroup {
    /// Reference of the group.
    pub reference: f64,
    /// Values of the group, in any order; none draws no box.
    pub values: Vec<f64>,
}

/// Panel of box plots: groups from left to right, numbered from 1.
#[derive(Debug, Clone, PartialEq)]
pub struct BoxPlot<'a> {
    /// Caption of the panel.
    pub title: &'a str,
    /// Label of the horizontal axis: what the groups are.
    pub x_label: &'a str,
    /// Label of the vertical axis: quantity and unit.
    pub y_label: &'a str,
    /// Name of the line through the references, and of the boxes.
    pub names: [&'a str; 2],
    /// Groups of the panel.
    pub groups: &'a [BoxGroup],
}

/// Least value, quartiles and greatest value of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
struct FiveNumbers([f64; 5]);

impl FiveNumbers {
    /// Summary by linear interpolation between the values; `None` without values.
    fn of(values: &[f64]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().checked_sub(1)?;
        let at = |share: f64| {
            let place = share * last as f64;
            let below = place.floor() as usize;
            let above = (below + 1).min(last);
            sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
        };
        Some(Self([0.0, 0.25, 0.5, 0.75, 1.0].map(at)))
    }
}

/// Panels of box plots, one above the other, as SVG text.
///
/// # Errors
/// If the plotting library fails.
pub fn stacked(plots: &[BoxPlot<'_>]) -> Result<String, DrawingError> {
    let n_panels = plots.len().max(1);
    let size_px = (PANEL_PX.0, PANEL_PX.1 * n_panels as u32);
    svg_picture(size_px, |whole| {
        let areas = whole.split_evenly((n_panels, 1));
        let mut drawn = areas.iter().zip(plots);
        drawn.try_for_each(|(area, plot)| draw(area, plot))
    })
}

fn draw(area: &SvgArea<'_>, plot: &BoxPlot<'_>) -> Result<(), DrawingError> {
    let y_range = range(plot.groups);
    let mut chart = ChartBuilder::on(area)
        .caption(plot.title, ("sans-serif", 17))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(52)
        .build_cartesian_2d(0.0..plot.groups.len() as f64 + 1.0, y_range.clone())?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .x_desc(plot.x_label)
        .y_desc(plot.y_label)
        .x_label_formatter(&|value| format!("{value:.0}"))
        .y_label_formatter(&|value| tick_label(*value, &y_range))
        .light_line_style(WHITE)
        .draw()?;
    draw_boxes(&mut chart, plot)?;
    let red = RGBColor::from(Color::RED);
    let references = plot.groups.iter().zip(1_u32..);
    let line = references.map(|(group, number)| (f64::from(number), group.reference));
    chart
        .draw_series(LineSeries::new(line, red.stroke_width(2)))?
        .label(plot.names[0])
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], red.stroke_width(2)));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .background_style(WHITE)
        .draw()?;
    Ok(())
}

fn draw_boxes(chart: &mut Chart<'_>, plot: &BoxPlot<'_>) -> Result<(), DrawingError> {
    let blue = RGBColor::from(Color::BLUE);
    let (mut boxes, mut lines) = (Vec::new(), Vec::new());
    for (group, number) in plot.groups.iter().zip(1_u32..) {
        let Some(FiveNumbers([least, low, median, high, greatest])) =
            FiveNumbers::of(&group.values)
        else {
            continue;
        };
        let x = f64::from(number);
        let corners = [(x - HALF_BOX, low), (x + HALF_BOX, high)];
        boxes.push(Rectangle::new(corners, PALE_BLUE.filled()));
        boxes.push(Rectangle::new(corners, blue.stroke_width(1)));
        let mut line = |from, to| lines.push(PathElement::new([from, to], blue.stroke_width(1)));
        line((x - HALF_BOX, median), (x + HALF_BOX, median));
        for (inner, outer) in [(low, least), (high, greatest)] {
            line((x, inner), (x, outer));
            line((x - HALF_END, outer), (x + HALF_END, outer));
        }
    }
    chart
        .draw_series(boxes)?
        .label(plot.names[1])
        .legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 18, y + 5)], blue.stroke_width(1)));
    chart.draw_series(lines)?;
    Ok(())
}

/// Range of all references and values with a margin.
fn range(groups: &[BoxGroup]) -> Range<f64> {
    let all = || {
        let values = groups.iter().flat_map(|group| group.values.iter().copied());
        values.chain(groups.iter().map(|group| group.reference))
    };
    let (low, high) = (all().reduce(f64::min), all().reduce(f64::max));
    let (low, high) = (low.unwrap_or(0.0), high.unwrap_or(1.0));
    let margin = (MARGIN * (high - low)).max(LENGTH_MIN);
    low - margin..high + margin
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_numbers_are_the_extremes_and_quartiles_of_any_order() {
        let of = |values: &[f64]| FiveNumbers::of(values).unwrap().0;
        assert_eq!(of(&[5.0, 1.0, 4.0, 2.0, 3.0]), [1.0, 2.0, 3.0, 4.0, 5.0]);
        // Between two values a quartile is interpolated.
        assert_eq!(of(&[4.0, 0.0]), [0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(of(&[7.0]), [7.0; 5]);
        assert_eq!(FiveNumbers::of(&[]), None);
    }

    #[test]
    fn panel_has_a_box_for_each_group_with_values() {
        let group = |values: &[f64]| BoxGroup {
            reference: 1.5,
            values: values.to_vec(),
        };
        let groups = [group(&[1.0, 2.0, 3.0]), group(&[]), group(&[2.0])];
        let plot = BoxPlot {
            title: "cups & boxes",
            x_label: "view",
            y_label: "entropy, bit",
            names: ["truth", "prediction"],
            groups: &groups,
        };
        let svg = stacked(&[plot.clone(), plot]).unwrap();
        for part in ["cups &amp; boxes", "entropy, bit", "truth", "prediction"] {
            assert_eq!(svg.matches(part).count(), 2, "{part}");
        }
        // Two groups of each panel have values.
        assert_eq!(svg.matches("#BED4FA").count(), 4);
        assert!(stacked(&[]).is_ok());
    }

    #[test]
    fn range_holds_values_and_references_and_is_never_empty() {
        let group = |reference, value| BoxGroup {
            reference,
            values: vec![value],
        };
        let wide = range(&[group(0.5, 3.0), group(4.0, 1.0)]);
        assert!(wide.start < 0.5 && wide.end > 4.0);
        let flat = range(&[group(1.0, 1.0)]);
        assert!(flat.start < 1.0 && 1.0 < flat.end);
    }
}
