//! Allocation test: reads leave nothing in memory.

use allocation_counter::CountingAllocator;
use geometry::OrientedBox;
use learning::ViewId;
use nalgebra::{Isometry3, Vector3};
use perceptual_memory::{
    CapturedView, Mutation, MutationId, PerceptualMemory, Requester, StoreChange, StoredDescriptor,
};

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

const SECOND: u64 = 1_000_000_000;

/// View with a point cloud whose bytes depend on the track.
fn view_with_cloud(track_id: u64, n_bytes: usize) -> CapturedView {
    CapturedView {
        id: ViewId {
            track_id,
            view_id: 0,
        },
        descriptor: StoredDescriptor {
            kind: "test".to_owned(),
            values: vec![0.5; 10],
        },
        box_in_world: OrientedBox {
            frame_from_box: Isometry3::identity(),
            half_sides_m: Vector3::repeat(0.05),
        },
        captured_ns: SECOND,
        frame_sequence: track_id,
        source: "test".to_owned(),
        mean_rgb: None,
        points: Some(vec![track_id as u8; n_bytes]),
    }
}

#[test]
fn read_content_is_not_kept_in_memory() {
    const N_TRACKS: u64 = 200;
    const CLOUD_BYTES: usize = 64_000;
    let folder = tempfile::tempdir().unwrap();
    let (mut memory, _) = PerceptualMemory::open(folder.path(), 1).unwrap();
    for track_id in 1..=N_TRACKS {
        memory.lease_track_ids(1).unwrap();
        let stored = memory.apply(&Mutation {
            id: MutationId(u128::from(track_id)),
            author: "anna".to_owned(),
            requester: Requester::default(),
            wall_ns: track_id,
            change: StoreChange::StoreViews(vec![view_with_cloud(track_id, CLOUD_BYTES)]),
        });
        stored.unwrap();
    }
    memory.close().unwrap();
    let (mut memory, _) = PerceptualMemory::open(folder.path(), 2).unwrap();
    let before = CountingAllocator::live_bytes_of_thread();
    let mut n_read = 0;
    for track_id in 1..=N_TRACKS {
        let views = memory.views_of_track(track_id).unwrap();
        n_read += views[0].view.points.as_ref().unwrap().len();
    }
    assert_eq!(n_read, N_TRACKS as usize * CLOUD_BYTES);
    let kept = CountingAllocator::live_bytes_of_thread() - before;
    assert!(kept < n_read as i64 / 5, "{kept} of {n_read} bytes kept");
}
