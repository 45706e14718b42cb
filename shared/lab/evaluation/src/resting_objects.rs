//! Score of the tracks of a recording against objects at rest whose places a person marked.
//!
//! The marks need no segmentation: a place, a radius and the frames in which the object is wholly
//! in view are enough to tell whether an identity lasts and whether its position drifts.

use crate::track_drift::component_median;
use crate::tracked_frame::TrackedFrame;
use nalgebra::Point3;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Distance by which the centre of a track may lie outside of the radius of its object, metres:
/// the sum of a camera pose that is wrong by a few centimetres and of a partial view.
/// Chosen; part of the metric definition.
const REACH_M: f64 = 0.05;

/// Marks of a recording: objects at rest, and things that are not scored.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RestingObjects {
    /// Objects on the table.
    #[serde(rename = "object")]
    pub objects: Vec<RestingObject>,
    /// Regions with things that are neither objects of the table nor furniture, such as those on
    /// another surface: a track there is not scored.
    #[serde(rename = "ignored", default)]
    pub ignored: Vec<IgnoredRegion>,
}

/// Object at rest as marked by a person.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RestingObject {
    /// Name of the object.
    pub name: String,
    /// Colour in one word.
    pub color: String,
    /// Centre of the object, world frame, metres.
    pub place_in_world_m: [f64; 3],
    /// Radius of the smallest sphere around the object, metres.
    pub radius_m: f64,
    /// Pairs of first and last frame between which all of the object is in the image.
    pub in_view: Vec<[usize; 2]>,
}

/// Sphere in which tracks are not scored.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IgnoredRegion {
    /// Name of the things in the region.
    pub name: String,
    /// Centre of the sphere, world frame, metres.
    pub place_in_world_m: [f64; 3],
    /// Radius of the sphere, metres.
    pub radius_m: f64,
}

/// Score of the tracks of one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct RestingScore {
    /// Scores by object, in the order of the marks.
    pub objects: Vec<RestingObjectScore>,
    /// Track-ids without an object and outside of the ignored regions, ascending.
    pub tracks_of_nothing: Vec<u64>,
}

/// Score of the tracks of one object at rest.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RestingObjectScore {
    /// Track-ids of the object, ascending.
    pub ids: Vec<u64>,
    /// Number of frames in which the object was wholly in view.
    pub n_in_view: usize,
    /// Number of those frames in which a track of the object was output.
    pub n_tracked: usize,
    /// Number of changes of the track-id between one output frame and the next; of several tracks
    /// at once the earlier one continues.
    pub n_switches: usize,
    /// Maximum distance between a track's centre and the component-wise median of the centres of
    /// the object's tracks, over the frames with the object wholly in view, metres; `None` when it
    /// was never tracked.
    pub drift_m: Option<f64>,
    /// Distance of that median from the marked place, metres.
    pub offset_m: Option<f64>,
}

impl RestingObjects {
    /// Validated marks.
    ///
    /// # Errors
    /// Names the first mark whose place, radius or frames are impossible.
    pub fn validated(self) -> Result<Self, String> {
        if self.objects.is_empty() {
            return Err("it marks no object".to_owned());
        }
        let objects = self.objects.iter();
        let of_objects = objects.map(|object| (&object.name, object.radius_m));
        let of_regions = self.ignored.iter().map(|r| (&r.name, r.radius_m));
        for (name, radius_m) in of_objects.chain(of_regions) {
            if !(0.001..=100.0).contains(&radius_m) {
                return Err(format!(
                    "the radius of {name} is not between 1 mm and 100 m"
                ));
            }
        }
        for object in &self.objects {
            if object.in_view.iter().any(|[first, last]| first > last) {
                let name = &object.name;
                return Err(format!("{name} leaves the view before it enters it"));
            }
        }
        Ok(self)
    }

    /// Object or ignored region at a place, by the distance relative to its radius; `None` when
    /// the place is beyond the reach of all.
    fn mark_at(&self, place: &Point3<f64>) -> Option<Mark> {
        let objects = self.objects.iter().enumerate();
        let objects = objects.map(|(i, o)| (Mark::Object(i), o.place_in_world_m, o.radius_m));
        let ignored = self.ignored.iter();
        let ignored = ignored.map(|r| (Mark::Ignored, r.place_in_world_m, r.radius_m));
        objects
            .chain(ignored)
            .map(|(mark, centre, radius_m)| {
                let distance_m = (place - Point3::from(centre)).norm();
                (mark, distance_m / (radius_m + REACH_M))
            })
            .filter(|(_, relative)| *relative <= 1.0)
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(mark, _)| mark)
    }
}

impl RestingObject {
    /// True if all of the object is in the image of a frame.
    fn is_in_view(&self, frame: usize) -> bool {
        let mut intervals = self.in_view.iter();
        intervals.any(|[first, last]| (*first..=*last).contains(&frame))
    }
}

/// Marked thing at a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Mark {
    Object(usize),
    Ignored,
}

impl RestingScore {
    /// Score of the frames of a recording in order. A track belongs to the mark that it is found
    /// at most often.
    pub fn of(frames: &[TrackedFrame], marks: &RestingObjects) -> Self {
        let owners = owners(frames, marks);
        let of_nothing = owners.iter().filter(|(_, owner)| owner.is_none());
        Self {
            objects: (0..marks.objects.len())
                .map(|i| object_score(frames, &marks.objects[i], &ids_of(&owners, i)))
                .collect(),
            tracks_of_nothing: of_nothing.map(|(id, _)| *id).collect(),
        }
    }

    /// Mean number of track-ids of the objects that were tracked; `None` without any.
    pub fn ids_per_object(&self) -> Option<f64> {
        let tracked = self.objects.iter().filter(|object| !object.ids.is_empty());
        let n_ids: usize = self.objects.iter().map(|object| object.ids.len()).sum();
        let n_tracked = tracked.count();
        (n_tracked > 0).then(|| n_ids as f64 / n_tracked as f64)
    }

    /// Sum of the identity switches of all objects.
    pub fn n_switches(&self) -> usize {
        self.objects.iter().map(|object| object.n_switches).sum()
    }
}

/// Track-ids of an object, ascending.
fn ids_of(owners: &BTreeMap<u64, Option<Mark>>, object: usize) -> Vec<u64> {
    let of_object = owners.iter();
    let of_object = of_object.filter(|(_, owner)| **owner == Some(Mark::Object(object)));
    of_object.map(|(id, _)| *id).collect()
}

/// Most frequent mark of each output track; `None` for a track that is mostly at none.
fn owners(frames: &[TrackedFrame], marks: &RestingObjects) -> BTreeMap<u64, Option<Mark>> {
    let mut counts: BTreeMap<u64, BTreeMap<Option<Mark>, usize>> = BTreeMap::new();
    let tracks = frames.iter().flat_map(|frame| &frame.tracks);
    for track in tracks.filter(|track| track.is_output) {
        let mark = marks.mark_at(&track.box_in_world.centre());
        *counts.entry(track.id).or_default().entry(mark).or_default() += 1;
    }
    let most_frequent = |counts: BTreeMap<Option<Mark>, usize>| {
        let most = counts.into_iter().max_by_key(|(_, n)| *n);
        most.and_then(|(mark, _)| mark)
    };
    let counts = counts.into_iter();
    counts
        .map(|(id, counts)| (id, most_frequent(counts)))
        .collect()
}

fn object_score(
    frames: &[TrackedFrame],
    object: &RestingObject,
    ids: &[u64],
) -> RestingObjectScore {
    let mut score = RestingObjectScore {
        ids: ids.to_vec(),
        ..RestingObjectScore::default()
    };
    let mut centres: Vec<Point3<f64>> = Vec::new();
    let mut last_id = None;
    for (index, frame) in frames.iter().enumerate() {
        let outputs = || {
            let own = frame.tracks.iter().filter(|track| ids.contains(&track.id));
            own.filter(|track| track.is_output)
        };
        let continued = outputs().find(|track| Some(track.id) == last_id);
        let current = continued.or_else(|| outputs().next());
        if let Some(track) = current {
            score.n_switches += usize::from(last_id.is_some_and(|id| id != track.id));
            last_id = Some(track.id);
        }
        if object.is_in_view(index) {
            score.n_in_view += 1;
            score.n_tracked += usize::from(current.is_some());
            centres.extend(outputs().map(|track| track.box_in_world.centre()));
        }
    }
    if !centres.is_empty() {
        let median = component_median(&centres);
        let away = centres.iter().map(|centre| (centre - median).norm());
        score.drift_m = Some(away.fold(0.0, f64::max));
        score.offset_m = Some((median - Point3::from(object.place_in_world_m)).norm());
    }
    score
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracked_frame::TrackState;
    use geometry::{OrientedBox, RigidTransform};
    use nalgebra::Vector3;

    fn frame(tracks: &[(u64, f64)]) -> TrackedFrame {
        let track = |(id, x): &(u64, f64)| TrackState {
            id: *id,
            is_output: true,
            box_in_world: OrientedBox {
                frame_from_box: RigidTransform::translation(*x, 0.0, 0.0),
                half_sides_m: Vector3::repeat(0.05),
            },
        };
        TrackedFrame {
            tracks: tracks.iter().map(track).collect(),
            ..TrackedFrame::default()
        }
    }

    fn marks() -> RestingObjects {
        let object = |name: &str, x: f64, radius_m: f64| RestingObject {
            name: name.to_owned(),
            color: "white".to_owned(),
            place_in_world_m: [x, 0.0, 0.0],
            radius_m,
            in_view: vec![[1, 2], [4, 4]],
        };
        RestingObjects {
            objects: vec![object("mug", 0.0, 0.06), object("papers", 0.2, 0.2)],
            ignored: vec![IgnoredRegion {
                name: "counter".to_owned(),
                place_in_world_m: [3.0, 0.0, 0.0],
                radius_m: 0.5,
            }],
        }
    }

    #[test]
    fn resting_score_counts_ids_switches_drift_and_tracks_of_nothing() {
        let frames = [
            frame(&[(1, 0.09), (2, 0.2)]),
            frame(&[(1, 0.0), (2, 0.2), (7, 1.0)]),
            frame(&[(2, 0.2), (8, 3.2)]),
            frame(&[(2, 0.2)]),
            frame(&[(5, 0.04), (2, 0.23)]),
            frame(&[(1, 0.0), (5, 0.0)]),
        ];
        let score = RestingScore::of(&frames, &marks());
        assert_eq!(score.tracks_of_nothing, [7]);
        assert_eq!((score.ids_per_object(), score.n_switches()), (Some(1.5), 1));
        let [mug, papers] = &score.objects[..] else {
            panic!("{score:?}");
        };
        assert_eq!((&mug.ids[..], &papers.ids[..]), (&[1, 5][..], &[2][..]));
        // In view in frames 1, 2 and 4; without a track in frame 2. Frame 0 does not count.
        assert_eq!((mug.n_in_view, mug.n_tracked), (3, 2));
        assert!((mug.drift_m.unwrap() - 0.04).abs() < 1e-12);
        assert!((papers.drift_m.unwrap() - 0.03).abs() < 1e-12);
        assert!(papers.offset_m.unwrap() < 1e-12);
    }

    #[test]
    fn resting_objects_with_impossible_marks_are_refused() {
        assert!(marks().validated().is_ok());
        let mut wrong = marks();
        wrong.objects[1].radius_m = f64::NAN;
        assert!(wrong.validated().unwrap_err().contains("papers"));
        let mut wrong = marks();
        wrong.objects[0].in_view = vec![[5, 4]];
        assert!(wrong.validated().unwrap_err().contains("mug"));
        assert!(RestingObjects::default().validated().is_err());
    }
}
