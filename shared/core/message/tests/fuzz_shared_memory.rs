//! Fuzzing of messages in shared memory: any bit pattern is read or refused, never a panic.

use bytemuck::{AnyBitPattern, pod_read_unaligned};
use message::{
    ActorEvent, FrameHeader, Health, ImageHeader, MAX_NEAR_CATEGORIES, ObjectViewHeader,
    PlannedView, SceneObject, SceneSummary, WireCapsule, WirePose, WireTransform,
};
use mutation_fuzzing::fuzz;

/// Fuzzes a message type with corruptions of repeated numbers that are zero, one, a half, NaN and
/// the largest counts.
fn fuzz_messages<T: AnyBitPattern>(read: impl Fn(&T)) {
    let numbers = [
        0_u64,
        1,
        1 << 32 | 1,
        u64::MAX,
        0.5_f64.to_bits(),
        1.0_f64.to_bits(),
        u64::from(1.0_f32.to_bits()) << 32 | u64::from(1.0_f32.to_bits()),
    ];
    let seed = |number: &u64| number.to_le_bytes().repeat(size_of::<T>().div_ceil(8));
    let seeds: Vec<Vec<u8>> = numbers.iter().map(seed).collect();
    fuzz(&seeds, |bytes| {
        let mut whole = bytes.to_vec();
        whole.resize(size_of::<T>(), 0xff);
        read(&pod_read_unaligned(&whole));
    });
}

#[test]
fn fuzz_frame_headers() {
    fuzz_messages(|header: &FrameHeader| {
        for received_ns in [0, 2_000, u64::MAX] {
            if let Ok(frame) = header.checked(640 * 480, received_ns) {
                assert_eq!(frame.camera.width * frame.camera.height, 640 * 480);
                assert!(frame.camera.fx_px.is_finite() && frame.camera.fx_px > 0.0);
            }
        }
    });
}

#[test]
fn fuzz_image_headers() {
    fuzz_messages(|header: &ImageHeader| {
        for n_bytes in [0, 640 * 480 * 5, usize::MAX] {
            if let Ok(images) = header.checked(n_bytes) {
                assert_eq!(images.n_bytes(), n_bytes);
                assert_eq!(images.color_rgb(&[]).len() + images.depth_mm(&[]).len(), 0);
            }
        }
    });
}

#[test]
fn fuzz_poses_and_capsules() {
    fuzz_messages(|pose: &WirePose| {
        if let Some(transform) = pose.checked() {
            assert!(transform.translation.vector.iter().all(|v| v.is_finite()));
        }
    });
    fuzz_messages(|transform: &WireTransform| {
        if let Some(transform) = transform.checked() {
            assert!(transform.translation.vector.iter().all(|v| v.is_finite()));
        }
    });
    fuzz_messages(|capsule: &WireCapsule| {
        if let Some(capsule) = capsule.checked() {
            assert!(capsule.radius_m.is_finite() && capsule.radius_m >= 0.0);
        }
    });
}

#[test]
fn fuzz_scenes_views_and_events() {
    fuzz_messages(|scene: &SceneSummary| {
        for rejected in scene.rejected_candidates() {
            let _ = rejected.verdict();
            assert!(rejected.decisive_findings().count() <= rejected.findings().count());
        }
    });
    fuzz_messages(|object: &SceneObject| {
        let _ = (object.label(), object.view(), object.linked_to());
        assert!(object.categories().count() <= MAX_NEAR_CATEGORIES);
    });
    fuzz_messages(|view: &ObjectViewHeader| {
        assert!(view.categories().count() <= MAX_NEAR_CATEGORIES);
    });
    fuzz_messages(|view: &PlannedView| {
        if let Some(checked) = view.checked() {
            assert!(view.utility >= 0.0 && checked.state.code() == view.state);
        }
    });
    fuzz_messages(|event: &ActorEvent| {
        let _ = (event.kind(), event.frame());
    });
    fuzz_messages(|health: &Health| {
        let _ = message::document::health(health);
    });
}
