//! Golden bytes of the recorded documents that only recordings have.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use message::{
    ActorEvent, ActorEventKind, ArmActivity, ArmState, MemoryChange, NearCategory,
    ObjectViewHeader, PersonBody, Text, WireCapsule,
};
use recording::documents::{
    ActorEventDocument, ArmDocument, MemoryChangeDocument, ObjectViewDocument, PersonDocument,
};
use scene_document::Document;
use serde::de::DeserializeOwned;
use std::fmt::Debug;
use std::path::Path;
use test_data::golden;

/// Pins the documents of one type; the file has the name of their schema.
fn check<T: Document + DeserializeOwned + PartialEq + Debug>(examples: &[(&str, T)]) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    golden::check(
        &folder.join(format!("{}.txt", T::NAME)),
        examples,
        |document| serde_json::to_vec(document).unwrap(),
        |bytes| serde_json::from_slice(bytes).unwrap(),
    );
}

fn capsule() -> WireCapsule {
    WireCapsule {
        from_m: [0.5, -1.5, f64::NAN],
        to_m: [f64::INFINITY, f64::NEG_INFINITY, -0.0],
        radius_m: 0.125,
    }
}

#[test]
fn golden_documents_of_bodies_are_written_and_read() {
    let state = ArmState {
        stamp_ns: u64::MAX,
        activity: ArmActivity::Moving.code(),
        joint_angles_rad: [0.5; 6],
        command_id: 7,
        is_holding: 1,
        note: Text::truncated("küche"),
        ..ArmState::default()
    };
    check(&[("arm", ArmDocument::new(&state, &[capsule()]))]);
    let body = PersonBody {
        stamp_ns: 5,
        ..PersonBody::default()
    };
    check(&[
        ("person", PersonDocument::new(&body, &[capsule()])),
        ("nobody", PersonDocument::new(&body, &[])),
    ]);
}

#[test]
fn golden_documents_of_the_memory_are_written_and_read() {
    let change = MemoryChange {
        store_id: [1, u64::MAX],
        sequence: 3,
    };
    check(&[("change", MemoryChangeDocument::from(&change))]);
}

#[test]
fn golden_documents_of_events_are_written_and_read() {
    let event = ActorEvent {
        kind: ActorEventKind::Restarting.code(),
        track_id: 2,
        frame: 3,
        has_frame: 1,
        restart_after_ns: 4,
        cause: Text::truncated("panic"),
        ..ActorEvent::default()
    };
    check(&[("restart", ActorEventDocument::from(&event))]);
}

#[test]
fn golden_documents_of_views_are_written_and_read() {
    let mut view = ObjectViewHeader {
        track_id: 7,
        view_id: 2,
        is_key_view: 1,
        n_categories: 1,
        distance: 0.25,
        ..ObjectViewHeader::default()
    };
    view.categories[0] = NearCategory {
        label: Text::truncated("mug"),
        distance: 0.25,
        probability: 0.5,
    };
    let unknown = ObjectViewHeader {
        distance: f32::NAN,
        n_categories: 0,
        ..view
    };
    check(&[
        ("view", ObjectViewDocument::new(&view, &[0.5, -1.0])),
        ("without a distance", ObjectViewDocument::new(&unknown, &[])),
    ]);
}
