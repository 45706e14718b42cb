//! Track figure as SVG: trajectories from above, and a timeline of track-ids.

mod run_figure;

pub use run_figure::{figure_with_ground_truth, figure_without_ground_truth};

use plot::diagram::{DrawingError, SvgArea, svg_picture};
use plotters::prelude::{
    ChartBuilder, Circle, Color, IntoFont, Palette, Palette99, PathElement, RGBColor, Text, WHITE,
};
use std::ops::Range;

/// Size of the top view, pixels.
const VIEW_PX: (u32, u32) = (640, 460);
/// Width of the timeline, pixels.
const TIMELINE_PX: u32 = 660;
/// Margins, labels and caption of the top view, pixels.
const FRAME_PX: (u32, u32) = (76, 90);
/// Share of the timeline's length reserved for names.
const NAMES_SHARE: f64 = 0.24;
/// Maximum number of timeline rows drawn.
const DRAWN_ROWS_MAX: usize = 120;
/// Height of a row of the timeline, pixels.
const ROW_PX: u32 = 19;

/// Source of a trajectory or timeline span: ground truth or a track.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrackSource {
    /// Ground-truth object that counts in the score.
    Truth,
    /// Ground-truth object in frames that are not scored.
    UnscoredTruth,
    /// Estimated track, by its track-id.
    Track(u64),
}

/// Trajectory of one source over the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Source of the trajectory: ground truth or track.
    pub source: TrackSource,
    /// Trajectory points: world x and y, metres.
    pub points: Vec<(f64, f64)>,
}

/// Time span in a row of the timeline.
#[derive(Debug, Clone, PartialEq)]
pub struct TimelineSpan {
    /// Source that was seen during the span.
    pub source: TrackSource,
    /// Begin and end of the span, seconds.
    pub time_s: Range<f64>,
}

/// Row of the timeline.
#[derive(Debug, Clone, PartialEq)]
pub struct TimelineRow {
    /// Name of the timeline row.
    pub name: String,
    /// Spans of the timeline row in drawing order.
    pub spans: Vec<TimelineSpan>,
}

/// Trajectories and timeline of one run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TrackFigure {
    /// Caption of the track figure.
    pub title: String,
    /// Trajectories in drawing order.
    pub trajectories: Vec<Trajectory>,
    /// Rows of the timeline, top to bottom.
    pub rows: Vec<TimelineRow>,
    /// Length of the timeline, seconds.
    pub duration_s: f64,
}

impl TrackSource {
    fn color(self) -> RGBColor {
        match self {
            Self::Truth => RGBColor(150, 150, 150),
            Self::UnscoredTruth => RGBColor(218, 218, 218),
            Self::Track(id) => {
                let (r, g, b) = Palette99::COLORS[id as usize % Palette99::COLORS.len()];
                RGBColor(r, g, b)
            }
        }
    }

    fn width_px(self) -> u32 {
        match self {
            Self::Truth | Self::UnscoredTruth => 4,
            Self::Track(_) => 2,
        }
    }
}

impl TrackFigure {
    /// Figure as SVG text.
    ///
    /// # Errors
    /// If the plotting library fails.
    pub fn svg(&self) -> Result<String, DrawingError> {
        let n_rows = self.rows.len().min(DRAWN_ROWS_MAX);
        let height_px = VIEW_PX.1.max(n_rows as u32 * ROW_PX + FRAME_PX.1);
        svg_picture((VIEW_PX.0 + TIMELINE_PX, height_px), |whole| {
            let (left, right) = whole.split_horizontally(VIEW_PX.0);
            let view_px = height_px.min(VIEW_PX.0);
            let (left, _) = left.split_vertically(view_px);
            self.draw_view(&left, view_px)?;
            self.draw_timeline(&right)
        })
    }

    fn draw_view(&self, area: &SvgArea<'_>, height_px: u32) -> Result<(), DrawingError> {
        let (x_range, y_range) = self.ranges(height_px);
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("sans-serif", 17))
            .margin(12)
            .x_label_area_size(36)
            .y_label_area_size(52)
            .build_cartesian_2d(x_range, y_range)?;
        chart
            .configure_mesh()
            .x_desc("x, m")
            .y_desc("y, m")
            .light_line_style(WHITE)
            .draw()?;
        for trajectory in &self.trajectories {
            let style = trajectory
                .source
                .color()
                .stroke_width(trajectory.source.width_px());
            let path = PathElement::new(trajectory.points.clone(), style);
            chart.draw_series([path])?;
            let (TrackSource::Track(id), Some(begin)) =
                (trajectory.source, trajectory.points.first())
            else {
                continue;
            };
            let dot = Circle::new(*begin, 3, trajectory.source.color().filled());
            chart.draw_series([dot])?;
            let font = ("sans-serif", 13)
                .into_font()
                .color(&trajectory.source.color());
            chart.draw_series([Text::new(id.to_string(), *begin, font)])?;
        }
        Ok(())
    }

    /// Axis ranges around all trajectories with equal scales.
    fn ranges(&self, height_px: u32) -> (Range<f64>, Range<f64>) {
        let points = || {
            self.trajectories
                .iter()
                .flat_map(|trajectory| &trajectory.points)
        };
        let range = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            })
        };
        let (mut x, mut y) = (
            range(&mut points().map(|point| point.0)),
            range(&mut points().map(|point| point.1)),
        );
        if points().next().is_none() {
            (x, y) = ((-0.5, 0.5), (-0.5, 0.5));
        }
        let sides_px = [VIEW_PX.0 - FRAME_PX.0, height_px - FRAME_PX.1].map(f64::from);
        let width_m = |(low, high): (f64, f64)| high - low + 0.1;
        let metres_per_px = (width_m(x) / sides_px[0]).max(width_m(y) / sides_px[1]);
        let around = |(low, high): (f64, f64), side_px: f64| {
            let (middle, half) = (f64::midpoint(low, high), 0.5 * side_px * metres_per_px);
            middle - half..middle + half
        };
        (around(x, sides_px[0]), around(y, sides_px[1]))
    }

    fn draw_timeline(&self, area: &SvgArea<'_>) -> Result<(), DrawingError> {
        let rows = &self.rows[..self.rows.len().min(DRAWN_ROWS_MAX)];
        let duration_s = self.duration_s.max(0.1);
        let names_s = -NAMES_SHARE * duration_s;
        let mut chart = ChartBuilder::on(area)
            .caption(self.timeline_title(), ("sans-serif", 17))
            .margin(12)
            .x_label_area_size(36)
            .build_cartesian_2d(names_s..duration_s, 0.0..rows.len().max(1) as f64)?;
        chart
            .configure_mesh()
            .disable_y_mesh()
            .x_desc("time, s")
            .light_line_style(WHITE)
            .x_label_formatter(&|time_s| {
                if *time_s < 0.0 {
                    String::new()
                } else {
                    format!("{time_s}")
                }
            })
            .draw()?;
        for (index, row) in rows.iter().enumerate() {
            let y = rows.len() as f64 - index as f64 - 0.5;
            let font = ("sans-serif", 13).into_font();
            let name = Text::new(row.name.clone(), (names_s, y + 0.3), font);
            chart.draw_series([name])?;
            let mut labelled = None;
            for span in &row.spans {
                let width_px = 3 * span.source.width_px();
                let ends = vec![(span.time_s.start, y), (span.time_s.end, y)];
                let line = PathElement::new(ends, span.source.color().stroke_width(width_px));
                chart.draw_series([line])?;
                if let TrackSource::Track(id) = span.source
                    && labelled != Some(id)
                {
                    labelled = Some(id);
                    let font = ("sans-serif", 12).into_font();
                    let label = Text::new(id.to_string(), (span.time_s.start, y + 0.5), font);
                    chart.draw_series([label])?;
                }
            }
        }
        Ok(())
    }

    fn timeline_title(&self) -> String {
        let n_hidden = self.rows.len().saturating_sub(DRAWN_ROWS_MAX);
        if n_hidden == 0 {
            "track-ids over time".to_owned()
        } else {
            format!("track-ids over time ({n_hidden} more rows are not drawn)")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figure_shows_ids_and_names() {
        let trajectory = Trajectory {
            source: TrackSource::Track(17),
            points: vec![(0.1, 0.2), (0.3, 0.2)],
        };
        let row = TimelineRow {
            name: "mug <3>".into(),
            spans: vec![TimelineSpan {
                source: TrackSource::Track(17),
                time_s: 0.0..2.0,
            }],
        };
        let figure = TrackFigure {
            title: "crossing".into(),
            trajectories: vec![trajectory],
            rows: vec![row],
            duration_s: 2.0,
        };
        let svg = figure.svg().unwrap();
        for part in ["crossing", "17", "mug &lt;3&gt;", "<svg"] {
            assert!(svg.contains(part), "{part}");
        }
    }

    #[test]
    fn empty_runs_and_many_rows_can_be_drawn() {
        assert!(TrackFigure::default().svg().is_ok());
        let row = TimelineRow {
            name: String::new(),
            spans: vec![],
        };
        let many = TrackFigure {
            rows: vec![row; DRAWN_ROWS_MAX + 5],
            ..TrackFigure::default()
        };
        assert!(many.svg().unwrap().contains("5 more rows"));
    }

    #[test]
    fn both_axes_have_the_same_scale() {
        let trajectory = Trajectory {
            source: TrackSource::Truth,
            points: vec![(-0.5, 0.0), (0.5, 0.1)],
        };
        let figure = TrackFigure {
            trajectories: vec![trajectory],
            ..TrackFigure::default()
        };
        let (x, y) = figure.ranges(VIEW_PX.1);
        let px = |range: &Range<f64>, side_px: u32| f64::from(side_px) / (range.end - range.start);
        let scales = [
            px(&x, VIEW_PX.0 - FRAME_PX.0),
            px(&y, VIEW_PX.1 - FRAME_PX.1),
        ];
        assert!((scales[0] / scales[1] - 1.0).abs() < 1e-9);
        assert!(x.start < -0.5 && x.end > 0.5);
    }
}
