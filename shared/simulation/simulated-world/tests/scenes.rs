//! Tests of the seeded scene generators.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a failing set-up must fail the test"
)]

use simulated_world::{
    Error, ModelChoice, ModelLibrary, ObjectModel, ObjectPlacement, ObjectState, Scene, SceneKind,
    World, category_names,
};
use std::path::Path;

/// Least gap between isolated objects, metres.
const GAP_M: f64 = 0.03;
/// Greatest distance that an object may slide or roll before it rests, metres.
const SLID_MAX_M: f64 = 0.04;
/// Least height over the table at which an object rests on another, metres.
const RAISED_M: f64 = 0.003;
/// Greatest distance of a pile's object from its nearest neighbour, metres.
const TOUCHING_M: f64 = 0.015;

fn generated(kind: SceneKind, n_objects: usize, seed: u64) -> Scene {
    Scene::generate(kind, n_objects, seed, &mut ModelLibrary::generated()).unwrap()
}

fn world(scene: Scene) -> World {
    World::new(scene, ModelLibrary::generated()).unwrap()
}

/// Footprint radius and planned position of each object.
fn footprints(scene: &Scene) -> Vec<(f64, [f64; 2])> {
    let mut library = ModelLibrary::generated();
    let footprint = |plan: &simulated_world::ObjectPlan| {
        let model = library.load(&plan.model).unwrap();
        let ObjectPlacement::Upright { position_m, .. } = plan.placement else {
            panic!("{plan:?} is not put down");
        };
        (model.footprint_radius_m(), position_m)
    };
    scene.objects.iter().map(footprint).collect()
}

#[test]
fn generated_scene_has_the_requested_number_of_objects() {
    for kind in SceneKind::ALL {
        for seed in 0..5 {
            for n in [0, 1, kind.default_n_objects()] {
                let scene = generated(kind, n, seed);
                assert_eq!(scene.objects.len(), n, "{} {seed}", kind.word());
                assert_eq!(scene.bin.is_some(), kind == SceneKind::Bin);
                assert_eq!(scene.shelf.is_some(), kind == SceneKind::Shelf);
                assert_eq!(scene.tray.is_some(), kind == SceneKind::Tray);
            }
        }
    }
}

#[test]
fn isolated_scene_keeps_the_given_order_and_rejects_too_many_objects() {
    let named = |names: &[&str]| -> Vec<ModelChoice> {
        let choice = |name: &&str| ModelChoice::Generated {
            category: (*name).to_owned(),
            instance: 3,
        };
        names.iter().map(choice).collect()
    };
    let names = ["mug", "cereal-box", "spoon"];
    let lay = |seed| Scene::isolated(named(&names), seed, &mut ModelLibrary::generated());
    let scene = lay(8).unwrap();
    let laid: Vec<String> = scene.objects.iter().map(|p| p.model.category()).collect();
    assert_eq!(laid, names);
    let placed = footprints(&scene);
    for (i, (radius_m, [x, y])) in placed.iter().enumerate() {
        for (other_m, [other_x, other_y]) in &placed[..i] {
            let gap_m = (x - other_x).hypot(y - other_y) - radius_m - other_m;
            assert!(gap_m > GAP_M, "{gap_m} m");
        }
    }
    assert_eq!(scene.objects, lay(8).unwrap().objects);
    assert_ne!(scene.objects, lay(9).unwrap().objects);
    let crowd = vec!["pot"; 40];
    let refused = Scene::isolated(named(&crowd), 8, &mut ModelLibrary::generated());
    assert!(matches!(refused, Err(Error::NoRoom { n_objects: 40, .. })));
}

#[test]
fn generated_scene_beyond_the_object_limit_is_rejected() {
    for kind in SceneKind::ALL {
        let refused = Scene::generate(kind, 61, 1, &mut ModelLibrary::generated());
        let sentence = refused.unwrap_err().to_string();
        assert!(sentence.contains("at most 60"), "{sentence}");
    }
}

#[test]
fn generated_scene_uses_each_category_before_repeating_one() {
    let n = category_names().len().min(60);
    let scene = generated(SceneKind::Pile, n, 3);
    let mut categories: Vec<_> = scene.objects.iter().map(|o| o.model.category()).collect();
    categories.sort_unstable();
    categories.dedup();
    assert_eq!(categories.len(), n);
}

#[test]
fn generated_scene_is_determined_by_its_seed() {
    for kind in SceneKind::ALL {
        let n = kind.default_n_objects();
        let objects = |seed| generated(kind, n, seed).objects;
        for seed in 0..4 {
            assert_eq!(objects(seed), objects(seed), "{}", kind.word());
            assert_ne!(objects(seed), objects(seed + 1), "{}", kind.word());
        }
    }
}

#[test]
fn isolated_objects_keep_their_gap_and_stay_on_the_table() {
    for seed in 0..40 {
        let scene = generated(SceneKind::Isolated, 6, seed);
        let footprints = footprints(&scene);
        for (i, (radius_m, [x, y])) in footprints.iter().enumerate() {
            let [half_x, half_y] = scene.table.size_m.map(|side| side / 2.0);
            assert!(x.abs() + radius_m <= half_x && y.abs() + radius_m <= half_y);
            for (other_radius_m, [other_x, other_y]) in &footprints[..i] {
                let gap_m = (x - other_x).hypot(y - other_y) - radius_m - other_radius_m;
                assert!(gap_m >= GAP_M, "seed {seed}: {gap_m} m");
            }
        }
    }
}

#[test]
fn isolated_objects_rest_where_they_were_planned() {
    for seed in 0..4 {
        let mut world = world(generated(SceneKind::Isolated, 6, seed));
        assert_eq!(world.take_notes(), Vec::<String>::new(), "seed {seed}");
        for (object, plan) in world.objects().iter().zip(&world.scene().objects) {
            let ObjectPlacement::Upright { position_m, .. } = plan.placement else {
                panic!("{plan:?} is not put down");
            };
            let at = object.world_from_object.translation;
            let slid_m = (at.x - position_m[0]).hypot(at.y - position_m[1]);
            assert!(slid_m < SLID_MAX_M, "{} {slid_m} m", object.model.name);
            assert_eq!(object.state, ObjectState::Settled, "{}", object.model.name);
        }
    }
}

#[test]
fn isolated_scene_of_sixty_objects_does_not_fit_a_small_table() {
    let text = "kind = \"isolated\"\nobjects = 60\n[table]\nsize_m = [0.6, 0.5]";
    match Scene::from_toml(text, Path::new(""), None) {
        Err(error @ Error::NoRoom { n_placed, .. }) => {
            assert!(n_placed < 60);
            let sentence = error.to_string();
            assert!(
                sentence.contains(&format!("{n_placed} of 60")),
                "{sentence}"
            );
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn bin_scene_keeps_nearly_all_objects_and_reports_fallen_ones() {
    let (mut n_inside, mut n_objects) = (0, 0);
    for seed in 0..3 {
        let mut world = world(generated(SceneKind::Bin, 20, seed));
        let notes = world.take_notes().join("\n");
        let [x, y, _] = world.scene().bin.unwrap().inner_size_m;
        let table_m = world.scene().table.height_m;
        for object in world.objects() {
            let at = object.world_from_object.translation;
            let is_inside = at.x.abs() < x / 2.0 && at.y.abs() < y / 2.0 && at.z > table_m;
            n_inside += usize::from(is_inside);
            n_objects += 1;
            let is_told = notes.contains(&format!("(object {}) fell off the table", object.id));
            assert_eq!(is_told, object.state == ObjectState::OnFloor, "{notes}");
        }
    }
    assert!(10 * n_inside >= 9 * n_objects, "{n_inside} of {n_objects}");
}

/// Every tenth vertex of an object, world frame.
fn points(object: &simulated_world::SimulatedObject) -> Vec<nalgebra::Point3<f64>> {
    let vertices = object.model.mesh.vertices.iter().step_by(10);
    vertices
        .map(|v| object.world_from_object * v.position.cast::<f64>())
        .collect()
}

#[test]
fn pile_scene_objects_are_close_to_each_other() {
    let (mut n_close, mut n_objects) = (0, 0);
    for seed in 0..4 {
        let world = world(generated(SceneKind::Pile, 8, seed));
        let clouds: Vec<_> = world.objects().iter().map(points).collect();
        for (i, cloud) in clouds.iter().enumerate() {
            let others = clouds.iter().enumerate().filter(|(k, _)| *k != i);
            let mut others = others.flat_map(|(_, other)| other);
            let is_close = others.any(|p| cloud.iter().any(|q| (p - q).norm() < TOUCHING_M));
            n_close += usize::from(is_close);
            n_objects += 1;
        }
    }
    assert!(4 * n_close >= 3 * n_objects, "{n_close} of {n_objects}");
}

/// Lowest point of an object over the table, metres.
fn height_over_table_m(object: &simulated_world::SimulatedObject, scene: &Scene) -> f64 {
    let vertices = object.model.mesh.vertices.iter();
    let heights = vertices.map(|v| (object.world_from_object * v.position.cast::<f64>()).z);
    heights.fold(f64::MAX, f64::min) - scene.table.height_m
}

#[test]
fn clutter_scene_stays_on_the_table_and_many_objects_rest_on_others() {
    let (mut n_at_rest, mut n_on_others, mut n_objects) = (0, 0, 0);
    for seed in 0..8 {
        let world = world(generated(SceneKind::Clutter, 20, seed));
        for object in world.objects() {
            let is_at_rest = object.state == ObjectState::Settled;
            n_at_rest += usize::from(is_at_rest);
            let height_m = height_over_table_m(object, world.scene());
            n_on_others += usize::from(is_at_rest && height_m > RAISED_M);
            n_objects += 1;
        }
    }
    assert_eq!(n_objects, 160);
    assert!(10 * n_at_rest >= 9 * n_objects, "{n_at_rest} at rest");
    assert!(4 * n_on_others >= n_objects, "{n_on_others} on others");
}

#[test]
fn clutter_scene_draws_table_and_camera_from_the_seed() {
    let mut finishes = Vec::new();
    for seed in 0..40 {
        let scene = generated(SceneKind::Clutter, 3, seed);
        let again = generated(SceneKind::Clutter, 3, seed);
        assert_eq!(scene.camera, again.camera);
        assert_eq!(scene.table, again.table);
        assert_eq!(scene.table_finish, again.table_finish);
        assert!((0.8..=2.0).contains(&scene.camera.distance_m));
        assert!((25.0..=60.0).contains(&scene.camera.elevation_deg));
        let [x, y, _] = scene.camera.look_at_m;
        let [half_x, half_y] = scene.table.size_m.map(|side| side / 2.0);
        assert!(x.abs() < half_x + 0.1 && y.abs() < half_y + 0.1, "{seed}");
        if !finishes.contains(&scene.table_finish) {
            finishes.push(scene.table_finish);
        }
    }
    assert!(finishes.len() > 20, "{} finishes", finishes.len());
}

#[test]
fn clutter_scene_file_keeps_its_own_table_and_camera() {
    let text = "kind = \"clutter\"\nobjects = 4\n[table]\nsize_m = [1.0, 0.9]\n\
                [camera]\ndistance_m = 1.3";
    let (scene, _) = Scene::from_toml(text, Path::new(""), Some(6)).unwrap();
    let drawn = generated(SceneKind::Clutter, 4, 6);
    assert_eq!(scene.table.size_m, [1.0, 0.9]);
    assert!((scene.camera.distance_m - 1.3).abs() < 1e-12);
    assert_eq!(scene.table_finish, drawn.table_finish);
    let text = "kind = \"clutter\"\nobjects = 4";
    let (scene, _) = Scene::from_toml(text, Path::new(""), Some(6)).unwrap();
    assert_eq!(scene.objects, drawn.objects);
    assert_eq!((scene.table, scene.camera), (drawn.table, drawn.camera));
}

#[test]
fn set_table_has_complete_matching_place_settings() {
    for seed in 0..4 {
        let scene = generated(SceneKind::SetTable, 14, seed);
        let mut library = ModelLibrary::generated();
        let models: Vec<std::sync::Arc<ObjectModel>> = scene
            .objects
            .iter()
            .map(|plan| library.load(&plan.model).unwrap())
            .collect();
        for category in ["plate", "fork", "knife", "spoon", "mug"] {
            let mut names = models.iter().filter(|m| m.category == category);
            let first = names.next().unwrap();
            let others: Vec<_> = names.collect();
            assert_eq!(others.len(), 1, "{category}");
            assert!(others.iter().all(|m| m.name == first.name));
        }
        for category in ["vase", "bottle", "salt-shaker", "bowl"] {
            let n = models.iter().filter(|m| m.category == category).count();
            assert_eq!(n, 1, "{category}");
        }
        for (plan, (_, [x, y])) in scene.objects.iter().zip(footprints(&scene)) {
            let [half_x, half_y] = scene.table.size_m.map(|side| side / 2.0);
            assert!(x.abs() < half_x && y.abs() < half_y, "{plan:?}");
        }
    }
}

#[test]
fn set_table_comes_to_rest_with_forks_left_of_plates() {
    let world = world(generated(SceneKind::SetTable, 14, 2));
    let at = |category: &str, index: usize| {
        let mut found = world
            .objects()
            .iter()
            .filter(|o| o.model.category == category);
        let object = found.nth(index).unwrap();
        assert_eq!(object.state, ObjectState::Settled, "{}", object.model.name);
        object.world_from_object.translation
    };
    // The first two place settings are on the near side.
    for seat in 0..2 {
        let (fork, plate, knife) = (at("fork", seat), at("plate", seat), at("knife", seat));
        assert!(fork.x < plate.x && plate.x < knife.x);
        assert!((fork.y - plate.y).abs() < 0.05);
    }
}
