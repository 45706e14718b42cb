//! Transits and places among solids whose true distance is known.

#[path = "../../grasping/tests/solid_scene/mod.rs"]
mod solid_scene;

use arm_kinematics::{Arm, HOME, JointVector, link_capsules};
use geometry::{Capsule, ConvexPolygon, OrientedBox, RigidTransform};
use grasping::{
    ContactPoint, Grasp, GraspPlanner, GraspScene, GraspSettings, N_BASE_CAPSULES, Obstacle,
    Obstacles, PlacedArm, contact_surface,
};
use nalgebra::{Point2, Point3, Translation3, UnitQuaternion, Vector3};
use solid_scene::{Solid, SolidScene};
use transport::{
    ArmObstacle, GraspedObject, NoTransit, NoTransport, PlaceArea, PlacingPlanner, RELEASE_M,
    TransitKind, TransitPath, TransitPlanner, Transport, TransportPlanner,
};

/// Region of the arm in the tests.
const REGION: [Point3<f64>; 2] = [Point3::new(-1.5, -1.5, -0.2), Point3::new(1.0, 1.0, 1.2)];
/// Depth to which a link may enter a solid, metres: links are bounded by capsules.
const DEPTH_MAX_M: f64 = 0.002;

fn arm() -> PlacedArm {
    PlacedArm {
        arm: Arm::jaco_like(),
        plan_from_base: RigidTransform::translation(-0.55, -0.1, 0.0),
        joints_rad: JointVector::from(HOME),
    }
}

fn cuboid(x: f64, y: f64, sides_m: [f64; 3]) -> Solid {
    let middle = Point3::new(x, y, sides_m[2] / 2.0);
    Solid::Box(middle, Vector3::from(sides_m) / 2.0, 0.0)
}

/// Joint angles with the tool pointing down at a place.
fn tool_down_at(placed: &PlacedArm, x: f64, y: f64, z: f64) -> JointVector {
    let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let pose = RigidTransform::from_parts(Translation3::new(x, y, z), down);
    let base_from_tool = placed.plan_from_base.inv_mul(&pose);
    let found = placed
        .arm
        .configurations(&base_from_tool, &placed.joints_rad);
    found
        .ok()
        .and_then(|mut found| found.next())
        .expect("within reach")
}

/// Links that move at a hundred places of each motion of a path, frame of planning, with the number
/// of the motion.
fn links_along(path: &TransitPath, placed: &PlacedArm, opening_m: f64) -> Vec<(Capsule, usize)> {
    let mut all = Vec::new();
    for (motion, pair) in path.waypoints_rad.windows(2).enumerate() {
        for step in 0..=100 {
            let joints = pair[0] + (pair[1] - pair[0]) * (f64::from(step) / 100.0);
            let links = link_capsules(&placed.arm, &joints, opening_m);
            let links = links[N_BASE_CAPSULES..].iter();
            all.extend(links.map(|link| (link.transformed(&placed.plan_from_base), motion)));
        }
    }
    all
}

/// Greatest depth to which a link that moves is inside of a solid along a path, metres.
fn depth_m(path: &TransitPath, placed: &PlacedArm, opening_m: f64, solids: &[Solid]) -> f64 {
    let links = links_along(path, placed, opening_m);
    let depths = links.iter().map(|(link, _)| link_depth_m(link, solids));
    depths.fold(f64::NEG_INFINITY, f64::max)
}

fn link_depth_m(link: &Capsule, solids: &[Solid]) -> f64 {
    let along = (0..=20).map(|k| link.from + (link.to - link.from) * (f64::from(k) / 20.0));
    let distance_m = |place: Point3<f64>| {
        let solids = solids.iter().map(|solid| solid.distance_m(&place));
        solids.fold(place.z, f64::min)
    };
    link.radius_m - along.map(distance_m).fold(f64::INFINITY, f64::min)
}

fn transit<'a>(
    scene: &'a GraspScene<'a>,
    obstacles: &'a Obstacles,
    placed: &'a PlacedArm,
) -> TransitPlanner<'a> {
    TransitPlanner {
        scene,
        obstacles,
        placed,
        opening_m: 0.08,
        load: None,
        seed: 1,
    }
}

#[test]
fn transit_leads_over_what_stands_between_its_ends() {
    let solids = [
        cuboid(0.0, 0.0, [0.08, 0.08, 0.20]),
        Solid::Ball(Point3::new(-0.12, 0.12, 0.04), 0.04),
        Solid::Tube(Point3::new(0.12, 0.10, 0.0), 0.05, 0.004, 0.12),
    ];
    let (image, placed) = (SolidScene::new(&solids), arm());
    let scene = image.grasp_scene();
    let obstacles = Obstacles::within(&scene, &REGION);
    let planner = transit(&scene, &obstacles, &placed);
    let start = tool_down_at(&placed, 0.0, -0.20, 0.12);
    let goal = tool_down_at(&placed, 0.0, 0.22, 0.12);
    let path = planner.plan(&start, &goal).unwrap();
    assert_eq!(path.kind, TransitKind::OverSafeHeight);
    let deepest_m = depth_m(&path, &placed, 0.08, &solids);
    assert!(deepest_m < DEPTH_MAX_M, "{deepest_m}");
    // The straight motion of the joints would have gone through.
    let straight = TransitPath {
        waypoints_rad: vec![start, goal],
        ..path.clone()
    };
    assert!(depth_m(&straight, &placed, 0.08, &solids) > 0.02);
    assert!(path.duration_s(&placed.arm) > straight.duration_s(&placed.arm));
}

#[test]
fn object_in_the_hand_is_no_obstacle_though_it_is_seen() {
    let held = cuboid(0.0, -0.20, [0.05, 0.05, 0.16]);
    let beside = cuboid(0.0, 0.0, [0.08, 0.08, 0.20]);
    let solids = [held, beside];
    let (image, placed) = (SolidScene::new(&solids), arm());
    let scene = image.grasp_scene();
    let start = tool_down_at(&placed, 0.0, -0.20, 0.12);
    let goal = tool_down_at(&placed, 0.0, 0.22, 0.12);
    let seen = Obstacles::within(&scene, &REGION);
    let blocked = transit(&scene, &seen, &placed).plan(&start, &goal);
    assert!(blocked.is_err(), "{blocked:?}");
    let body = OrientedBox {
        frame_from_box: RigidTransform::translation(0.0, -0.20, 0.08),
        half_sides_m: Vector3::new(0.03, 0.03, 0.08),
    };
    let without = Obstacles::beside(&scene, &REGION, (&body, 0.03));
    let path = transit(&scene, &without, &placed)
        .plan(&start, &goal)
        .unwrap();
    let deepest_m = depth_m(&path, &placed, 0.08, &solids[1..]);
    assert!(deepest_m < DEPTH_MAX_M, "{deepest_m}");
}

#[test]
fn transit_leads_around_a_person_who_is_too_high_to_pass_over() {
    let (image, placed) = (SolidScene::new(&[]), arm());
    let mut scene = image.grasp_scene();
    let person = Capsule {
        from: Point3::new(-0.15, 0.0, 0.0),
        to: Point3::new(-0.15, 0.0, 1.5),
        radius_m: 0.08,
    };
    scene.people = vec![person];
    let obstacles = Obstacles::within(&scene, &REGION);
    let start = tool_down_at(&placed, -0.20, 0.42, 0.2);
    let goal = tool_down_at(&placed, -0.20, -0.42, 0.2);
    let planner = transit(&scene, &obstacles, &placed);
    for seed in 0..10 {
        let planner = TransitPlanner { seed, ..planner };
        let path = planner.plan(&start, &goal).unwrap();
        assert_eq!(path.kind, TransitKind::RandomTree);
        assert_eq!(path.waypoints_rad.first(), Some(&start));
        assert_eq!(path.waypoints_rad.last(), Some(&goal));
        for (link, step) in links_along(&path, &placed, 0.08) {
            let along = (0..=20).map(|k| link.from + (link.to - link.from) * (f64::from(k) / 20.0));
            let gaps_m = along.map(|place| person.distance_m(&place) - link.radius_m);
            let gap_m = gaps_m.fold(f64::INFINITY, f64::min);
            assert!(gap_m > 0.0, "{seed}, {step}: {gap_m}");
        }
        assert_eq!(planner.plan(&start, &goal).unwrap(), path);
    }
}

#[test]
fn blocked_ends_are_told_by_name() {
    let solids = [cuboid(0.0, 0.0, [0.10, 0.10, 0.20])];
    let (image, placed) = (SolidScene::new(&solids), arm());
    let mut scene = image.grasp_scene();
    let inside = tool_down_at(&placed, 0.0, 0.0, 0.15);
    let free = tool_down_at(&placed, -0.2, 0.3, 0.25);
    let blocked = |scene: &GraspScene<'_>, start: &JointVector, goal: &JointVector| {
        let obstacles = Obstacles::within(scene, &REGION);
        let planner = transit(scene, &obstacles, &placed);
        let reason = planner.plan(start, goal).unwrap_err();
        (reason, reason.words(scene))
    };
    let box_hit = ArmObstacle::Thing(Obstacle::Object(0));
    let (reason, words) = blocked(&scene, &free, &inside);
    assert_eq!(reason, NoTransit::GoalBlocked(box_hit), "{words}");
    assert!(words.contains("track 1"), "{words}");
    let (reason, _) = blocked(&scene, &inside, &free);
    assert_eq!(reason, NoTransit::StartBlocked(box_hit));
    let below = tool_down_at(&placed, -0.2, 0.3, 0.0);
    let (_, words) = blocked(&scene, &free, &below);
    assert!(words.contains("the table"), "{words}");
    scene.people = vec![Capsule {
        from: Point3::new(-0.2, 0.5, 0.3),
        to: Point3::new(-0.2, 0.3, 0.3),
        radius_m: 0.05,
    }];
    let (_, words) = blocked(&scene, &JointVector::from(HOME), &free);
    assert!(words.contains("a person"), "{words}");
}

/// Contacts and grasps of the first object.
fn grasps(
    scene: &GraspScene<'_>,
    obstacles: &Obstacles,
    placed: &PlacedArm,
) -> (Vec<ContactPoint>, Vec<Grasp>) {
    let planner = GraspPlanner {
        scene,
        obstacles,
        gripper: placed.arm.gripper(),
        arm: Some(placed),
        settings: &GraspSettings::default(),
    };
    let grasps = planner.plan(0).grasps;
    assert!(!grasps.is_empty());
    (contact_surface(scene, 0), grasps)
}

fn area(low: [f64; 2], high: [f64; 2]) -> PlaceArea {
    let mut corners = [low, [high[0], low[1]], high, [low[0], high[1]]].map(Point2::from);
    PlaceArea {
        name: "box".to_owned(),
        outline: ConvexPolygon::convex_hull_of(&mut corners),
        height_m: None,
    }
}

/// Transport of the first solid to an area, or the reason in words.
fn transported(solids: &[Solid], area: &PlaceArea) -> Result<Transport, (NoTransport, String)> {
    let (image, placed) = (SolidScene::new(solids), arm());
    let scene = image.grasp_scene();
    let near = Obstacles::of(&scene);
    let obstacles = Obstacles::within(&scene, &REGION);
    let (contacts, grasps) = grasps(&scene, &near, &placed);
    let planner = TransportPlanner {
        scene: &scene,
        obstacles: &obstacles,
        placed: &placed,
        seed: 1,
    };
    let plan = planner.plan((0, &contacts), &grasps, area);
    plan.map_err(|reason| {
        let words = reason.words(&scene, Some(area));
        (reason, words)
    })
}

const CARTON_M: [f64; 3] = [0.05, 0.05, 0.12];

#[test]
fn object_is_placed_clear_of_its_neighbours_as_it_stood() {
    let solids = [
        cuboid(-0.10, -0.15, CARTON_M),
        cuboid(0.02, 0.20, [0.06, 0.06, 0.10]),
    ];
    let area = area([-0.25, 0.10], [0.05, 0.30]);
    let transport = transported(&solids, &area).unwrap();
    let placement = &transport.placement;
    assert!(area.outline.signed_distance_m(&placement.foot.xy()) > 0.02);
    assert!(placement.foot.z.abs() < 0.003, "{placement:?}");
    assert_eq!(placement.surface, "the table");
    let gap_m = (placement.foot.xy() - Point2::new(0.02, 0.20)).abs().max() - 0.03 - 0.025;
    assert!(gap_m > 0.0, "{gap_m} {placement:?}");
    // The arm is where the placement says, and the object is only turned about the vertical.
    let placed = arm();
    let tool = placed.plan_from_base * placed.arm.tool_pose(&placement.release_rad);
    let off = tool.translation.vector - placement.plan_from_tool.translation.vector;
    assert!(off.norm() < 1e-3, "{off}");
    let above = placed.plan_from_base * placed.arm.tool_pose(&placement.above_rad);
    assert!(above.translation.z - tool.translation.z > 0.09);
    let deepest_m = depth_m(&transport.path, &placed, 0.05, &solids[1..]);
    assert!(deepest_m < DEPTH_MAX_M, "{deepest_m}");
}

#[test]
fn release_is_low_and_the_foot_follows_the_surface() {
    let solids = [cuboid(-0.10, -0.15, CARTON_M)];
    let (image, placed) = (SolidScene::new(&solids), arm());
    let scene = image.grasp_scene();
    let obstacles = Obstacles::within(&scene, &REGION);
    let (contacts, grasps) = grasps(&scene, &Obstacles::of(&scene), &placed);
    let planner = PlacingPlanner {
        scene: &scene,
        obstacles: &obstacles,
        placed: &placed,
    };
    for grasp in &grasps {
        let object = GraspedObject {
            index: 0,
            contacts: &contacts,
            grasp,
        };
        for placement in planner
            .plan(&object, &area([-0.2, 0.1], [0.0, 0.3]))
            .placements
        {
            let up_m = placement.plan_from_tool.translation.z - grasp.plan_from_tool.translation.z;
            assert!((0.0..=0.005).contains(&up_m), "{up_m}");
            assert!((up_m - RELEASE_M).abs() < 0.002, "{up_m}");
            let approach = |pose: &RigidTransform| (pose.rotation * Vector3::z()).z;
            let tilted = approach(&placement.plan_from_tool) - approach(&grasp.plan_from_tool);
            assert!(tilted.abs() < 1e-9);
        }
    }
}

#[test]
fn full_place_says_so() {
    let mut solids = vec![cuboid(-0.10, -0.15, CARTON_M)];
    solids.extend([-0.16, -0.08, 0.0].map(|x| cuboid(x, 0.2, [0.06, 0.06, 0.08])));
    let (reason, words) = transported(&solids, &area([-0.18, 0.16], [0.02, 0.24])).unwrap_err();
    assert!(matches!(reason, NoTransport::NoPlace(_)), "{reason:?}");
    assert!(words.contains("full") && words.contains("track"), "{words}");
}

#[test]
fn place_that_is_too_small_out_of_reach_hidden_or_nowhere_says_so() {
    let carton = cuboid(-0.10, -0.15, CARTON_M);
    let say = |solids: &[Solid], low, high| transported(solids, &area(low, high)).unwrap_err().1;
    let words = say(&[carton], [-0.1, 0.1], [-0.08, 0.12]);
    assert!(words.contains("larger"), "{words}");
    let words = say(&[carton], [0.36, 0.42], [0.46, 0.52]);
    assert!(words.contains("reach"), "{words}");
    let words = say(&[carton], [-0.2, 0.7], [0.0, 0.9]);
    assert!(words.contains("no surface"), "{words}");
    let high = cuboid(-0.10, 0.05, [0.12, 0.04, 0.30]);
    let words = say(&[carton, high], [-0.14, 0.20], [-0.06, 0.28]);
    assert!(words.contains("not seen"), "{words}");
}

#[test]
fn place_at_the_edge_of_the_image_is_for_what_the_camera_sees_whole() {
    // The foot of a carton would be seen there, its top not.
    let edge = area([-0.375, -0.34], [-0.31, -0.27]);
    let carton = cuboid(-0.10, -0.15, CARTON_M);
    let (_, words) = transported(&[carton], &edge).unwrap_err();
    assert!(words.contains("not see it whole"), "{words}");
}
