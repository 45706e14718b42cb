//! Tests of the simulated person: scripted actions, and capsules that cover the rendered body.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a failing set-up must fail the test"
)]

use geometry::PinholeCamera;
use nalgebra::Point3;
use point_cloud::Point;
use rendering::kinect::SensorModel;
use simulated_world::{
    Action, ModelChoice, ModelLibrary, ObjectPlacement, ObjectPlan, ObjectState, PERSON_ID,
    PersonPlan, Scene, SimulatedKinect, TimedAction, World,
};

/// Greatest distance of an object from its target position, metres.
const GOAL_M: f64 = 0.02;
/// Step limit for an action of the person.
const MOST_STEPS: usize = 3000;

fn model(category: &str) -> ModelChoice {
    ModelChoice::Generated {
        category: category.to_owned(),
        instance: 1,
    }
}

fn upright(category: &str, position_m: [f64; 2]) -> ObjectPlan {
    ObjectPlan {
        model: model(category),
        placement: ObjectPlacement::Upright {
            position_m,
            yaw_rad: 0.0,
            raised_m: 0.0,
        },
    }
}

/// World with three objects and a person who performs one action after half a second.
fn world(action: Action) -> World {
    let scene = Scene {
        objects: vec![
            upright("soda-can", [0.22, -0.05]),
            upright("juice-box", [-0.25, -0.12]),
            upright("mug", [-0.10, 0.12]),
        ],
        person: Some(PersonPlan {
            script: vec![TimedAction { at_s: 0.5, action }],
            ..PersonPlan::default()
        }),
        sensor: SensorModel::PERFECT,
        ..Scene::default()
    };
    World::new(scene, ModelLibrary::generated()).unwrap()
}

/// Steps until the action is finished and a second has passed; calls `look` at each step.
fn run(world: &mut World, mut look: impl FnMut(&World)) {
    let mut has_begun = false;
    for _ in 0..MOST_STEPS {
        world.step();
        look(world);
        has_begun |= world.is_person_busy();
        if has_begun && !world.is_person_busy() {
            for _ in 0..120 {
                world.step();
            }
            return;
        }
    }
    panic!("the person does not end; begun: {has_begun}");
}

fn position(world: &World, id: u16) -> Point3<f64> {
    let object = world.find(id).unwrap();
    object.world_from_object.translation.vector.into()
}

fn assert_settled_at(world: &World, id: u16, goal: [f64; 2]) {
    let object = world.find(id).unwrap();
    let at = position(world, id);
    let miss_m = (at.x - goal[0]).hypot(at.y - goal[1]);
    assert!(miss_m < GOAL_M, "{} is {miss_m} m off", object.model.name);
    assert_eq!(object.state, ObjectState::Settled);
    let height_m = at.z - world.scene().table.height_m;
    assert!((height_m - object.model.half_sides_m.z).abs() < 0.005);
}

#[test]
fn move_action_places_the_object_at_its_target_and_leaves_the_others() {
    let mut world = world(Action::Move {
        object: 1,
        to_m: [0.05, -0.2],
    });
    let before = [2, 3].map(|id| position(&world, id));
    let mut was_held = false;
    run(&mut world, |world| {
        was_held |= world.find(1).unwrap().state == ObjectState::HeldByPerson;
    });
    assert!(was_held);
    assert_settled_at(&world, 1, [0.05, -0.2]);
    for (id, before) in [2, 3].into_iter().zip(before) {
        assert!((position(&world, id) - before).norm() < 1e-3);
    }
}

#[test]
fn slide_action_stays_on_the_table_and_pushes_other_objects() {
    // The mug is nearer to its target than a can and a mug are wide.
    let mut world = world(Action::Slide {
        object: 1,
        to_m: [-0.04, 0.12],
    });
    let before = position(&world, 3);
    let table_m = world.scene().table.height_m;
    let mut highest_m: f64 = 0.0;
    run(&mut world, |world| {
        let can = world.find(1).unwrap();
        highest_m = highest_m.max(position(world, 1).z - table_m - can.model.half_sides_m.z);
    });
    assert!(highest_m < 0.005, "{highest_m}");
    assert_settled_at(&world, 1, [-0.04, 0.12]);
    assert!((position(&world, 3) - before).norm() > 0.01);
    let box_m = position(&world, 2);
    assert!((box_m.x + 0.25).hypot(box_m.y + 0.12) < 1e-3);
}

#[test]
fn person_pace_shortens_actions() {
    let n_steps = |pace: f64| {
        let script = vec![TimedAction {
            at_s: 0.0,
            action: Action::Lift {
                object: 1,
                for_s: 0.0,
            },
        }];
        let scene = Scene {
            objects: vec![upright("soda-can", [0.22, -0.05])],
            person: Some(PersonPlan {
                script,
                pace,
                ..PersonPlan::default()
            }),
            ..Scene::default()
        };
        let mut world = World::new(scene, ModelLibrary::generated()).unwrap();
        let mut n_steps = 0;
        run(&mut world, |_| n_steps += 1);
        f64::from(n_steps)
    };
    // The waiting times of the fingers do not depend on the pace.
    let ratio = n_steps(1.0) / n_steps(2.0);
    assert!((1.8..2.0).contains(&ratio), "{ratio}");
}

#[test]
fn lift_action_raises_the_object_and_puts_it_back() {
    let mut world = world(Action::Lift {
        object: 3,
        for_s: 0.5,
    });
    let before = position(&world, 3);
    let mut highest_m = 0.0_f64;
    run(&mut world, |world| {
        highest_m = highest_m.max(position(world, 3).z);
    });
    assert!(highest_m - before.z >= 0.10, "{highest_m}");
    assert_settled_at(&world, 3, [before.x, before.y]);
}

#[test]
fn turn_action_turns_the_object_in_its_place() {
    let mut world = world(Action::Turn {
        object: 3,
        by_rad: -0.5,
    });
    let before = world.find(3).unwrap().world_from_object;
    run(&mut world, |_| {});
    let after = world.find(3).unwrap().world_from_object;
    let turn = (after.rotation * before.rotation.inverse()).scaled_axis();
    assert!(
        (turn - nalgebra::Vector3::z() * -0.5).norm() < 0.02,
        "{turn}"
    );
    let place = before.translation.vector;
    assert_settled_at(&world, 3, [place.x, place.y]);
}

#[test]
fn remove_action_takes_the_object_and_its_number_is_not_reused() {
    let mut world = world(Action::Remove { object: 2 });
    run(&mut world, |_| {});
    assert!(world.find(2).is_none());
    let ids: Vec<u16> = world.objects().iter().map(|object| object.id).collect();
    assert_eq!(ids, [1, 3]);
}

#[test]
fn put_action_brings_an_object_that_settles() {
    let mut world = world(Action::Put {
        model: model("tin-can"),
        to_m: [0.1, 0.2],
    });
    run(&mut world, |_| {});
    let new = world.find(4).unwrap();
    assert_eq!(new.model.category, "tin-can");
    assert_settled_at(&world, 4, [0.1, 0.2]);
}

#[test]
fn impossible_action_changes_nothing() {
    let mut world = world(Action::Remove { object: 77 });
    for _ in 0..400 {
        world.step();
        assert!(!world.is_person_busy());
    }
    assert_eq!(world.objects().len(), 3);
}

/// Simulated camera with its point buffer.
struct CameraProbe {
    kinect: SimulatedKinect,
    points: Vec<Point>,
}

impl CameraProbe {
    fn new(world: &World) -> Self {
        let camera = PinholeCamera::KINECT_V1;
        Self {
            kinect: SimulatedKinect::new(world, camera).unwrap(),
            points: vec![Point::default(); camera.n_pixels()],
        }
    }

    fn fractions(&mut self, world: &World) -> Vec<f64> {
        let truth = self.kinect.look(world, 0, &mut self.points).unwrap();
        truth
            .iter()
            .map(simulated_world::ObjectTruth::visible_fraction)
            .collect()
    }
}

#[test]
fn hide_action_occludes_only_its_object() {
    let mut world = world(Action::Hide {
        object: 1,
        for_s: 1.0,
    });
    let mut eye = CameraProbe::new(&world);
    let before = eye.fractions(&world);
    assert!(before.iter().all(|fraction| *fraction > 0.95), "{before:?}");
    let mut least = before.clone();
    let mut n_steps = 0;
    run(&mut world, |world| {
        n_steps += 1;
        if n_steps % 15 == 0 {
            let seen = eye.fractions(world);
            least = least.iter().zip(seen).map(|(a, b)| a.min(b)).collect();
        }
    });
    assert!(least[0] < 0.6 * before[0], "{least:?}");
    assert!(least[1] > 0.9 && least[2] > 0.9, "{least:?}");
    let after = eye.fractions(&world);
    assert!(after[0] > 0.95 * before[0], "{after:?}");
}

/// Greatest distance of rendered points of a person at work from the nearest capsule, metres: for
/// trunk, legs and hand, and for head and arm.
fn farthest_outside_m() -> [f64; 2] {
    let mut world = world(Action::Move {
        object: 1,
        to_m: [-0.1, -0.15],
    });
    let mut eye = CameraProbe::new(&world);
    let (mut n_steps, mut n_seen, mut farthest_m) = (0, [0; 2], [0.0_f64; 2]);
    run(&mut world, |world| {
        n_steps += 1;
        if n_steps % 60 != 0 {
            return;
        }
        eye.fractions(world);
        let capsules = world.person_capsules();
        let world_from_camera = world.world_from_camera();
        for (point, id) in eye.points.iter().zip(eye.kinect.mask()) {
            if *id == PERSON_ID && point.is_finite() {
                let at = world_from_camera * point.position();
                let distances = capsules.iter().map(|capsule| capsule.distance_m(&at));
                let (nearest, distance_m) = distances
                    .enumerate()
                    .min_by(|a, b| a.1.total_cmp(&b.1))
                    .unwrap();
                let limb = usize::from((1..4).contains(&nearest));
                farthest_m[limb] = farthest_m[limb].max(distance_m);
                n_seen[limb] += 1;
            }
        }
    });
    assert!(n_seen.iter().all(|n| *n > 3000), "{n_seen:?}");
    farthest_m
}

#[test]
fn person_capsules_cover_the_rendered_head_and_arm() {
    let [_, farthest_m] = farthest_outside_m();
    assert!(farthest_m < 0.02, "{farthest_m} m outside of the capsules");
}

#[test]
fn person_capsules_cover_the_rendered_trunk_legs_and_hand() {
    let [farthest_m, _] = farthest_outside_m();
    assert!(farthest_m < 0.02, "{farthest_m} m outside of the capsules");
}
