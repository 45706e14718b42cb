//! Latency figures of a run as SVG: tail percentiles, and percentiles over time.

use crate::duration_percentiles::DurationPercentiles;
use crate::latency_recorder::LatencyRecorder;
use message::StageScope;
use plot::DrawingError;
use plot::diagram::{Axis, Color, Curve, Diagram, Legend, side_by_side};

/// Points of a percentile curve per decade.
const POINTS_PER_DECADE: usize = 24;

/// Minimum number of frames in a window: fewer have no 99th percentile.
const WINDOW_FRAMES_MIN: usize = 100;
/// Number of windows of a run in the figure of percentiles over time.
const N_WINDOWS: usize = 60;

/// Tail-latency plot: duration over "one in N takes longer" (N = 1/(1 - percentile),
/// logarithmic); end to end on the left, the stages of the critical path on the right.
///
/// # Errors
/// If the plotting library fails.
pub fn percentile_figure(recorder: &LatencyRecorder) -> Result<String, DrawingError> {
    let whole = recorder.end_to_end_ns(&recorder.missed());
    let labels: Vec<u64> = recorder.labels.iter().map(|label| label.ns).collect();
    let of_frame = vec![
        percentile_curve("label of an object", 1, labels),
        percentile_curve("end to end", 0, whole),
    ];
    let critical_path = recorder
        .stages_ns()
        .filter(|(stage, _)| stage.scope() == StageScope::Frame)
        .enumerate()
        .map(|(index, (stage, durations))| percentile_curve(stage.word(), index, durations));
    side_by_side(&[
        percentile_diagram(
            "From scheduled capture to label",
            of_frame,
            Legend::UpperLeft,
        ),
        percentile_diagram(
            "Stages of the critical path",
            critical_path.collect(),
            Legend::Outside,
        ),
    ])
}

fn percentile_curve(name: &str, index: usize, mut durations_ns: Vec<u64>) -> Curve<'_> {
    durations_ns.sort_unstable();
    let n = durations_ns.len();
    let n_steps = (n.max(1) as f64).log10() * POINTS_PER_DECADE as f64;
    let points = (0..=n_steps.floor() as usize).filter_map(|step| {
        let one_in = 10_f64.powf(step as f64 / POINTS_PER_DECADE as f64);
        let rank = ((1.0 - 1.0 / one_in) * n as f64).ceil() as usize;
        let duration_ns = durations_ns.get(rank.min(n.checked_sub(1)?))?;
        Some((one_in, (*duration_ns as f64 / 1e6).max(DRAWN_MS_MIN)))
    });
    Curve::line(name, Color::of_series(index), points)
}

/// Smallest duration drawn, milliseconds.
const DRAWN_MS_MIN: f64 = 0.001;

fn percentile_diagram<'a>(title: &'a str, curves: Vec<Curve<'a>>, legend: Legend) -> Diagram<'a> {
    let all = || curves.iter().flat_map(|curve| &curve.points);
    let rarest = all().map(|point| point.0).fold(10.0, f64::max);
    let least = all().map(|point| point.1).fold(f64::INFINITY, f64::min);
    let longest = all().map(|point| point.1).fold(DRAWN_MS_MIN, f64::max);
    Diagram {
        title,
        x: Axis::logarithmic("one in so many takes longer", 1.0..rarest),
        // Space for two legend entries above the curves.
        y: Axis::logarithmic("ms", 0.8 * least.min(longest)..longest * 1.5),
        curves,
        legend,
    }
}

/// End-to-end latency over time: median, 99th percentile and maximum of each window.
///
/// # Errors
/// If the plotting library fails.
pub fn time_figure(recorder: &LatencyRecorder) -> Result<String, DrawingError> {
    let n = recorder.end_to_end.len();
    let n_frames = n.div_ceil(N_WINDOWS).max(WINDOW_FRAMES_MIN);
    let begin_ns = recorder
        .frames
        .first()
        .map_or(0, |frame| frame.scheduled_ns);
    let mut curves: Vec<Curve<'_>> = ["longest", "99 of 100", "median"]
        .into_iter()
        .enumerate()
        .map(|(index, name)| Curve::line(name, Color::of_series(index), []))
        .collect();
    for (window, samples) in recorder.end_to_end.chunks(n_frames).enumerate() {
        let mut durations_ns: Vec<u64> = samples.iter().map(|sample| sample.ns).collect();
        let ms = DurationPercentiles::of(&mut durations_ns);
        let frame = &recorder.frames[window * n_frames];
        let at_s = frame.scheduled_ns.saturating_sub(begin_ns) as f64 / 1e9;
        for (curve, value) in curves.iter_mut().zip([ms.max, ms.p99, ms.p50]) {
            curve.points.push((at_s, value));
        }
    }
    let all = || curves.iter().flat_map(|curve| &curve.points);
    let last_s = all().map(|point| point.0).fold(1.0, f64::max);
    let longest = all().map(|point| point.1).fold(DRAWN_MS_MIN, f64::max);
    side_by_side(&[Diagram {
        title: "End to end over time",
        x: Axis::linear("s", 0.0..last_s),
        y: Axis::linear("ms", 0.0..longest * 1.35),
        curves,
        legend: Legend::UpperRight,
    }])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame_timeline::test_frames::frame;

    #[test]
    fn figures_show_every_stage() {
        let mut recorder = LatencyRecorder::new(0);
        for sequence in 0..500 {
            let longer_ns = (sequence % 97) * 100_000;
            recorder.add(frame(sequence, sequence * 33_000_000, longer_ns));
        }
        let picture = percentile_figure(&recorder).unwrap();
        for name in ["end to end", "detection_queue", "publishing"] {
            assert!(picture.contains(name), "{name}");
        }
        assert!(time_figure(&recorder).unwrap().contains("99 of 100"));
    }

    #[test]
    fn empty_and_tiny_measurements_can_be_drawn() {
        let mut recorder = LatencyRecorder::new(0);
        for _ in 0..2 {
            assert!(percentile_figure(&recorder).is_ok());
            assert!(time_figure(&recorder).is_ok());
            recorder.add(frame(0, 0, 0));
        }
    }
}
