//! Drift and jitter of the tracks of static objects.

use crate::tracked_frame::TrackedFrame;
use nalgebra::{Point3, Vector3};
use statistics::spread::Spread;
use std::collections::BTreeMap;

/// Life span and drift of a track.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackSpan {
    /// Track-id of the span.
    pub id: u64,
    /// Index of the first frame in which the track was output.
    pub first_frame: usize,
    /// Index of the last frame in which the track was output.
    pub last_frame: usize,
    /// Number of frames in which the track was output.
    pub n_frames: usize,
    /// Component-wise median of the box centre, world frame, metres.
    pub centre: Point3<f64>,
    /// Maximum distance of the centre from its median, metres.
    pub drift_m: f64,
    /// Standard deviation of the centre over all axes, metres.
    pub sigma_m: f64,
}

/// Spans of all output tracks of a recording, by track-id.
pub fn track_spans(frames: &[TrackedFrame]) -> Vec<TrackSpan> {
    let mut seen: BTreeMap<u64, Vec<(usize, Point3<f64>)>> = BTreeMap::new();
    for (index, frame) in frames.iter().enumerate() {
        for track in frame.tracks.iter().filter(|track| track.is_output) {
            let centre = track.box_in_world.centre();
            seen.entry(track.id).or_default().push((index, centre));
        }
    }
    let spans = seen.into_iter();
    spans.filter_map(|(id, seen)| span(id, &seen)).collect()
}

/// Component-wise median of points; the origin without points.
pub(crate) fn component_median(points: &[Point3<f64>]) -> Point3<f64> {
    Point3::from(Vector3::from_fn(|axis, _| {
        let along: Vec<f64> = points.iter().map(|point| point[axis]).collect();
        Spread::of(&along).map_or(0.0, |spread| spread.median)
    }))
}

fn span(id: u64, seen: &[(usize, Point3<f64>)]) -> Option<TrackSpan> {
    let (first, last) = (seen.first()?, seen.last()?);
    let centres: Vec<Point3<f64>> = seen.iter().map(|(_, centre)| *centre).collect();
    let median = component_median(&centres);
    let n = seen.len() as f64;
    let mean = centres
        .iter()
        .map(|centre| centre.coords)
        .sum::<Vector3<f64>>()
        / n;
    let variance_m2 = centres
        .iter()
        .map(|centre| (centre.coords - mean).norm_squared())
        .sum::<f64>()
        / n;
    let away = centres.iter().map(|centre| (centre - median).norm());
    Some(TrackSpan {
        id,
        first_frame: first.0,
        last_frame: last.0,
        n_frames: seen.len(),
        centre: median,
        drift_m: away.fold(0.0, f64::max),
        sigma_m: variance_m2.sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracked_frame::TrackState;
    use geometry::{OrientedBox, RigidTransform};

    fn frame(tracks: &[(u64, f64, bool)]) -> TrackedFrame {
        let track = |(id, x, is_output): &(u64, f64, bool)| TrackState {
            id: *id,
            is_output: *is_output,
            box_in_world: OrientedBox {
                frame_from_box: RigidTransform::translation(*x, 1.0, 0.8),
                half_sides_m: Vector3::repeat(0.05),
            },
        };
        TrackedFrame {
            tracks: tracks.iter().map(track).collect(),
            ..TrackedFrame::default()
        }
    }

    #[test]
    fn spans_have_frames_position_and_drift() {
        let frames = [
            frame(&[(3, 0.0, false)]),
            frame(&[(3, 0.0, true), (5, 0.7, true)]),
            frame(&[(3, 0.0, true)]),
            frame(&[(3, 9.0, false)]),
            frame(&[(3, 0.03, true)]),
        ];
        let spans = track_spans(&frames);
        assert_eq!(spans.len(), 2);
        let [first, other] = &spans[..] else {
            panic!("{spans:?}");
        };
        assert_eq!(
            (
                first.id,
                first.first_frame,
                first.last_frame,
                first.n_frames
            ),
            (3, 1, 4, 3)
        );
        assert!((first.centre - Point3::new(0.0, 1.0, 0.8)).norm() < 1e-12);
        assert!((first.drift_m - 0.03).abs() < 1e-12);
        // Offsets of 0, 0 and 30 mm: variance 10^2 (1 + 1 + 4) / 3.
        assert!((first.sigma_m - 0.01 * 2_f64.sqrt()).abs() < 1e-12);
        assert_eq!(
            (other.n_frames, other.drift_m, other.sigma_m),
            (1, 0.0, 0.0)
        );
        assert!(track_spans(&[]).is_empty());
    }
}
