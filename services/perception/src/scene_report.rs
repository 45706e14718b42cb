//! Conversion of tracks and detections to wire messages.

use crate::frame_receiver::ReceivedFrame;
use crate::newest_view::{NewestView, NewestViews};
use crate::object_actor::ObservedView;
use constraint::Assumption;
use control_protocol::{DescriptorBytes, StoredView, ViewId};
use detection::{Candidate, Detection, SurfaceRole, Table};
use geometry::RigidTransform;
use learning::{DESCRIPTOR_KIND, N_NEAREST, Neighbour, Recognition};
use message::{
    MAX_NEAR_CATEGORIES, MAX_REJECTED_CANDIDATES, MAX_SCENE_OBJECTS, MAX_SURFACE_CORNERS,
    MAX_SURFACES, NearCategory, ObjectViewHeader, RejectedCandidate, SceneObject, SceneSummary,
    StageStamps, SurfaceKind, Text, TrackState, WirePose, WireSurface, upper_triangle,
};
use pipeline::{CandidateMeasurement, Sighting, Track};
use point_cloud::Rgba;
use std::mem;
use tracking::Visibility;

const _: () = assert!(N_NEAREST == MAX_NEAR_CATEGORIES);

fn state(track: &Track) -> TrackState {
    match track.visibility() {
        Visibility::Occluded => TrackState::Occluded,
        Visibility::OutOfView => TrackState::OutOfView,
        Visibility::Missing => TrackState::Missing,
        Visibility::Visible => TrackState::Tracked,
    }
}

/// Distance on the wire: NaN when no view is labelled.
fn wire_distance(distance: f32) -> f32 {
    if distance.is_finite() {
        distance
    } else {
        f32::NAN
    }
}

/// Most probable categories on the wire, with their number.
fn near_categories(
    nearest: &[Option<Neighbour>; N_NEAREST],
) -> ([NearCategory; MAX_NEAR_CATEGORIES], u32) {
    let mut categories = [NearCategory::default(); MAX_NEAR_CATEGORIES];
    let found = nearest.iter().flatten();
    for (place, neighbour) in categories.iter_mut().zip(found) {
        *place = NearCategory {
            label: Text::truncated(neighbour.category.as_str()),
            distance: neighbour.distance,
            probability: neighbour.probability.unwrap_or(0.0),
        };
    }
    (categories, nearest.iter().flatten().count() as u32)
}

fn mean_rgb(measured: &CandidateMeasurement) -> [u8; 3] {
    measured.mean_rgb.map(|channel| channel as u8)
}

/// Shares of the basic colour terms on the wire.
fn color_percents(measured: &CandidateMeasurement) -> [u8; 16] {
    let mut percents = [0; 16];
    for (percent, share) in percents.iter_mut().zip(measured.color_shares.values()) {
        *percent = (100.0 * share).round() as u8;
    }
    percents
}

/// Writes a recognition result into an object of the scene, with the position in the memory's
/// history that it was read at.
pub(crate) fn set_label(object: &mut SceneObject, recognised: &Recognition, memory_sequence: u64) {
    let label = recognised.label.as_ref();
    let is_anything_taught = recognised.nearest[0].is_some();
    let probability = recognised.probability.filter(|_| is_anything_taught);
    object.distance = wire_distance(recognised.distance);
    object.probability = probability.unwrap_or(f32::NAN);
    object.is_labelled = u32::from(label.is_some());
    object.label = label
        .map(|label| Text::truncated(label.as_str()))
        .unwrap_or_default();
    (object.categories, object.n_categories) = near_categories(&recognised.nearest);
    object.n_sides = recognised.n_sides as u32;
    object.memory_sequence = memory_sequence;
}

/// Wire object of a track; a track without a view has no label.
fn object(track: &Track, view: Option<&NewestView>, memory_sequence: u64) -> SceneObject {
    let mut object = unrecognised_object(track);
    if let Some(view) = view {
        object.is_key_view = u32::from(view.is_key_view);
        object.stamps = view.stamps;
        set_label(&mut object, track.recognition(), memory_sequence);
    }
    object
}

fn unrecognised_object(track: &Track) -> SceneObject {
    let body = track.box_in_world();
    let [red, green, blue] = mean_rgb(&track.measured);
    SceneObject {
        track_id: track.id,
        state: state(track).code(),
        cut_by_image: u32::from(track.measured.is_truncated_by_image),
        first_seen_ns: track.first_seen_ns,
        last_seen_ns: track.last_seen_ns,
        pose: WirePose::from(&body.frame_from_box),
        size_m: body.sides_m().map(|side| side as f32).into(),
        n_points: track.measured.n_points as u32,
        n_views: track.n_views,
        mean_argb: Rgba::opaque(red, green, blue).0,
        color_percents: color_percents(&track.measured),
        distance: f32::NAN,
        probability: f32::NAN,
        linked_to: track.reidentified_as.unwrap_or(0),
        view_id: track.n_views.saturating_sub(1),
        n_key_views: track.n_key_views,
        position_covariance_m2: upper_triangle(&track.position_covariance_m2()),
        rotation_covariance_rad2: upper_triangle(&track.rotation_covariance_rad2()),
        velocity_m_s: track.velocity_m_s().cast().into(),
        angular_velocity_rad_s: track.angular_velocity_rad_s().cast().into(),
        ..SceneObject::default()
    }
}

/// Replaces `objects` by those of the tracks, up to the capacity of a summary.
pub(crate) fn objects(
    tracks: &[Track],
    newest_views: &NewestViews,
    memory_sequence: u64,
    objects: &mut Vec<SceneObject>,
) {
    objects.clear();
    objects.extend(
        tracks
            .iter()
            .take(MAX_SCENE_OBJECTS)
            .map(|track| object(track, newest_views.get(&track.id), memory_sequence)),
    );
}

/// Scene summary with the header of a frame, without objects.
pub(crate) fn summary(received: &ReceivedFrame) -> SceneSummary {
    let header = received.frame.header();
    SceneSummary {
        frame_flags: header.flags,
        session: header.session,
        sequence: header.sequence,
        source_name: header.source_name,
        stamps: StageStamps {
            capture_ns: header.capture_stamp_ns,
            scheduled_ns: header.scheduled_stamp_ns,
            camera_published_ns: header.published_stamp_ns,
            received_ns: received.received_ns,
            ..StageStamps::default()
        },
        ..SceneSummary::default()
    }
}

/// Adds the result of detection: the camera pose, the support surfaces, the assumptions, and the
/// rejected candidates.
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
    summary.world_from_camera = WirePose::from(&pose);
    summary.n_surfaces = detection.surfaces.len().min(MAX_SURFACES) as u32;
    for (wire, found) in summary.surfaces.iter_mut().zip(&detection.surfaces) {
        *wire = surface(found, &pose);
    }
    summary.n_rejected = rejected.len() as u32;
    summary.n_ignored = rejected.len().min(MAX_REJECTED_CANDIDATES) as u32;
    let candidates = rejected.iter().filter_map(|&i| detection.candidates.get(i));
    for (rejected, candidate) in summary.ignored.iter_mut().zip(candidates) {
        *rejected = ignored(candidate, &pose);
    }
}

/// Wire surface; of a hull with many corners every second or third one is told.
fn surface(found: &Table, world_from_camera: &RigidTransform) -> WireSurface {
    let plane = found.plane.transformed(world_from_camera);
    let normal = plane.normal.into_inner();
    let kind = match found.role {
        SurfaceRole::Table => SurfaceKind::Table,
        SurfaceRole::Level => SurfaceKind::Level,
        SurfaceRole::NewLevel => SurfaceKind::NewLevel,
        SurfaceRole::Floor => SurfaceKind::Floor,
    };
    let n_corners = found.polygon.corners().len();
    let step = n_corners.div_ceil(MAX_SURFACE_CORNERS).max(1);
    let mut surface = WireSurface {
        plane: [normal.x, normal.y, normal.z, plane.offset_m],
        kind: kind.code(),
        n_samples: found.n_samples as u32,
        n_corners: n_corners.div_ceil(step) as u32,
        ..WireSurface::default()
    };
    let corners = found.corners(world_from_camera).step_by(step);
    for (wire, corner) in surface.corners_m.iter_mut().zip(corners) {
        *wire = corner.coords.cast().into();
    }
    surface
}

fn ignored(candidate: &Candidate, world_from_camera: &RigidTransform) -> RejectedCandidate {
    let body = candidate.oriented_box.transformed(world_from_camera);
    RejectedCandidate {
        pose: WirePose::from(&body.frame_from_box),
        size_m: body.sides_m().map(|side| side as f32).into(),
        n_points: candidate.n_points() as u32,
        verdict: candidate.verdict.code().into(),
        decisive: candidate.decisive.bits().into(),
        findings: RejectedCandidate::wire_findings(&candidate.findings),
        surface: candidate.surface as u32,
        reserved: 0,
    }
}

/// Header of a described view; `detection_location` is left at its default.
pub(crate) fn object_view(
    received: &ReceivedFrame,
    sighting: &Sighting,
    observed: &ObservedView,
    track: Option<&Track>,
) -> ObjectViewHeader {
    let header = received.frame.header();
    let posterior = &observed.posterior;
    let body = posterior.filter.box_in_world();
    let recognised = posterior.evidence.recognition();
    let (categories, n_categories) = near_categories(&recognised.nearest);
    let mut view = ObjectViewHeader {
        track_id: sighting.track_id,
        view_id: posterior.view_id,
        is_key_view: u32::from(posterior.is_key_view),
        session: header.session,
        sequence: header.sequence,
        capture_ns: header.capture_stamp_ns,
        stamps: observed.stamps,
        pose: WirePose::from(&body.frame_from_box),
        size_m: body.sides_m().map(|side| side as f32).into(),
        n_points: sighting.measured.n_points as u32,
        frame_location: observed.location,
        first_point_index: observed.first_point_index,
        distance: wire_distance(recognised.distance),
        n_key_views: posterior.n_key_views,
        n_categories,
        categories,
        ..ObjectViewHeader::default()
    };
    if let Some(track) = track {
        view.position_covariance_m2 = upper_triangle(&track.position_covariance_m2());
        view.rotation_covariance_rad2 = upper_triangle(&track.rotation_covariance_rad2());
        view.velocity_m_s = track.velocity_m_s().cast().into();
        view.angular_velocity_rad_s = track.angular_velocity_rad_s().cast().into();
    }
    view
}

/// Key view for the memory; moves the packed cloud out of the answer.
pub(crate) fn stored_view(
    received: &ReceivedFrame,
    sighting: &Sighting,
    observed: &mut ObservedView,
) -> StoredView {
    let header = received.frame.header();
    let body = observed.posterior.filter.box_in_world();
    let pose = WirePose::from(&body.frame_from_box);
    StoredView {
        id: ViewId {
            track_id: sighting.track_id,
            view_id: observed.posterior.view_id,
        },
        descriptor_kind: DESCRIPTOR_KIND.into(),
        descriptor: DescriptorBytes::encode(&observed.descriptor),
        position_m: pose.position_m,
        orientation_xyzw: pose.orientation_xyzw,
        size_m: body.sides_m().into(),
        captured_ns: (header.capture_stamp_ns as i64).saturating_add(header.wall_clock_offset_ns),
        frame_sequence: header.sequence,
        source_name: header.source_name.as_str().unwrap_or_default().to_owned(),
        points: mem::take(&mut observed.packed_cloud),
        mean_rgb: Some(mean_rgb(&sighting.measured)),
    }
}
