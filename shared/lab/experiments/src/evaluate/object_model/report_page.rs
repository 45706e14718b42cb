//! Table and figures of object models.

use super::orbit::Path;
use super::report::{LevelReport, ModelReport};
use crate::evaluate::tabular_report::{
    ReportTable, TabularReport, figure as page_figure, number, percent,
};
use plot::diagram::{Axis, Color, Curve, Diagram, DrawingError, Legend, in_columns};

/// File names of the figure and of the picture of the models.
pub(super) const FIGURE: &str = "noise.svg";
pub(super) const MODELS: &str = "models.png";

/// Table, notes and figures of the report.
pub(super) fn page(document: &ModelReport) -> TabularReport<'static> {
    let models = "Models: the true object, then on each path the model of the least and of the \
                  greatest noise";
    TabularReport {
        title: "Object models",
        tables: vec![levels(document)],
        notes: notes(document),
        figures: vec![
            page_figure(
                FIGURE,
                "Model and pose errors by the noise of the camera poses",
            ),
            page_figure(MODELS, models),
        ],
        ..TabularReport::default()
    }
}

fn levels(document: &ModelReport) -> ReportTable {
    ReportTable::of(
        "Noise levels",
        &document.levels,
        &[
            ("path", &|level| level.path.word().to_owned()),
            ("noise", &|level| {
                format!(
                    "{} mm, {}°",
                    level.sigma_translation_mm, level.sigma_rotation_deg
                )
            }),
            ("accuracy mm", &|level| number(level.accuracy_mm, 2)),
            ("95 % mm", &|level| number(level.accuracy_p95_mm, 1)),
            ("complete %", &|level| percent(level.completeness)),
            ("chamfer mm", &|level| number(level.chamfer_mm, 2)),
            ("pose before mm", &|level| {
                number(level.pose_error_before, 1)
            }),
            ("filtered mm", &|level| number(level.pose_error_filtered, 1)),
            ("after mm", &|level| number(level.pose_error_after, 1)),
            ("refused %", &|level| percent(level.refused_share)),
        ],
    )
}

/// Notes below the table, one sentence each.
fn notes(document: &ModelReport) -> Vec<String> {
    let median = |value: fn(&LevelReport) -> f64| {
        super::scored_model::median(document.levels.iter().map(value).collect())
    };
    let mut notes = vec![
        format!(
            "{} objects, {}; seed {}; medians over the objects",
            document.n_objects,
            match document.n_views {
                Some(n_views) => format!("{n_views} views along each path"),
                None => "views of a recorded sequence".to_owned(),
            },
            document.seed
        ),
        "noise: standard deviation along and about each axis of the camera, independent in every \
         view; pose errors: displacement of the object's surface"
            .to_owned(),
        format!(
            "a view takes {:.0} ms, 95 % take less than {:.0} ms; the agreement of all views takes \
             {:.0} ms",
            median(|level| level.view_ms),
            median(|level| level.view_p95_ms),
            median(|level| level.finish_ms)
        ),
    ];
    notes.extend(document.recognition.as_ref().map(|gain| {
        format!(
            "recognition of {} views of sides that were never taught: {:.1} % after three views of \
             one side of each object, {:.1} % with the views of the models",
            gain.n_questions,
            100.0 * gain.accuracy_before,
            100.0 * gain.accuracy_after
        )
    }));
    notes
}

/// Quantity of a diagram: name, unit, value.
type Quantity = (&'static str, &'static str, fn(&LevelReport) -> f64);

/// Quantities of the diagrams.
const QUANTITIES: [Quantity; 3] = [
    ("accuracy", "mm", |level| level.accuracy_mm),
    ("completeness", "%", |level| 100.0 * level.completeness),
    ("pose error after", "mm", |level| level.pose_error_after),
];

/// Diagrams of the errors over the noise of the translation, a curve for each noise of the
/// rotation, a row for each path.
pub(super) fn figure(document: &ModelReport) -> Result<String, DrawingError> {
    let mut paths: Vec<Path> = document.levels.iter().map(|level| level.path).collect();
    paths.dedup();
    let mut degrees: Vec<f64> = document
        .levels
        .iter()
        .map(|l| l.sigma_rotation_deg)
        .collect();
    degrees.sort_unstable_by(f64::total_cmp);
    degrees.dedup();
    let names: Vec<String> = degrees.iter().map(|deg| format!("{deg}°")).collect();
    let rows = paths
        .iter()
        .flat_map(|path| QUANTITIES.iter().map(move |q| (path, q)));
    let titles: Vec<String> = rows
        .clone()
        .map(|(path, (quantity, ..))| format!("{quantity}, {}", path.word()))
        .collect();
    let diagrams: Vec<Diagram<'_>> = rows
        .zip(&titles)
        .map(|((path, quantity), title)| {
            let levels = document.levels.iter().filter(|level| level.path == *path);
            diagram(
                title,
                quantity,
                &levels.collect::<Vec<_>>(),
                (&names, &degrees),
            )
        })
        .collect();
    in_columns(&diagrams, QUANTITIES.len())
}

fn diagram<'a>(
    title: &'a str,
    (_, unit, value): &Quantity,
    levels: &[&LevelReport],
    (names, degrees): (&'a [String], &[f64]),
) -> Diagram<'a> {
    let curve = |(index, (name, deg)): (usize, (&'a String, &f64))| {
        Curve::marked(
            name,
            Color::of_series(index),
            levels
                .iter()
                .filter(|level| level.sigma_rotation_deg == *deg)
                .map(|level| (level.sigma_translation_mm, value(level))),
        )
    };
    let curves: Vec<Curve<'a>> = names.iter().zip(degrees).enumerate().map(curve).collect();
    let values = curves
        .iter()
        .flat_map(|curve| curve.points.iter().map(|point| point.1));
    let top = values.filter(|value| value.is_finite()).fold(1.0, f64::max);
    Diagram {
        title,
        x: Axis::linear("noise of the translation, mm", 0.0..32.0),
        y: Axis::linear(unit, 0.0..1.05 * top),
        curves,
        legend: if *unit == "%" {
            Legend::LowerLeft
        } else {
            Legend::UpperLeft
        },
    }
}
