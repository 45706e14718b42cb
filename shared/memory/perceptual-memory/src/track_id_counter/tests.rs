use super::*;
use crate::mutation::{Mutation, StoreChange};
use crate::opening::Condition;
use crate::perceptual_memory::PerceptualMemory;
use crate::requester::Requester;
use crate::view::{CapturedView, StoredDescriptor};
use crate::{DataLoss, StoreRefusal, verify_folder};
use durable_leveldb::MutationId;
use geometry::OrientedBox;
use learning::ViewId;
use nalgebra::{Isometry3, Vector3};
use std::path::Path;
use tempfile::TempDir;

fn view(track_id: u64) -> CapturedView {
    CapturedView {
        id: ViewId {
            track_id,
            view_id: 0,
        },
        descriptor: StoredDescriptor {
            kind: "test".to_owned(),
            values: vec![track_id as f32],
        },
        box_in_world: OrientedBox {
            frame_from_box: Isometry3::identity(),
            half_sides_m: Vector3::repeat(0.1),
        },
        captured_ns: track_id,
        frame_sequence: 0,
        source: String::new(),
        mean_rgb: None,
        points: None,
    }
}

fn store(memory: &mut PerceptualMemory, track_id: u64) {
    let mutation = Mutation {
        id: MutationId(u128::from(track_id)),
        author: String::new(),
        requester: Requester::default(),
        wall_ns: 1,
        change: StoreChange::StoreViews(vec![view(track_id)]),
    };
    memory.apply(&mutation).unwrap();
}

/// Two honest tracks, and one under a huge id, to which the counter was raised as
/// programs before this one did.
fn store_with_raised_counter(hostile_id: u64) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let (mut memory, _) = PerceptualMemory::open(folder.path(), 1).unwrap();
    memory.lease_track_ids(64).unwrap();
    store(&mut memory, 1);
    store(&mut memory, 40);
    memory.meta.next_track_id = hostile_id + 1;
    store(&mut memory, hostile_id);
    folder
}

fn check_recovered(folder: &Path, mut memory: PerceptualMemory, hostile_id: u64) {
    let first = memory.lease_track_ids(64).unwrap();
    assert!((41..1 << 20).contains(&first), "{first}");
    store(&mut memory, first);
    for track_id in [1, 40, hostile_id, first] {
        assert_eq!(memory.views_of_track(track_id).unwrap().len(), 1);
    }
    drop(memory);
    let found = verify_folder(folder, |_, _| {}).unwrap();
    assert_eq!(found.findings, [""; 0]);
    let (mut memory, report) = PerceptualMemory::open(folder, 3).unwrap();
    assert_eq!(report.condition, Condition::Sound, "{report}");
    assert_eq!(memory.lease_track_ids(1).unwrap(), first + 64);
}

#[test]
fn raised_counter_is_found_and_recovered_at_opening() {
    for hostile_id in [1 << 48, 1 << 60, u64::MAX - 1] {
        let folder = store_with_raised_counter(hostile_id);
        let found = verify_folder(folder.path(), |_, _| {}).unwrap();
        let findings = found.findings.join("; ");
        assert!(findings.contains("the next track-id is"), "{findings}");
        let (memory, report) = PerceptualMemory::open(folder.path(), 2).unwrap();
        assert!(
            matches!(report.condition, Condition::Rebuilt { .. }),
            "{report}"
        );
        assert_eq!(report.loss(), DataLoss::default(), "{report}");
        check_recovered(folder.path(), memory, hostile_id);
    }
}

#[test]
fn raised_counter_is_recovered_by_repair() {
    let hostile_id = u64::MAX - 1;
    let folder = store_with_raised_counter(hostile_id);
    let (memory, report) = PerceptualMemory::open_and_rebuild(folder.path(), 2).unwrap();
    assert_eq!(report.loss(), DataLoss::default(), "{report}");
    check_recovered(folder.path(), memory, hostile_id);
}

#[test]
fn raised_counter_in_the_watermark_of_a_missing_database_is_ignored() {
    let folder = store_with_raised_counter(u64::MAX - 1);
    std::fs::remove_dir_all(folder.path().join("database")).unwrap();
    let (mut memory, report) = PerceptualMemory::open(folder.path(), 2).unwrap();
    assert_eq!(report.loss().n_views, 3, "{report}");
    assert!(memory.lease_track_ids(1).unwrap() < 1 << 20);
}

#[test]
fn lease_beyond_the_last_number_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (mut memory, _) = PerceptualMemory::open(folder.path(), 1).unwrap();
    memory.meta.next_track_id = u64::MAX;
    let refused = memory.lease_track_ids(1).unwrap_err();
    assert!(
        matches!(
            refused,
            crate::Error::Refused(StoreRefusal::TrackIdsExhausted)
        ),
        "{refused}"
    );
}

#[test]
fn recovered_counter_is_above_everything_recorded_and_used() {
    assert_eq!(recovered([65, 9], [3, 40]), 65);
    assert_eq!(recovered([9], [3, 40]), 41);
    assert_eq!(recovered([u64::MAX, 65], [u64::MAX - 1, 3]), 65);
    assert_eq!(recovered([u64::MAX], [3]), 4 + RECOVERY_MARGIN);
    assert_eq!(recovered([0], []), 1 + RECOVERY_MARGIN);
}
