//! Figures of the next best view: entropy against F1, prediction against truth, and the closed
//! loops.

use super::closed_loop::N_VIEWS_MAX;
use super::loop_method::Method;
use super::method_report::found_within;
use super::report::NextBestViewReport;
use super::scene_result::SceneResult;
use plot::DrawingError;
use plot::diagram::{Axis, Color, Curve, Diagram, Legend, side_by_side};

/// Figure of entropy and F1 over the views.
pub(super) const ENTROPY: &str = "entropy-f1.svg";
/// Figure of predicted and true entropy.
pub(super) const PREDICTION: &str = "prediction.svg";
/// Figure of the closed loops.
pub(super) const LOOPS: &str = "closed-loop.svg";
/// Number of scenes whose views are drawn as points.
const N_SCENES_DRAWN: usize = 10;
/// Travel up to which the closed loops are drawn, and its steps, metres.
const TRAVEL_MAX_M: f64 = 12.0;
const TRAVEL_STEP_M: f64 = 0.25;

/// All figures: file name and SVG.
pub(super) fn all(
    report: &NextBestViewReport,
    scenes: &[SceneResult],
) -> [(&'static str, Result<String, DrawingError>); 3] {
    [
        (ENTROPY, entropy_and_f1(scenes)),
        (PREDICTION, prediction(scenes)),
        (LOOPS, closed_loops(report, scenes)),
    ]
}

/// Points in one colour: each is a curve of its own, so that no lines join them.
fn points(points: impl Iterator<Item = (f64, f64)>, scene: usize) -> Vec<Curve<'static>> {
    let point = |point| Curve::marked("", Color::of_series(scene), [point]);
    points.map(point).collect()
}

fn entropy_and_f1(scenes: &[SceneResult]) -> Result<String, DrawingError> {
    let shown = || scenes.iter().take(N_SCENES_DRAWN).enumerate();
    let of = |x: fn(&super::scene_result::ViewFigures) -> (f64, f64)| {
        shown()
            .flat_map(|(number, scene)| points(scene.views.iter().map(x), number))
            .collect()
    };
    let all = || scenes.iter().flat_map(|scene| &scene.views);
    let greatest = all().map(|view| view.entropy).fold(1.0, f64::max);
    side_by_side(&[
        Diagram {
            title: "Entropy of each view and F1 with recognition",
            x: Axis::linear("true entropy, bit", 0.0..greatest * 1.05),
            y: Axis::linear("F1", 0.0..1.0),
            curves: of(|view| (view.entropy, view.f1)),
            legend: Legend::UpperLeft,
        },
        Diagram {
            title: "Mean visibility of each view and F1 with recognition",
            x: Axis::linear("mean visible share of the objects", 0.0..1.0),
            y: Axis::linear("F1", 0.0..1.0),
            curves: of(|view| (view.visibility, view.f1)),
            legend: Legend::UpperLeft,
        },
        Diagram {
            title: "Elevation of each camera and entropy of its view",
            x: Axis::linear("elevation, degrees", 0.0..90.0),
            y: Axis::linear("true entropy, bit", 0.0..greatest * 1.05),
            curves: of(|view| (view.elevation_deg, view.entropy)),
            legend: Legend::UpperLeft,
        },
    ])
}

fn prediction(scenes: &[SceneResult]) -> Result<String, DrawingError> {
    let shown = scenes.iter().take(N_SCENES_DRAWN).enumerate();
    let mut curves: Vec<Curve<'_>> = shown
        .flat_map(|(number, scene)| points(scene.pairs.iter().copied(), number))
        .collect();
    let ends = scenes.iter().flat_map(|scene| &scene.pairs);
    let greatest = ends.map(|pair| pair.0.max(pair.1)).fold(1.0, f64::max) * 1.05;
    curves.push(Curve::line(
        "",
        Color::GREY,
        [(0.0, 0.0), (greatest, greatest)],
    ));
    side_by_side(&[Diagram {
        title: "Entropy from noisy hypotheses and true entropy",
        x: Axis::linear("predicted entropy, bit", 0.0..greatest),
        y: Axis::linear("true entropy, bit", 0.0..greatest),
        curves,
        legend: Legend::UpperLeft,
    }])
}

fn closed_loops(
    report: &NextBestViewReport,
    scenes: &[SceneResult],
) -> Result<String, DrawingError> {
    let curve = |(index, method): (usize, Method), points: Vec<(f64, f64)>| {
        Curve::line(method.word(), Color::of_series(index), points)
    };
    let by_views = Method::ALL.into_iter().enumerate().map(|(index, method)| {
        let found = report.methods.get(method.word());
        let shares = found
            .map(|found| found.found_by_views.as_slice())
            .unwrap_or_default();
        let points = shares.iter().enumerate();
        let points = points.map(|(n, share)| ((n + 1) as f64, *share)).collect();
        curve((index, method), points)
    });
    let n_steps = (TRAVEL_MAX_M / TRAVEL_STEP_M) as u32;
    let by_travel = Method::ALL.into_iter().enumerate().map(|(index, method)| {
        let courses = scenes.iter().flat_map(|scene| &scene.courses);
        let courses = courses.filter(|(of, _)| *of == method);
        let courses: Vec<_> = courses.flat_map(|(_, courses)| courses).collect();
        let share = |step: u32| {
            let travel_m = f64::from(step) * TRAVEL_STEP_M;
            let sum: f64 = courses
                .iter()
                .map(|course| found_within(course, travel_m))
                .sum();
            (travel_m, sum / courses.len().max(1) as f64)
        };
        curve((index, method), (0..=n_steps).map(share).collect())
    });
    side_by_side(&[
        Diagram {
            title: "Objects found by the number of views",
            x: Axis::linear("views", 1.0..N_VIEWS_MAX as f64),
            y: Axis::linear("share of the findable objects", 0.0..1.0),
            curves: by_views.collect(),
            legend: Legend::Outside,
        },
        Diagram {
            title: "Objects found by the way of the camera",
            x: Axis::linear("travel, metres", 0.0..TRAVEL_MAX_M),
            y: Axis::linear("share of the findable objects", 0.0..1.0),
            curves: by_travel.collect(),
            legend: Legend::Outside,
        },
    ])
}
