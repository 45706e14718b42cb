//! Construction of a track figure from the frames of a run.

use super::{TimelineRow, TimelineSpan, TrackFigure, TrackSource, Trajectory};
use crate::clear_mot::Match;
use crate::tracked_frame::{TrackState, TrackedFrame};
use nalgebra::{Point3, UnitQuaternion, UnitVector3, Vector3};
use std::collections::BTreeMap;

/// Minimum distance between consecutive points of a trajectory, metres.
const POINT_SPACING_M: f64 = 0.002;
/// Longest pause bridged within a timeline span, seconds.
const BRIDGED_PAUSE_S: f64 = 0.1;

/// Track figure of a run with ground truth in a world with z up: true trajectories are grey,
/// tracks have a colour per id. The timeline has a row for each object with its matched tracks,
/// and a last row for tracks without an object.
pub fn figure_with_ground_truth(
    title: &str,
    frames: &[TrackedFrame],
    matches: &[Vec<Match>],
    names: &BTreeMap<u64, String>,
) -> TrackFigure {
    let mut truths = Trajectories::default();
    let mut timelines: BTreeMap<u64, TimelineRowBuilder> = BTreeMap::new();
    let mut nothing = TimelineRowBuilder::default();
    for (frame, of_frame) in frames.iter().zip(matches) {
        for object in &frame.objects {
            let source = if object.counts {
                TrackSource::Truth
            } else {
                TrackSource::UnscoredTruth
            };
            let centre = object.reference_box().centre();
            truths.add(object.id, TrackSource::Truth, &centre);
            let timeline = timelines.entry(object.id).or_default();
            timeline.truth.add(source, frame.time_s);
        }
        for (index, track) in outputs(frame) {
            let matched = of_frame.iter().find(|m| m.track == index);
            let timeline = match matched {
                Some(m) => timelines.entry(frame.objects[m.object].id).or_default(),
                None => &mut nothing,
            };
            timeline
                .tracks
                .add(TrackSource::Track(track.id), frame.time_s);
        }
    }
    let name = |id: &u64| {
        let name = names.get(id).map_or("", String::as_str);
        format!("{id} {name}")
    };
    let rows = timelines.iter();
    let mut rows: Vec<TimelineRow> = rows.map(|(id, times)| times.row(name(id))).collect();
    rows.push(nothing.row("no object".to_owned()));
    let mut trajectories = truths.finish();
    trajectories.extend(track_trajectories(frames, &Vector3::z_axis()));
    TrackFigure {
        title: title.to_owned(),
        trajectories,
        rows,
        duration_s: duration_s(frames),
    }
}

/// Track figure of a run without ground truth: a timeline row for each output track. The top view
/// is along `up_in_world`; if that is not z, the world is rotated by the shortest rotation.
pub fn figure_without_ground_truth(
    title: &str,
    frames: &[TrackedFrame],
    up_in_world: &UnitVector3<f64>,
) -> TrackFigure {
    let mut timelines: BTreeMap<u64, TimelineRowBuilder> = BTreeMap::new();
    for frame in frames {
        for (_, track) in outputs(frame) {
            let timeline = timelines.entry(track.id).or_default();
            timeline
                .tracks
                .add(TrackSource::Track(track.id), frame.time_s);
        }
    }
    let rows = timelines.iter();
    TrackFigure {
        title: title.to_owned(),
        trajectories: track_trajectories(frames, up_in_world),
        rows: rows
            .map(|(id, times)| times.row(format!("track {id}")))
            .collect(),
        duration_s: duration_s(frames),
    }
}

fn outputs(frame: &TrackedFrame) -> impl Iterator<Item = (usize, &TrackState)> {
    let tracks = frame.tracks.iter().enumerate();
    tracks.filter(|(_, track)| track.is_output)
}

fn track_trajectories(frames: &[TrackedFrame], up_in_world: &UnitVector3<f64>) -> Vec<Trajectory> {
    let turn = UnitQuaternion::rotation_between_axis(up_in_world, &Vector3::z_axis());
    // Any rotation axis does if up points straight down.
    let turn = turn.unwrap_or_else(|| {
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
    });
    let mut trajectories = Trajectories::default();
    for frame in frames {
        for (_, track) in outputs(frame) {
            let centre = turn * track.box_in_world.centre();
            trajectories.add(track.id, TrackSource::Track(track.id), &centre);
        }
    }
    trajectories.finish()
}

fn duration_s(frames: &[TrackedFrame]) -> f64 {
    frames.last().map_or(0.0, |frame| frame.time_s)
}

/// Trajectories by object or track number.
#[derive(Default)]
struct Trajectories(BTreeMap<u64, Trajectory>);

impl Trajectories {
    fn add(&mut self, number: u64, source: TrackSource, centre: &Point3<f64>) {
        let (x, y) = (centre.x, centre.y);
        let trajectory = self.0.entry(number).or_insert_with(|| Trajectory {
            source,
            points: Vec::new(),
        });
        let is_far = |last: &(f64, f64)| (last.0 - x).hypot(last.1 - y) >= POINT_SPACING_M;
        if trajectory.points.last().is_none_or(is_far) {
            trajectory.points.push((x, y));
        }
    }

    fn finish(self) -> Vec<Trajectory> {
        self.0.into_values().collect()
    }
}

/// Timeline row under construction.
#[derive(Default)]
struct TimelineRowBuilder {
    truth: TimelineSpans,
    tracks: TimelineSpans,
}

impl TimelineRowBuilder {
    fn row(&self, name: String) -> TimelineRow {
        let spans = self.truth.0.iter().chain(&self.tracks.0);
        TimelineRow {
            name,
            spans: spans.cloned().collect(),
        }
    }
}

#[derive(Default)]
struct TimelineSpans(Vec<TimelineSpan>);

impl TimelineSpans {
    /// Extends the last span of the same source, or begins a new one after a long pause.
    fn add(&mut self, source: TrackSource, time_s: f64) {
        let same = self.0.iter_mut().rev().find(|span| span.source == source);
        match same {
            Some(span) if time_s - span.time_s.end <= BRIDGED_PAUSE_S => span.time_s.end = time_s,
            _ => self.0.push(TimelineSpan {
                source,
                time_s: time_s..time_s,
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_pauses_do_not_break_a_line_and_long_ones_do() {
        let mut spans = TimelineSpans::default();
        for time_s in [0.0, 0.03, 0.1, 0.5, 0.53] {
            spans.add(TrackSource::Track(1), time_s);
            spans.add(TrackSource::Track(2), time_s);
        }
        let of_first = spans
            .0
            .iter()
            .filter(|span| span.source == TrackSource::Track(1));
        let times: Vec<_> = of_first.map(|span| span.time_s.clone()).collect();
        assert_eq!(times, [0.0..0.1, 0.5..0.53]);
    }

    #[test]
    fn trajectory_omits_points_of_a_static_track() {
        let mut trajectories = Trajectories::default();
        for x in [0.0, 0.001, 0.0015, 0.004, 0.0045] {
            trajectories.add(1, TrackSource::Truth, &Point3::new(x, 0.0, 0.8));
        }
        assert_eq!(trajectories.finish()[0].points, [(0.0, 0.0), (0.004, 0.0)]);
    }
}
