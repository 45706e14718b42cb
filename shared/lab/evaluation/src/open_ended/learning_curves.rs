//! Learning curves of open-ended runs as SVG.

use super::mean_curve::MeanCurve;
use super::record::{OpenEndedRun, StageRecord};
use plot::diagram::{
    Axis, Color, Curve, Diagram, DrawingError, Legend, SvgArea, draw, side_by_side, svg_picture,
    tick_label,
};
use plotters::prelude::{
    BLUE, ChartBuilder, Color as _, FontTransform, IntoFont, RGBColor, Rectangle, Text, TextStyle,
    WHITE,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Width of the figure of a run, and height of each of its halves, pixels.
const RUN_PX: (u32, u32) = (1040, 420);
/// Height reserved for category names, pixels.
const NAMES_PX: u32 = 150;
/// Colour of the bounds of a band: a light blue.
const BAND: Color = Color(130, 170, 255);
/// Maximum number of categories for which names are drawn.
const NAMED_BARS_MAX: usize = 70;

/// Learning curves of all runs as SVG: accuracy over learned categories, and learned categories
/// over questions, with their mean and a band of one standard deviation.
///
/// # Errors
/// If the plotting library fails.
pub fn overview_svg(runs: &[OpenEndedRun]) -> Result<String, DrawingError> {
    let stages = || runs.iter().flat_map(|run| &run.stages);
    let most = |value: fn(&StageRecord) -> u32| f64::from(stages().map(value).max().unwrap_or(1));
    let (n_categories, n_questions) = (most(|s| s.n_categories), most(|s| s.n_questions));
    let accuracy = |stage: &StageRecord| stage.accuracy;
    let questions = |stage: &StageRecord| f64::from(stage.n_questions);
    // The mean number of questions is taken at each number of categories, which is drawn upwards.
    let turned = |(x, y): (f64, f64)| (y, x);
    side_by_side(&[
        Diagram {
            title: "Accuracy over all questions",
            x: Axis::linear("learned categories", 1.0..n_categories + 1.0),
            y: Axis::linear("global classification accuracy", 0.0..1.05),
            curves: run_curves(runs, accuracy, |point| point),
            legend: Legend::LowerLeft,
        },
        Diagram {
            title: "Learned categories",
            x: Axis::linear("questions", 0.0..1.05 * n_questions),
            y: Axis::linear("learned categories", 0.0..1.05 * n_categories + 1.0),
            curves: run_curves(runs, questions, turned),
            legend: Legend::UpperLeft,
        },
    ])
}

/// A light curve for each run, their mean, and the bounds of its band. `place` puts a pair of
/// learned categories and value into the diagram.
fn run_curves(
    runs: &[OpenEndedRun],
    value: impl Fn(&StageRecord) -> f64,
    place: impl Fn((f64, f64)) -> (f64, f64),
) -> Vec<Curve<'static>> {
    let curve = |name, color, points: &[(f64, f64)]| Curve {
        name,
        color,
        points: points.iter().copied().map(&place).collect(),
        is_marked: false,
    };
    let of_run = |(index, run): (usize, &OpenEndedRun)| {
        let pair = |stage: &StageRecord| (f64::from(stage.n_categories), value(stage));
        let points: Vec<(f64, f64)> = run.stages.iter().map(pair).collect();
        let name = if index == 0 { "each run" } else { "" };
        curve(name, Color::GREY, &points)
    };
    let mut curves: Vec<Curve<'static>> = runs.iter().enumerate().map(of_run).collect();
    let MeanCurve { mean, low, high } = MeanCurve::of(runs, &value);
    if !low.is_empty() {
        curves.push(curve("mean ± standard deviation", BAND, &low));
        curves.push(curve("", BAND, &high));
        curves.push(curve("mean", Color::BLUE, &mean));
    }
    curves
}

/// Figure of one run as SVG: protocol accuracy over questions with the threshold `tau` and a grey
/// line at each introduction, and below the number of taught views per category. `names` are
/// indexed by category number.
///
/// # Errors
/// If the plotting library fails.
pub fn run_svg(run: &OpenEndedRun, names: &[String], tau: f64) -> Result<String, DrawingError> {
    let (width_px, height_px) = RUN_PX;
    svg_picture((width_px, 2 * height_px), |whole| {
        let (upper, lower) = whole.split_vertically(height_px);
        draw(&upper, &accuracy_diagram(run, tau))?;
        draw_taught_views(&lower, run, names)
    })
}

fn accuracy_diagram(run: &OpenEndedRun, tau: f64) -> Diagram<'static> {
    let n_questions = f64::from(run.questions.last().map_or(1, |q| q.iteration));
    let comes = run.questions.windows(2);
    let comes = comes.filter(|pair| pair[0].n_categories < pair[1].n_categories);
    let marks = comes.map(|pair| {
        let iteration = f64::from(pair[1].iteration) - 0.5;
        Curve::line("", Color::GREY, [(iteration, 0.0), (iteration, 1.05)])
    });
    let mut curves: Vec<Curve<'_>> = marks.collect();
    curves.push(Curve::line(
        "threshold",
        Color::RED,
        [(0.0, tau), (n_questions, tau)],
    ));
    curves.extend(accuracy_curves(run));
    Diagram {
        title: "Protocol accuracy; a grey line where a category comes",
        x: Axis::linear("questions", 0.0..n_questions + 1.0),
        y: Axis::linear("protocol accuracy", 0.0..1.05),
        curves,
        legend: Legend::LowerLeft,
    }
}

/// Protocol accuracy, a separate curve for each stage.
fn accuracy_curves(run: &OpenEndedRun) -> Vec<Curve<'static>> {
    let stages = run
        .questions
        .chunk_by(|a, b| a.n_categories == b.n_categories);
    let curve = |(index, questions): (usize, &[super::record::Question])| {
        let points = questions
            .iter()
            .filter_map(|q| Some((f64::from(q.iteration), q.accuracy?)));
        let points: Vec<(f64, f64)> = points.collect();
        Curve {
            name: if index == 0 { "accuracy" } else { "" },
            color: Color::BLUE,
            // A single point needs a marker; a line needs two points.
            is_marked: points.len() == 1,
            points,
        }
    };
    stages.enumerate().map(curve).collect()
}

/// Bar chart of taught views per category, in the order of introduction.
fn draw_taught_views(
    area: &SvgArea<'_>,
    run: &OpenEndedRun,
    names: &[String],
) -> Result<(), DrawingError> {
    let most = run.taught.iter().map(|(_, n_views)| *n_views).max();
    let highest = 1.05 * f64::from(most.unwrap_or(1)) + 1.0;
    let n_bars = run.taught.len();
    let mut chart = ChartBuilder::on(area)
        .caption("Taught views of each category", ("sans-serif", 17))
        .margin(12)
        .margin_bottom(NAMES_PX)
        .y_label_area_size(52)
        .build_cartesian_2d(0.0..n_bars.max(1) as f64, 0.0..highest)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .y_desc("views")
        .y_label_formatter(&|value| tick_label(*value, &(0.0..highest)))
        .light_line_style(WHITE)
        .draw()?;
    let start = f64::from(run.n_views_at_start);
    for (index, &(category, n_views)) in run.taught.iter().enumerate() {
        let (left, right) = (index as f64 + 0.15, index as f64 + 0.85);
        let bar =
            |from, to, color: RGBColor| Rectangle::new([(left, from), (right, to)], color.filled());
        let bars = [
            bar(0.0, start, Color::GREY.into()),
            bar(start, n_views.into(), BLUE),
        ];
        chart.draw_series(bars)?;
        if n_bars <= NAMED_BARS_MAX {
            let (x_px, y_px) = chart.backend_coord(&(index as f64 + 0.5, 0.0));
            let name = names.get(category as usize).map_or("", String::as_str);
            draw_rotated(area, name, (x_px, y_px + 6))?;
        }
    }
    Ok(())
}

/// Draws text rotated by 90 degrees; the position is that of its beginning, in pixels of the
/// whole picture.
fn draw_rotated(
    area: &SvgArea<'_>,
    text: &str,
    (x_px, y_px): (i32, i32),
) -> Result<(), DrawingError> {
    let (left_px, top_px) = area.get_base_pixel();
    let font = ("sans-serif", 13).into_font();
    let font = font.transform(FontTransform::Rotate90);
    let style = TextStyle::from(font).pos(Pos::new(HPos::Left, VPos::Center));
    let place = (x_px - left_px, y_px - top_px);
    Ok(area.draw(&Text::new(text.to_owned(), place, style))?)
}

#[cfg(test)]
mod tests {
    use super::super::record::{Question, StopReason};
    use super::*;
    use crate::recogniser::Answer;

    fn question(iteration: u32, n_categories: u32) -> Question {
        Question {
            iteration,
            n_categories,
            view: 0,
            truth: 1,
            is_open_set: false,
            answer: Answer {
                category: Some(1),
                distance: 0.1,
                novelty: 0.1,
                probability: None,
                known_probability: None,
                best: [None; 3],
            },
            accuracy: Some(0.8),
        }
    }

    fn run() -> OpenEndedRun {
        let stage = |n_categories, n_questions| StageRecord {
            n_categories,
            n_questions,
            accuracy: 0.75,
        };
        OpenEndedRun {
            seed: 1,
            stop: StopReason::AllLearned,
            questions: vec![question(1, 2), question(2, 3), question(3, 3)],
            stages: vec![stage(2, 1), stage(3, 3)],
            stage_accuracies: vec![0.8, 0.8],
            taught: vec![(1, 3), (0, 5), (2, 4)],
            n_views_at_start: 3,
        }
    }

    #[test]
    fn figures_show_names_and_curves() {
        let names = ["cup & saucer", "mug", "bowl"].map(str::to_owned);
        let svg = run_svg(&run(), &names, 0.67).unwrap();
        for part in ["cup &amp; saucer", "mug", "bowl", "threshold", "accuracy"] {
            assert!(svg.contains(part), "{part} is not in {svg}");
        }
        let (one, two) = (overview_svg(&[run()]), overview_svg(&[run(), run()]));
        let n_bands = |svg: Result<String, DrawingError>| svg.unwrap().matches("mean ±").count();
        // A single run has no band; two have one in each of the two diagrams.
        assert_eq!((n_bands(one), n_bands(two)), (0, 2));
    }

    #[test]
    fn a_run_without_questions_is_drawn() {
        let empty = OpenEndedRun {
            questions: Vec::new(),
            stages: Vec::new(),
            taught: Vec::new(),
            ..run()
        };
        assert!(run_svg(&empty, &[], 0.67).is_ok());
        assert!(overview_svg(&[empty]).is_ok());
        assert!(overview_svg(&[]).is_ok());
    }
}
