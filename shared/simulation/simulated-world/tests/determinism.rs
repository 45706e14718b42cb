//! Determinism tests: the same scene, seed and commands give the same bytes.

#![expect(clippy::unwrap_used, reason = "a failing set-up must fail the test")]

use geometry::{PinholeCamera, RigidTransform};
use point_cloud::Point;
use simulated_world::{
    Action, ArmCommand, ModelLibrary, PersonPlan, Scene, SceneKind, SimulatedKinect, TimedAction,
    World,
};

fn bits(pose: &RigidTransform) -> [u64; 7] {
    let (t, r) = (pose.translation, pose.rotation.coords);
    [t.x, t.y, t.z, r.x, r.y, r.z, r.w].map(f64::to_bits)
}

fn poses(world: &World) -> Vec<(u16, [u64; 7])> {
    let objects = world.objects().iter();
    objects
        .map(|object| (object.id, bits(&object.world_from_object)))
        .collect()
}

/// World with a pile, an arm and a busy person.
fn busy_world() -> World {
    let mut library = ModelLibrary::generated();
    let mut scene = Scene::generate(SceneKind::Pile, 5, 7, &mut library).unwrap();
    scene.arm = Some(simulated_world::ArmMount::default());
    scene.person = Some(PersonPlan {
        script: vec![TimedAction {
            at_s: 0.2,
            action: Action::Move {
                object: 2,
                to_m: [0.3, 0.1],
            },
        }],
        random_pause_s: Some([0.5, 1.5]),
        ..PersonPlan::default()
    });
    World::new(scene, library).unwrap()
}

fn command(world: &mut World) {
    let mut angles_rad = world.arm_status().unwrap().joint_angles_rad;
    angles_rad[0] += 0.5;
    angles_rad[5] -= 1.0;
    world
        .command_arm(&ArmCommand::MoveJoints(angles_rad))
        .unwrap();
}

fn run(world: &mut World, n_steps: usize) {
    for _ in 0..n_steps {
        world.step();
    }
}

fn look(world: &World) -> (Vec<[u32; 4]>, Vec<u16>) {
    let camera = PinholeCamera::KINECT_V1;
    let mut kinect = SimulatedKinect::new(world, camera).unwrap();
    let mut points = vec![Point::default(); camera.n_pixels()];
    kinect.look(world, 9, &mut points).unwrap();
    let bits = |p: &Point| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), p.color.0];
    (points.iter().map(bits).collect(), kinect.mask().to_vec())
}

#[test]
fn worlds_of_one_scene_evolve_identically_to_the_bit() {
    let worlds = [(); 2].map(|()| {
        let mut world = busy_world();
        command(&mut world);
        run(&mut world, 300);
        world
    });
    let [first, second] = &worlds;
    assert_eq!(poses(first), poses(second));
    assert_eq!(first.arm_status(), second.arm_status());
    assert_eq!(first.person_capsules(), second.person_capsules());
    let [(points, mask), (other_points, other_mask)] = [look(first), look(second)];
    assert!(points == other_points, "the points differ");
    assert!(mask == other_mask, "the masks differ");
}

#[test]
fn world_clone_evolves_as_the_original() {
    let mut world = busy_world();
    command(&mut world);
    run(&mut world, 90);
    assert!(world.is_person_busy());
    assert_eq!(
        world.arm_status().unwrap().motion,
        simulated_world::MotionState::Moving
    );
    let mut copy = world.clone();
    for step in 0..600 {
        world.step();
        copy.step();
        assert_eq!(poses(&world), poses(&copy), "step {step}");
        assert_eq!(world.arm_status(), copy.arm_status(), "step {step}");
        assert_eq!(
            world.person_capsules(),
            copy.person_capsules(),
            "step {step}"
        );
    }
    assert_eq!(world.take_notes(), copy.take_notes());
}

#[test]
fn sensor_noise_depends_on_the_seed() {
    let scene = |seed| Scene {
        seed,
        ..Scene::default()
    };
    let seen = [1, 2].map(|seed| {
        let world = World::new(scene(seed), ModelLibrary::generated()).unwrap();
        look(&world)
    });
    assert!(seen[0].0 != seen[1].0, "the noise is the same");
    assert!(seen[0].1 == seen[1].1, "what is seen differs");
}
