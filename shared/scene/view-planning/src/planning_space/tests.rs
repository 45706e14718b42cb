use super::*;
use geometry::{PinholeCamera, RigidTransform};
use next_best_view::VoxelState;
use point_cloud::Rgba;
use scene_client::HypothesisSource;
use std::rc::Rc;

/// Camera above the origin that looks straight down, 0.8 m high.
fn overhead() -> RigidTransform {
    let eye = Point3::new(0.0, 0.0, 0.8);
    RigidTransform::face_towards(&eye, &Point3::origin(), &-Vector3::y())
}

/// Frame of a cube's top of 6 cm at the origin, 6 cm high, on a table that reaches far.
fn snapshot() -> Snapshot {
    let camera = PinholeCamera {
        fx_px: 150.0,
        fy_px: 150.0,
        cx_px: 79.5,
        cy_px: 59.5,
        width: 160,
        height: 120,
    };
    let mut points = Vec::new();
    for row in 0..120 {
        for column in 0..160 {
            let table = camera.back_project(f64::from(column), f64::from(row), 0.86);
            let top = camera.back_project(f64::from(column), f64::from(row), 0.80);
            let is_cube = top.x.abs() < 0.03 && top.y.abs() < 0.03;
            let [x, y, z] = if is_cube { top } else { table }.cast::<f32>().into();
            points.push(Point {
                x,
                y,
                z,
                color: Rgba::opaque(0, 0, 0),
            });
        }
    }
    Snapshot {
        world_from_camera: Some(overhead()),
        ..Snapshot::of_points(camera, points)
    }
}

fn frame() -> PlanningFrame {
    PlanningFrame {
        world_from_plan: RigidTransform::identity(),
        plan_from_camera: overhead(),
        table_in_plan: None,
        notes: Vec::new(),
    }
}

fn cube_top() -> ObjectHypothesis {
    let place = |i: u16| {
        let (column, row) = (f32::from(i % 21), f32::from(i / 21));
        [0.003 * column - 0.03, 0.003 * row - 0.03, 0.0]
    };
    let points: Vec<[f32; 3]> = (0..441).map(place).collect();
    ObjectHypothesis {
        track: 1,
        label: None,
        source: HypothesisSource::Measured,
        surface: Rc::new(SurfaceModel::of_points(&points, 0.003).unwrap()),
        plan_from_object: RigidTransform::identity(),
        note: String::new(),
    }
}

#[test]
fn background_is_the_table_near_the_objects_and_nothing_of_them() {
    let hypotheses = [cube_top()];
    // 5 cm below the lowest measured point would leave out the table 6 cm below.
    let mut space = PlanningSpace::around(&hypotheses);
    assert!((space.least.z + 0.05).abs() < 1e-6 && (space.greatest.x - 0.18).abs() < 1e-3);
    let background = space.background(&snapshot(), &frame(), (&hypotheses, 0.003));
    assert_eq!(background.unwrap(), [[0.0; 3]; 0]);
    space.least.z = -0.1;
    let background = space.background(&snapshot(), &frame(), (&hypotheses, 0.003));
    let background = background.unwrap();
    assert!(background.len() > 500, "{}", background.len());
    for [x, y, z] in background {
        assert!((z + 0.06).abs() < 1e-3, "the top is explained: {z}");
        assert!(x.abs() < 0.1801 && y.abs() < 0.1801, "far away: {x} {y}");
    }
}

#[test]
fn space_below_a_measured_surface_is_unknown_and_that_above_is_free() {
    let space = PlanningSpace::around(&[cube_top()]);
    let grid = space.occupancy(&snapshot(), &frame()).unwrap();
    let state = |z| grid.state_at(&Point3::new(0.005, 0.005, z));
    assert_eq!(state(0.05), Some(VoxelState::Free));
    assert_eq!(state(-0.03), Some(VoxelState::Unknown));
    assert_eq!(state(0.3), None);
}

#[test]
fn space_without_objects_is_around_the_middle_of_the_image() {
    let space = PlanningSpace::around(&[]);
    let background = space
        .background(&snapshot(), &frame(), (&[], 0.003))
        .unwrap();
    assert!(background.len() > 2000, "{}", background.len());
    assert!(space.diagonal_m() > 1.2 && space.diagonal_m() < 1.6);
}
