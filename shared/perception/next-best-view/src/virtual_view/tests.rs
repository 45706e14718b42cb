use super::*;
use crate::{Hypothesis, SurfaceModel};
use geometry::PinholeCamera;
use nalgebra::{Point3, UnitQuaternion, Vector3};

fn cube(side: f32) -> SurfaceModel {
    let mesh = mesh::rounded_box([side; 3], 0.001, 0.1).mesh;
    SurfaceModel::of_mesh(&mesh, 0.003).unwrap()
}

/// Points of a sphere by golden angle, 3 mm apart or less.
fn sphere(radius: f32) -> SurfaceModel {
    let n = 20_000_u16;
    let point = |i: u16| {
        let z = 1.0 - 2.0 * (f32::from(i) + 0.5) / f32::from(n);
        let angle = f32::from(i) * 2.399_963_2;
        let ring = (1.0 - z * z).sqrt();
        [ring * angle.cos(), ring * angle.sin(), z].map(|c| c * radius)
    };
    SurfaceModel::of_points(&(0..n).map(point).collect::<Vec<_>>(), 0.003).unwrap()
}

fn at(id: u32, model: &SurfaceModel, x: f64, y: f64, z: f64) -> Hypothesis<'_> {
    Hypothesis {
        id,
        model,
        world_from_object: RigidTransform::translation(x, y, z),
    }
}

/// Sheet of points in the plane z, `half` metres to each side.
fn sheet(half: f32, z: f32) -> Vec<[f32; 3]> {
    let n = (half / 0.0015) as u16;
    let place = |i: u16| f32::from(i) * 0.003 - half;
    (0..n)
        .flat_map(|i| (0..n).map(move |j| [place(i), place(j), z]))
        .collect()
}

fn camera(x: f64, y: f64, z: f64) -> RigidTransform {
    let (eye, middle) = (Point3::new(x, y, z), Point3::origin());
    RigidTransform::face_towards(&eye, &middle, &Vector3::new(0.01, -0.02, -1.0))
}

fn rendered(scene: &PlanningScene, camera: &RigidTransform) -> VirtualView {
    let mut view = VirtualView::default();
    view.render(scene, camera, &RenderConfig::default())
        .unwrap();
    view
}

#[test]
fn areas_of_a_box_and_a_sphere_are_those_of_their_projections() {
    let (cube, ball) = (cube(0.1), sphere(0.05));
    let scene = PlanningScene::new(
        &[at(4, &cube, -0.1, 0.0, 0.0), at(9, &ball, 0.1, 0.0, 0.0)],
        &[],
    );
    let scene = scene.unwrap();
    assert_eq!(scene.ids(), [4, 9]);
    for (place, faces) in [
        ([0.0, 0.0, 0.8], 1.0),
        // From the direction (0, 0.6, 0.8) two faces are seen foreshortened.
        ([0.0, 0.48, 0.64], 1.4),
        ([0.0, 0.64, 0.48], 1.4),
    ] {
        let view = rendered(&scene, &camera(place[0], place[1], place[2]));
        let [of_cube, of_ball] = view.object_areas_m2() else {
            panic!("two objects");
        };
        assert!(
            (of_cube / (0.01 * faces) - 1.0).abs() < 0.05,
            "{of_cube} at {place:?}"
        );
        let disc = std::f64::consts::PI * 0.0025;
        assert!(
            (of_ball / disc - 1.0).abs() < 0.05,
            "{of_ball} at {place:?}"
        );
        assert_eq!(view.background_area_m2(), 0.0);
    }
}

#[test]
fn perspective_areas_are_those_of_the_surface_seen_head_on() {
    let scene =
        PlanningScene::new(&[at(1, &cube(0.1), 0.0, 0.0, 0.0)], &sheet(0.15, -0.05)).unwrap();
    let pinhole = PinholeCamera {
        fx_px: 146.25,
        fy_px: 146.25,
        cx_px: 79.5,
        cy_px: 59.5,
        width: 160,
        height: 120,
    };
    let config = RenderConfig {
        projection: ViewProjection::Perspective(pinhole),
        ..RenderConfig::default()
    };
    let mut view = VirtualView::default();
    view.render(&scene, &camera(0.0, 0.0, 0.65), &config)
        .unwrap();
    assert_eq!(view.size(), (160, 120));
    let area = view.object_areas_m2()[0];
    assert!((area / 0.01 - 1.0).abs() < 0.06, "{area}");
    // The box hides the shadow of its top, which is wider on the sheet by 0.7 / 0.6.
    let shadow = 0.01 * (0.7_f64 / 0.6).powi(2);
    let table = view.background_area_m2();
    assert!((table / (0.09 - shadow) - 1.0).abs() < 0.06, "{table}");
    assert!((view.depth_m(80, 60).unwrap() - 0.6).abs() < 0.002);
    assert_eq!(view.label(80, 60), ViewLabel::Object(0));
    assert_eq!(view.label(160, 60), ViewLabel::Empty);
    // The points of the cloud are on the surfaces.
    let mut points = Vec::new();
    view.write_cloud(&mut points);
    assert_eq!(points.len(), 160 * 120);
    let world_from_camera = camera(0.0, 0.0, 0.65);
    let seen: Vec<_> = points.iter().filter(|point| point.is_finite()).collect();
    assert!(seen.len() > 3000);
    for point in seen {
        let z = (world_from_camera * point.position()).z;
        assert!(
            (z - 0.05).abs() < 0.003 || (z + 0.05).abs() < 0.003 || z.abs() < 0.053,
            "{z}"
        );
    }
}

#[test]
fn nearer_objects_hide_those_behind_them_without_leaks() {
    let (front, back) = (cube(0.1), cube(0.08));
    let hypotheses = [at(1, &front, 0.2, 0.0, 0.0), at(2, &back, -0.1, 0.0, 0.0)];
    let scene = PlanningScene::new(&hypotheses, &[]).unwrap();
    let view = rendered(&scene, &camera(0.9, 0.0, 0.0));
    assert!(view.object_areas_m2()[0] > 0.009);
    assert_eq!(
        view.object_areas_m2()[1],
        0.0,
        "the larger box hides the other one altogether"
    );
    let behind = rendered(&scene, &camera(-0.9, 0.0, 0.0));
    let [of_front, of_back] = behind.object_areas_m2() else {
        panic!("two objects");
    };
    assert!((of_back / 0.0064 - 1.0).abs() < 0.05, "{of_back}");
    assert!((of_front / 0.0036 - 1.0).abs() < 0.1, "{of_front}");
}

#[test]
fn splats_close_the_gaps_of_a_turned_surface_and_keep_its_area() {
    // A plate 3 mm apart, turned by 45 degrees, over a dense background: every second cell of the
    // diagonal would show the background.
    let plate = SurfaceModel::of_points(&sheet(0.1, 0.0), 0.001).unwrap();
    let turned = Hypothesis {
        id: 1,
        model: &plate,
        world_from_object: RigidTransform::rotation(Vector3::z() * 0.7),
    };
    let scene = PlanningScene::new(&[turned], &sheet(0.2, -0.1)).unwrap();
    let leak = |splat_radius| {
        let config = RenderConfig {
            splat_radius,
            ..RenderConfig::default()
        };
        let mut view = VirtualView::default();
        view.render(&scene, &camera(0.0, 0.0, 0.8), &config)
            .unwrap();
        1.0 - view.object_areas_m2()[0] / (0.195 * 0.195)
    };
    assert!(leak(0) > 0.1, "{}", leak(0));
    assert!(leak(1).abs() < 0.02, "{}", leak(1));
}

#[test]
fn parts_of_one_identity_add_up() {
    let cube = cube(0.06);
    let parts = [at(7, &cube, -0.1, 0.0, 0.0), at(7, &cube, 0.1, 0.0, 0.0)];
    let scene = PlanningScene::new(&parts, &[]).unwrap();
    let view = rendered(&scene, &camera(0.0, 0.0, 0.8));
    assert_eq!(view.object_areas_m2().len(), 1);
    assert!((view.object_areas_m2()[0] / 0.0072 - 1.0).abs() < 0.05);
}

#[test]
fn nothing_is_seen_behind_the_camera_or_of_an_empty_scene() {
    let cube = cube(0.06);
    let scene = PlanningScene::new(&[at(1, &cube, 0.0, 0.0, 0.0)], &[]).unwrap();
    let away =
        camera(0.0, 0.0, 0.8) * RigidTransform::rotation(Vector3::x() * std::f64::consts::PI);
    let view = rendered(&scene, &away);
    assert_eq!((view.object_areas_m2(), view.size()), (&[0.0][..], (0, 0)));
    let empty = PlanningScene::new(&[], &[]).unwrap();
    let view = rendered(&empty, &camera(0.0, 0.0, 0.8));
    assert_eq!(
        (view.object_areas_m2().len(), view.background_area_m2()),
        (0, 0.0)
    );
    assert_eq!(view.label(0, 0), ViewLabel::Empty);
}

#[test]
fn near_clip_cuts_a_box_around_the_camera_open() {
    // From the middle of a hollow box the far side is seen.
    let cube = cube(0.2);
    let scene = PlanningScene::new(&[at(1, &cube, 0.0, 0.0, 0.0)], &[]).unwrap();
    let inside = RigidTransform::rotation(UnitQuaternion::identity().scaled_axis());
    let view = rendered(&scene, &inside);
    let (width, height) = view.size();
    let depth_m = view.depth_m(width / 2, height / 2).unwrap();
    assert!((depth_m - 0.1).abs() < 0.002, "{depth_m}");
}

#[test]
fn impossible_settings_and_poses_are_refused_with_a_sentence() {
    let cube = cube(0.06);
    let scene = PlanningScene::new(&[at(1, &cube, 0.0, 0.0, 0.0)], &[]).unwrap();
    let mut view = VirtualView::default();
    let mut refused = |scene: &PlanningScene, config: RenderConfig, pose: RigidTransform| {
        view.render(scene, &pose, &config).unwrap_err().to_string()
    };
    let good = RenderConfig::default();
    let cells = |cell_m| RenderConfig {
        projection: ViewProjection::Orthographic { cell_m },
        ..good
    };
    let above = camera(0.0, 0.0, 0.8);
    assert!(refused(&scene, cells(0.0), above).contains("cell_m"));
    assert!(refused(&scene, cells(f64::NAN), above).contains("cell_m"));
    let near = RenderConfig {
        near_m: f32::NAN,
        ..good
    };
    assert!(refused(&scene, near, above).contains("near_m"));
    let splats = RenderConfig {
        splat_radius: 9,
        ..good
    };
    assert!(refused(&scene, splats, above).contains("splat_radius"));
    let nowhere = RigidTransform::translation(f64::NAN, 0.0, 0.0);
    assert!(refused(&scene, good, nowhere).contains("not finite"));
    for far in [20.0, 1e30, 1e300] {
        let apart = [at(1, &cube, 0.0, 0.0, 0.0), at(2, &cube, far, 0.0, 0.0)];
        let wide = PlanningScene::new(&apart, &[]).unwrap();
        let sentence = refused(&wide, good, camera(0.0, 0.0, 0.8));
        assert!(sentence.contains("wide"), "{sentence}");
    }
    let lost = Hypothesis {
        world_from_object: nowhere,
        ..at(1, &cube, 0.0, 0.0, 0.0)
    };
    let error = PlanningScene::new(&[lost], &[]).unwrap_err();
    assert!(error.to_string().contains("hypothesis 0"), "{error}");
}
