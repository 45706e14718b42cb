use super::*;
use crate::{
    ActorEvent, ActorStamps, Health, NearCategory, ObjectViewHeader, SceneTime, SurfaceKind, Text,
    TrackState, WireSurface,
};
use bytemuck::AnyBitPattern;

/// Messages with arbitrary bytes, as torn or hostile shared memory may hold them.
fn of_any_bytes<T: AnyBitPattern>() -> impl Iterator<Item = T> {
    let mut state = 1_u64;
    let mut random = move || {
        // Knuth's linear congruential generator; its upper bits are good enough.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    };
    let of = |bytes: &[u8]| bytemuck::pod_read_unaligned(bytes);
    let mut bytes = vec![0_u8; size_of::<T>()];
    let constant = [0, 1, 0x7f, 0x80, 0xff].map(|byte| of(&vec![byte; size_of::<T>()]));
    let any = std::iter::repeat_with(move || {
        bytes.fill_with(&mut random);
        of(&bytes)
    });
    constant.into_iter().chain(any.take(2_000))
}

/// Scene that was captured at the beginning of the clock, with a limit of a second.
fn now() -> SceneTime {
    SceneTime {
        capture_ns: 0,
        received_ns: 0,
        stale_after_ns: 1_000_000_000,
        is_lockstep: false,
    }
}

#[test]
fn stale_scene_is_told_with_its_age_and_its_objects_are_stale() {
    const SECOND: u64 = 1_000_000_000;
    let mut scene = SceneSummary {
        stale_after_ns: SECOND,
        ..SceneSummary::default()
    };
    scene.stamps.capture_ns = 10 * SECOND;
    let object = SceneObject {
        state: TrackState::Tracked.code(),
        first_seen_ns: 4 * SECOND,
        last_seen_ns: 9 * SECOND,
        ..SceneObject::default()
    };
    let report = |now_s: u64| super::scene(&scene, &[object], now_s * SECOND);
    let fresh = report(11);
    assert!(!fresh.is_stale && fresh.note.is_empty());
    assert_eq!(fresh.objects[0].state, "tracked");
    assert_eq!(
        (fresh.objects[0].age_s, fresh.objects[0].unseen_s),
        (6.0, 2.0)
    );
    let stale = report(15);
    assert!(
        stale.is_stale && stale.note.contains("for 5.0 s"),
        "{}",
        stale.note
    );
    assert_eq!(stale.scene_age_s, Some(5.0));
    assert_eq!(stale.capture_stamp_ns, Some(10 * SECOND));
    let object = &stale.objects[0];
    assert_eq!((object.state.as_str(), object.unseen_s), ("stale", 6.0));
    assert_eq!((object.scene_age_s, object.age_s), (Some(5.0), 6.0));
}

#[test]
fn arbitrary_objects_are_reported() {
    for object in of_any_bytes::<SceneObject>() {
        let report = super::object(&object, now(), u64::MAX);
        assert!(report.categories.len() <= crate::MAX_NEAR_CATEGORIES);
        assert!(report.view.is_none() == (report.n_views == 0));
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let far = report.categories.iter().map(|near| near.distance);
        assert!(finite(&far.collect::<Vec<_>>()));
        for velocity in [report.velocity_m_s, report.angular_velocity_rad_s] {
            assert!(velocity.is_none_or(|velocity| finite(&velocity)));
        }
        if let Some(covariance) = report.covariance {
            assert!(finite(&covariance.position_m2) && finite(&covariance.rotation_rad2));
        }
    }
}

#[test]
fn arbitrary_views_events_and_health_are_read() {
    for view in of_any_bytes::<ObjectViewHeader>() {
        let distances = view.categories().map(|(_, distance, _)| distance);
        assert!(distances.into_iter().all(f32::is_finite));
    }
    for event in of_any_bytes::<ActorEvent>() {
        assert_eq!(event.frame().is_some(), event.has_frame == 1);
        let known = event.kind().map(crate::ActorEventKind::code);
        assert!(known.is_none_or(|code| code == event.kind));
        assert!(
            event
                .cause
                .as_str()
                .is_none_or(|cause| cause.len() <= Text::CAPACITY)
        );
    }
    for health in of_any_bytes::<Health>() {
        let report = super::health(&health);
        assert!(report.is_none_or(|report| report.note.len() <= Text::CAPACITY));
    }
}

#[test]
fn covariance_and_nearest_categories_are_reported() {
    let mut object = SceneObject {
        n_views: 8,
        view_id: 7,
        is_key_view: 1,
        n_key_views: 2,
        n_categories: 2,
        position_covariance_m2: [1e-6, 0.0, 0.0, 1e-6, 0.0, 4e-6],
        rotation_covariance_rad2: [0.01; 6],
        velocity_m_s: [0.5, 0.0, -0.25],
        stamps: ActorStamps {
            asked_ns: 5,
            ..ActorStamps::default()
        },
        ..SceneObject::default()
    };
    for (place, (name, distance)) in
        object
            .categories
            .iter_mut()
            .zip([("mug", 0.25), ("bowl", 0.5), ("forgotten", 0.6)])
    {
        *place = NearCategory {
            label: Text::truncated(name),
            distance,
            probability: 0.5,
        };
    }
    let report = super::object(&object, now(), 0);
    let near: Vec<_> = report
        .categories
        .iter()
        .map(|near| (near.label.as_str(), near.distance))
        .collect();
    assert_eq!(near, [("mug", 0.25), ("bowl", 0.5)]);
    assert_eq!((report.view, report.n_key_views), (Some(7), 2));
    assert!(report.is_key_view && report.linked_to.is_none());
    assert_eq!(report.velocity_m_s, Some([0.5, 0.0, -0.25]));
    assert_eq!(
        report.covariance.unwrap().position_m2[5],
        f64::from(4e-6_f32)
    );
    assert_eq!(report.stamps.asked_ns, Some(5));
    assert_eq!(report.stamps.begun_ns, None);
}

/// Level surface of a kind at a height, world frame.
fn level_surface(kind: SurfaceKind, height_m: f64) -> WireSurface {
    WireSurface {
        plane: [0.0, 0.0, 1.0, -height_m],
        kind: kind.code(),
        ..WireSurface::default()
    }
}

#[test]
fn objects_are_listed_with_the_highest_surface_under_them() {
    let object = |track_id: u64, centre_m: f64| {
        let mut object = SceneObject {
            track_id,
            size_m: [0.1; 3],
            ..SceneObject::default()
        };
        object.pose.orientation_xyzw = [0.0, 0.0, 0.0, 1.0];
        object.pose.position_m = [0.3, 0.1, centre_m];
        object
    };
    let mut scene = SceneSummary {
        n_surfaces: 3,
        ..SceneSummary::default()
    };
    scene.surfaces[0] = level_surface(SurfaceKind::Table, 0.7);
    scene.surfaces[1] = level_surface(SurfaceKind::Level, 1.0);
    scene.surfaces[2] = level_surface(SurfaceKind::Floor, 0.0);
    // On the table, on another object there, on the level, and beside both on the floor.
    let objects = [(1, 0.75), (2, 0.85), (3, 1.04), (4, 0.05)];
    let objects = objects.map(|(track_id, centre_m)| object(track_id, centre_m));
    let surfaces = super::scene(&scene, &objects, 0).surfaces;
    let listed = surfaces
        .iter()
        .map(|one| (one.kind.as_str(), one.track_ids.as_slice()));
    let truth: [(&str, &[u64]); 3] = [("table", &[1, 2]), ("level", &[3]), ("floor", &[])];
    assert!(listed.eq(truth), "{surfaces:?}");
}

#[test]
fn arbitrary_surfaces_are_reported_without_a_panic() {
    for summary in of_any_bytes::<SceneSummary>() {
        let surfaces = scene(&summary, &[], 0).surfaces;
        assert!(surfaces.len() <= crate::MAX_SURFACES);
        let places = surfaces
            .iter()
            .flat_map(|one| one.outline_m.iter().flatten());
        assert!(places.into_iter().all(|value| value.is_finite()));
    }
}
