//! Golden layouts of all messages: name with version, and type and offset of each field.
//!
//! Programs of two releases may meet in one domain. iceoryx2 connects them when name, size and
//! alignment of a type agree, so that another layout needs another version.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use constraint::Ternary;
use message::*;
use scene_document::TrackState;
use std::fmt::Write;
use std::path::Path;
use std::{any, fs};
use test_data::golden;

/// Layouts by name and version; each has to list all public fields, else it does not compile.
macro_rules! layouts {
    ($($message:ident $name:literal { $($field:tt),+ })+) => {
        vec![$({
            let mut fields = String::new();
            $({
                let offset = std::mem::offset_of!($message, $field);
                let field = field_type(|message: &$message| &message.$field);
                write!(fields, "{}: {field} at {offset}, ", stringify!($field)).unwrap();
            })+
            let _exhaustive = |$message { $($field: _),+ }: $message| {};
            ($name, format!("{fields}size {}", size_of::<$message>()))
        }),+]
    };
}

/// Type of a field, without the modules of its name.
fn field_type<S, T>(_: impl Fn(&S) -> &T) -> String {
    let path = any::type_name::<T>();
    let is_of_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let parts = path.split_inclusive(|c| !is_of_path(c));
    parts
        .map(|part| part.rsplit("::").next().unwrap_or_default())
        .collect()
}

fn camera_messages() -> Vec<(&'static str, String)> {
    layouts![
        ImageHeader "tabula.ImageHeader.v6" {
            schema_version, flags, sent, session, sequence, capture_stamp_ns, color_intrinsics_px,
            depth_intrinsics_px, color_size_px, depth_size_px, color_encoding, depth_encoding,
            color_from_depth, world_from_camera
        }
        CloudPoint "tabula.CloudPoint.v1" { x, y, z, argb }
        SegmentLocation "tabula.SegmentLocation.v1" { inode, offset_bytes }
        FrameHeader "tabula.FrameHeader.v5" {
            schema_version, flags, sent, session, sequence, source_frame, capture_stamp_ns,
            scheduled_stamp_ns, published_stamp_ns, wall_clock_offset_ns, intrinsics_px, size_px,
            world_from_camera, up_in_camera, location, source_name, reserved
        }
        FrameDone "tabula.FrameDone.v1" { session, sequence, process }
        WireTransform "tabula.Transform.v1" { rows }
        WirePose "tabula.Pose.v1" { position_m, orientation_xyzw }
        PlainHeader "tabula.PlainHeader.v1" { sent }
    ]
}

fn object_messages() -> Vec<(&'static str, String)> {
    layouts![
        StageStamps "tabula.StageStamps.v1" {
            capture_ns, scheduled_ns, camera_published_ns, received_ns, detected_ns,
            recognised_ns, published_ns
        }
        ActorStamps "tabula.ActorStamps.v3" {
            asked_ns, begun_ns, described_ns, recognised_ns, answered_ns
        }
        SceneObject "tabula.SceneObject.v6" {
            track_id, state, cut_by_image, first_seen_ns, last_seen_ns, pose, size_m, n_points,
            n_views, mean_argb, color_percents, distance, is_labelled, label, n_categories,
            memory_sequence, linked_to, view_id, is_key_view, n_key_views, n_sides, probability,
            position_covariance_m2, rotation_covariance_rad2, velocity_m_s,
            angular_velocity_rad_s, categories, stamps
        }
        SceneSummary "tabula.SceneSummary.v9" {
            schema_version, frame_flags, sent, session, sequence, frames_dropped, stamps,
            stale_after_ns, n_surfaces, n_objects_total, n_late, n_rejected, surfaces,
            world_from_camera, source_name, assumptions, rule, n_ignored, ignored
        }
        NearCategory "tabula.NearCategory.v4" { label, distance, probability }
        ObjectViewHeader "tabula.ObjectViewHeader.v6" {
            track_id, view_id, is_key_view, sent, session, sequence, capture_ns, stamps, pose,
            size_m, n_points, frame_location, first_point_index, distance, detection_location,
            position_covariance_m2, rotation_covariance_rad2, velocity_m_s,
            angular_velocity_rad_s, n_key_views, n_categories, categories
        }
        ObjectCloudHeader "tabula.ObjectCloudHeader.v1" {
            track_id, session, sequence, capture_ns, sent
        }
        WireFinding "tabula.Finding.v1" { truth, reason, values }
        WireSurface "tabula.Surface.v1" {
            plane, kind, n_samples, n_corners, corners_m, reserved
        }
        RejectedCandidate "tabula.IgnoredBlob.v2" {
            pose, size_m, n_points, verdict, decisive, findings, surface, reserved
        }
        MemoryChange "tabula.MemoryChange.v1" { store_id, sequence }
    ]
}

fn robot_messages() -> Vec<(&'static str, String)> {
    layouts![
        WireCapsule "tabula.Capsule.v1" { from_m, to_m, radius_m }
        ArmState "tabula.ArmState.v5" {
            schema_version, activity, sent, stamp_ns, joint_angles_rad, joint_velocities_rad_s,
            opening_m, world_from_gripper, command_id, is_holding, note
        }
        PersonBody "tabula.PersonBody.v1" { schema_version, reserved, stamp_ns, sent }
        ViewPlanHeader "tabula.ViewPlanHeader.v1" {
            schema_version, has_world_pose, sent, session, sequence, capture_ns,
            world_from_camera, entropy, n_candidates, n_objects
        }
        PlannedView "tabula.PlannedView.v1" {
            world_from_camera, entropy, gain, weight, utility, state, rank, is_chosen,
            n_objects_seen
        }
        TrueObject "tabula.TrueObject.v1" {
            id, state, world_from_object, size_m, visible_fraction, visible_px, unoccluded_px,
            category, name
        }
        TruthHeader "tabula.TruthHeader.v1" {
            schema_version, reserved, session, sequence, capture_ns, sent
        }
        MaskPixel "tabula.MaskPixel.v1" { 0 }
    ]
}

fn process_messages() -> Vec<(&'static str, String)> {
    layouts![
        ActorEvent "tabula.ActorEvent.v3" {
            schema_version, kind, track_id, frame, has_frame, pid, stamp_ns, restart_after_ns,
            n_actors, n_restarts, n_abandoned, n_lost, cause, reserved
        }
        Health "tabula.Health.v3" {
            schema_version, process, pid, state, started_ns, stamp_ns, frames, frames_dropped,
            frames_late, allocated_bytes, allocations, resident_bytes, shared_memory_bytes,
            restarts, actors, abandoned, progress, note, reserved
        }
        TraceHeader "tabula.TraceHeader.v1" {
            process, pid, session, sequence, scheduled_ns, frame_flags, n_left_out, sent
        }
        Span "tabula.Span.v1" {
            begin_ns, end_ns, track_id, cpu_ns, allocated_bytes, stage, thread_id, n_allocations,
            n_voluntary_switches, n_involuntary_switches, n_minor_faults, n_major_faults, reserved
        }
    ]
}

fn text() -> (&'static str, String) {
    let n_bytes = size_of::<Text>();
    let layout = format!("bytes, zeros after the text, and its length as u32; size {n_bytes}");
    ("tabula.Text.v1", layout)
}

fn all() -> Vec<(&'static str, String)> {
    let mut all = [
        camera_messages(),
        object_messages(),
        robot_messages(),
        process_messages(),
    ]
    .concat();
    all.push(text());
    all
}

fn check(kind: &str, examples: &[(&str, String)]) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    golden::check(
        &folder.join(format!("{kind}.txt")),
        examples,
        |text| text.clone().into_bytes(),
        |bytes| String::from_utf8(bytes.to_vec()).unwrap(),
    );
}

#[test]
fn golden_layouts_of_messages_belong_to_their_versions() {
    check("layouts", &all());
}

#[test]
fn layouts_are_those_of_all_types_that_are_sent() {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let files = fs::read_dir(sources).unwrap().map(|file| file.unwrap());
    let files = files.filter(|file| file.file_type().unwrap().is_file());
    let code: String = files
        .map(|file| fs::read_to_string(file.path()).unwrap())
        .collect();
    let mut sent: Vec<&str> = code
        .split("#[type_name(\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap())
        .collect();
    let mut pinned: Vec<&str> = all().into_iter().map(|(name, _)| name).collect();
    sent.sort_unstable();
    pinned.sort_unstable();
    assert_eq!(pinned, sent);
}

/// Codes of an enumeration in shared memory, with their words.
macro_rules! codes {
    ($enumeration:ident, $all:expr) => {{
        let all = $all.into_iter();
        let codes: Vec<_> = all
            .map(|one| format!("{} {}", one.code(), one.word()))
            .collect();
        (stringify!($enumeration), codes.join(", "))
    }};
    ($enumeration:ident) => {
        codes!($enumeration, $enumeration::ALL.iter().copied())
    };
}

#[test]
fn golden_codes_in_messages_keep_their_meanings() {
    let codes = [
        codes!(ActorEventKind),
        codes!(ProcessState),
        codes!(ProcessKind, ProcessKind::all()),
        codes!(ArmActivity),
        codes!(ViewState),
        codes!(TrackState),
        codes!(Ternary),
        codes!(Stage),
    ];
    check("codes", &codes);
}
