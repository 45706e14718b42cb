//! From tracks to messages.

use crate::intake::Arrived;
use crate::object_actor::Observed;
use detection::{Assumption, Candidate, Detection};
use geometry::RigidTransform;
use message::control::{StoredView, ViewId};
use message::{
    IgnoredBlob, MAX_IGNORED, MAX_SCENE_OBJECTS, ObjectViewHeader, SceneObject, SceneSummary,
    SegmentLocation, StageStamps, Text, TrackState, WirePose,
};
use pipeline::{DESCRIPTOR_KIND, Sighting, Track};
use point_cloud::Rgba;
use std::collections::BTreeMap;
use tracking::{Sight, TrackPhase};

/// One object of the summary. `memory_sequence` belongs to its label.
fn object(track: &Track, memory_sequence: u64) -> SceneObject {
    let body = track.box_in_world();
    let state = match track.phase() {
        _ if track.sight() != Sight::Seen => TrackState::Missing,
        TrackPhase::Tentative => TrackState::Tentative,
        _ => TrackState::Tracked,
    };
    let [red, green, blue] = track.measured.mean_rgb.map(|channel| channel as u8);
    SceneObject {
        track_id: track.id,
        state: state.code(),
        cut_by_image: u32::from(track.measured.is_cut_by_image),
        first_seen_ns: track.first_seen_ns,
        last_seen_ns: track.last_seen_ns,
        pose: WirePose::from(&body.frame_from_box),
        size_m: body.sides_m().map(|side| side as f32).into(),
        n_points: track.measured.n_points as u32,
        n_views: track.n_views,
        mean_argb: Rgba::opaque(red, green, blue).0,
        distance: if track.distance.is_finite() {
            track.distance
        } else {
            f32::NAN
        },
        is_labelled: u32::from(track.label.is_some()),
        label: track
            .label
            .as_ref()
            .map(|label| Text::truncated(label.as_str()))
            .unwrap_or_default(),
        memory_sequence,
        ..SceneObject::default()
    }
}

/// Replaces `objects` by those of the tracks, as many as a summary holds.
pub(crate) fn objects(
    tracks: &[Track],
    memory_sequences: &BTreeMap<u64, u64>,
    objects: &mut Vec<SceneObject>,
) {
    let sequence = |track: &Track| memory_sequences.get(&track.id).copied().unwrap_or(0);
    objects.clear();
    objects.extend(
        tracks
            .iter()
            .take(MAX_SCENE_OBJECTS)
            .map(|track| object(track, sequence(track))),
    );
}

/// The summary of a frame without what the tracks add.
pub(crate) fn summary(arrived: &Arrived) -> SceneSummary {
    let header = arrived.frame.header();
    SceneSummary {
        frame_flags: header.flags,
        session: header.session,
        sequence: header.sequence,
        source_name: header.source_name,
        stamps: StageStamps {
            capture_ns: header.capture_stamp_ns,
            scheduled_ns: header.scheduled_stamp_ns,
            camera_published_ns: header.published_stamp_ns,
            received_ns: arrived.received_ns,
            ..StageStamps::default()
        },
        ..SceneSummary::default()
    }
}

/// Adds what a frame's detection says: the table, what was taken for granted, and
/// which candidates are `rejected`.
pub(crate) fn add_detection(
    summary: &mut SceneSummary,
    detection: &Detection,
    rejected: &[usize],
    world_from_camera: Option<&RigidTransform>,
) {
    let mut assumptions = detection.assumptions;
    if world_from_camera.is_none() {
        assumptions.add(Assumption::NoCameraPose);
    }
    summary.assumptions = assumptions.bits();
    let pose = world_from_camera.copied().unwrap_or_default();
    if let Some(table) = &detection.table {
        let plane = table.plane.transformed(&pose);
        let normal = plane.normal.into_inner();
        summary.has_table = 1;
        summary.table_plane = [normal.x, normal.y, normal.z, plane.offset_m];
    }
    summary.n_rejected = rejected.len() as u32;
    summary.n_ignored = rejected.len().min(MAX_IGNORED) as u32;
    let candidates = rejected.iter().filter_map(|&i| detection.candidates.get(i));
    for (blob, candidate) in summary.ignored.iter_mut().zip(candidates) {
        *blob = ignored(candidate, &pose);
    }
}

fn ignored(candidate: &Candidate, world_from_camera: &RigidTransform) -> IgnoredBlob {
    let body = candidate.oriented_box.transformed(world_from_camera);
    IgnoredBlob {
        pose: WirePose::from(&body.frame_from_box),
        size_m: body.sides_m().map(|side| side as f32).into(),
        n_points: candidate.n_points() as u32,
        verdict: candidate.verdict.code().into(),
        decisive: candidate.decisive.bits().into(),
        findings: IgnoredBlob::wire_findings(&candidate.findings),
    }
}

/// The header of one described view.
pub(crate) fn object_view(
    arrived: &Arrived,
    sighting: &Sighting,
    observed: &Observed,
    detection_location: SegmentLocation,
) -> ObjectViewHeader {
    let header = arrived.frame.header();
    let posterior = &observed.posterior;
    let body = posterior.filter.box_in_world();
    ObjectViewHeader {
        track_id: sighting.track_id,
        view_id: posterior.view_id,
        is_key_view: u32::from(posterior.is_key_view),
        session: header.session,
        sequence: header.sequence,
        capture_ns: header.capture_stamp_ns,
        described_ns: observed.described_ns,
        pose: WirePose::from(&body.frame_from_box),
        size_m: body.sides_m().map(|side| side as f32).into(),
        n_points: sighting.measured.n_points as u32,
        frame_location: observed.location,
        first_point_index: observed.first_point_index,
        distance: if posterior.distance.is_finite() {
            posterior.distance
        } else {
            f32::NAN
        },
        detection_location,
        ..ObjectViewHeader::default()
    }
}

/// A key view for the memory.
pub(crate) fn stored_view(
    arrived: &Arrived,
    sighting: &Sighting,
    observed: &Observed,
) -> StoredView {
    let header = arrived.frame.header();
    let body = observed.posterior.filter.box_in_world();
    let pose = WirePose::from(&body.frame_from_box);
    StoredView {
        id: ViewId {
            track_id: sighting.track_id,
            view_id: observed.posterior.view_id,
        },
        descriptor_kind: DESCRIPTOR_KIND.into(),
        descriptor: observed
            .descriptor
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect(),
        position_m: pose.position_m,
        orientation_xyzw: pose.orientation_xyzw,
        size_m: body.sides_m().into(),
        captured_ns: (header.capture_stamp_ns as i64).saturating_add(header.wall_clock_offset_ns),
        frame_sequence: header.sequence,
        source_name: header.source_name.as_str().unwrap_or_default().to_owned(),
    }
}
