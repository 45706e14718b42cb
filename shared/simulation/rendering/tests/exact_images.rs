//! Tests of rendered images against exact geometry.

#![expect(clippy::unwrap_used, reason = "a failing set-up must fail the test")]

mod synthetic;

use geometry::{PinholeCamera, RigidTransform};
use mesh::{Triangle, TriangleMesh};
use nalgebra::{Point3, Vector3};
use rendering::{Error, Image, Instance, Lights, PreparedMesh, Rasterizer, StaticScene};
use std::f64::consts::PI;
use synthetic::{TableScene, at, ball, cuboid, cylinder, rectangle, turned};

const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;

fn render(instances: &[Instance<'_>]) -> Image {
    Rasterizer::new(CAMERA).unwrap().render(instances).clone()
}

/// Pixel indices with their viewing rays.
fn rays() -> impl Iterator<Item = (usize, Vector3<f64>)> {
    (0..CAMERA.n_pixels()).map(|pixel| {
        let (column, row) = (pixel % 640, pixel / 640);
        (pixel, CAMERA.ray(column as f64, row as f64))
    })
}

#[test]
fn depth_of_a_plane_matches_ray_intersection() {
    let mesh = PreparedMesh::new(&rectangle(30.0, 30.0, 1, [200; 3]));
    for (z, tilt, turn) in [
        (0.6, 0.0, 0.0),
        (1.0, 0.7, 0.3),
        (2.0, -0.9, 0.0),
        (1.2, 1.35, 0.0),
    ] {
        let pose = turned(0.0, 0.0, z, [PI + tilt, turn, 0.0]);
        let image = render(&[Instance::new(&mesh, pose, 7)]);
        let normal = pose.rotation * Vector3::z();
        let mut n_seen = 0;
        for (pixel, ray) in rays() {
            let exact = normal.z * z / normal.dot(&ray);
            let is_in_front = exact > 0.02 && exact < 8.0;
            let depth = f64::from(image.depth_m()[pixel]);
            if is_in_front && depth.is_finite() {
                n_seen += 1;
                assert!((depth - exact).abs() < 1e-4, "{pixel}: {depth} {exact}");
                assert_eq!(image.instance()[pixel], 7);
            }
        }
        assert!(n_seen > 100_000, "{n_seen}");
    }
}

#[test]
fn depth_of_a_sphere_matches_ray_intersection() {
    let (radius, center) = (0.25, Vector3::new(0.1, -0.05, 1.1));
    let n = 160;
    let mesh = PreparedMesh::new(&ball(radius as f32, n, [200; 3]));
    let image = render(&[Instance::new(&mesh, at(center.x, center.y, center.z), 1)]);
    // The middle of a chord over the angle of a cell's diagonal is this far inside.
    let sag = radius * (1.0 - (PI / f64::from(n) / 2.0 * 1.5).cos());
    for (pixel, ray) in rays() {
        let (a, b) = (ray.norm_squared(), ray.dot(&center));
        let discriminant = b * b - a * (center.norm_squared() - radius * radius);
        if discriminant < 0.0 {
            assert_eq!(image.instance()[pixel], 0);
            continue;
        }
        let exact = (b - discriminant.sqrt()) / a;
        let normal = (ray * exact - center) / radius;
        let cosine = -normal.dot(&ray) / ray.norm();
        if cosine > 0.2 {
            let depth = f64::from(image.depth_m()[pixel]);
            let limit = 1e-4 + sag / cosine;
            assert!((depth - exact).abs() < limit, "{pixel}: {depth} {exact}");
            let reflection = image.reflection()[pixel];
            assert!((f64::from(reflection.cos_incidence) / 255.0 - cosine).abs() < 0.02);
            for axis in 0..3 {
                let part = f64::from(reflection.normal[axis]) / 127.0;
                assert!((part - normal[axis]).abs() < 0.04);
            }
        }
    }
}

#[test]
fn depth_test_is_independent_of_drawing_order() {
    let near = PreparedMesh::new(&cuboid([0.2, 0.2, 0.2], 3, [255, 0, 0]));
    let far = PreparedMesh::new(&cuboid([0.6, 0.6, 0.2], 3, [0, 255, 0]));
    let instances = [
        Instance::new(&near, at(0.0, 0.0, 0.8), 1),
        Instance::new(&far, at(0.0, 0.0, 1.6), 2),
    ];
    let image = render(&instances);
    let middle = 240 * 640 + 320;
    assert_eq!(
        (image.instance()[middle], image.instance()[middle + 95]),
        (1, 2)
    );
    assert!((image.depth_m()[middle] - 0.7).abs() < 1e-5);
    assert_eq!(image, render(&[instances[1], instances[0]]));
    let mut counts = [0; 3];
    image.count_pixels(&mut counts);
    assert_eq!(counts.iter().sum::<u32>() as usize, CAMERA.n_pixels());
    // Its face of 0.2 m is at 0.7 m.
    let side_px = 0.2 / 0.7 * CAMERA.fx_px;
    assert!((f64::from(counts[1]) / (side_px * side_px) - 1.0).abs() < 0.02);
}

#[test]
fn back_faces_are_culled() {
    let mesh = PreparedMesh::new(&rectangle(1.0, 1.0, 1, [200; 3]));
    let towards = turned(0.0, 0.0, 1.0, [PI, 0.0, 0.0]);
    let away = at(0.0, 0.0, 1.0);
    assert!(
        render(&[Instance::new(&mesh, towards, 1)])
            .instance()
            .contains(&1)
    );
    assert!(
        !render(&[Instance::new(&mesh, away, 1)])
            .instance()
            .contains(&1)
    );
    // From inside of a closed mesh nothing of it is seen.
    let around = PreparedMesh::new(&cuboid([2.0; 3], 4, [200; 3]));
    assert!(
        !render(&[Instance::new(&around, at(0.0, 0.0, 0.0), 1)])
            .instance()
            .contains(&1)
    );
}

#[test]
fn near_plane_clips_a_floor_under_the_camera() {
    let mesh = PreparedMesh::new(&rectangle(40.0, 40.0, 1, [200; 3]));
    // The camera's y points down; the floor is 0.5 m below and faces up.
    let pose = turned(0.0, 0.5, 0.0, [PI / 2.0, 0.0, 0.0]);
    let image = render(&[Instance::new(&mesh, pose, 1)]);
    for (pixel, ray) in rays().filter(|(_, ray)| ray.y > 0.05) {
        let (depth, exact) = (f64::from(image.depth_m()[pixel]), 0.5 / ray.y);
        assert!(
            (depth - exact).abs() < 1e-4 * exact.max(1.0),
            "{depth} {exact}"
        );
    }
    assert!(rays().all(|(pixel, ray)| ray.y > 0.0 || image.instance()[pixel] == 0));
}

#[test]
fn background_rendering_equals_rendering_everything() {
    let scene = TableScene::new(12);
    let (background, objects) = (scene.background(), scene.objects());
    let stage = |background| StaticScene {
        world_from_camera: TableScene::world_from_camera(),
        lights: Lights::ROOM,
        background,
    };
    let mut layered = Rasterizer::new(CAMERA).unwrap();
    layered.prepare(&stage(&background)).unwrap();
    let mut whole = Rasterizer::new(CAMERA).unwrap();
    whole.prepare(&stage(&[])).unwrap();
    for step in 0..4 {
        let moved: Vec<_> = objects
            .iter()
            .skip(step)
            .map(|object| Instance {
                world_from_mesh: at(0.03 * step as f64, 0.0, 0.01) * object.world_from_mesh,
                ..*object
            })
            .collect();
        let over = layered.render(&moved).clone();
        let all = [background.clone(), moved].concat();
        assert!(over == *whole.render(&all), "step {step}");
    }
    let empty = layered.render(&[]).clone();
    assert!(empty == *whole.render(&background));
}

#[test]
fn background_leaves_no_trace_of_an_earlier_view() {
    let scene = TableScene::new(6);
    let (background, objects) = (scene.background(), scene.objects());
    let all = [background.clone(), objects.clone()].concat();
    let stage = |background, step| StaticScene {
        world_from_camera: TableScene::orbiting_camera(40 * step),
        lights: Lights::ROOM,
        background,
    };
    let mut used = Rasterizer::new(CAMERA).unwrap();
    for (step, (prepared, rendered)) in [
        (&[][..], &all[..]),
        (&[][..], &objects[..]),
        (&background[..], &objects[1..]),
        (&background[2..], &objects[..]),
        (&[][..], &objects[3..]),
        (&[][..], &[][..]),
    ]
    .into_iter()
    .enumerate()
    {
        let stage = stage(prepared, step as u64);
        used.prepare(&stage).unwrap();
        let mut fresh = Rasterizer::new(CAMERA).unwrap();
        fresh.prepare(&stage).unwrap();
        assert!(
            used.render(rendered) == fresh.render(rendered),
            "step {step}"
        );
    }
}

#[test]
fn shadows_darken_the_table_and_change_nothing_else() {
    let scene = TableScene::new(8);
    let (background, objects) = (scene.background(), scene.objects());
    let mut images = vec![];
    for shadow in [None, Lights::ROOM.shadow] {
        let mut rasterizer = Rasterizer::new(CAMERA).unwrap();
        let lights = Lights {
            shadow,
            ..Lights::ROOM
        };
        let stage = StaticScene {
            world_from_camera: TableScene::world_from_camera(),
            lights,
            background: &background,
        };
        rasterizer.prepare(&stage).unwrap();
        images.push(rasterizer.render(&objects).clone());
    }
    assert!(images[0].depth_m() == images[1].depth_m());
    let pairs = || images[0].color().iter().zip(images[1].color());
    assert!(pairs().all(|(lit, dark)| (0..3).all(|i| dark[i] <= lit[i])));
    let n_darker = pairs()
        .filter(|(lit, dark)| dark[1] < lit[1] / 4 * 3)
        .count();
    assert!((2_000..80_000).contains(&n_darker), "{n_darker}");
}

#[test]
fn unoccluded_count_equals_pixels_without_occluders() {
    let scene = TableScene::new(12);
    let objects = scene.objects();
    let mut rasterizer = scene.prepared_rasterizer(CAMERA);
    let mut counts = [0; 32];
    rasterizer.render(&objects).count_pixels(&mut counts);
    let mut n_hidden = 0;
    for object in &objects {
        let (visible, alone) = (
            counts[usize::from(object.id)] as usize,
            rasterizer.n_unoccluded_px(object),
        );
        assert!(
            alone >= visible && alone > 100,
            "{}: {alone} {visible}",
            object.id
        );
        n_hidden += usize::from(alone > visible + 50);
        let mut only = [0; 32];
        rasterizer
            .prepare(&StaticScene {
                world_from_camera: TableScene::world_from_camera(),
                lights: Lights::ROOM,
                background: &[],
            })
            .unwrap();
        rasterizer.render(&[*object]).count_pixels(&mut only);
        assert_eq!(alone, only[usize::from(object.id)] as usize);
    }
    assert!((1..objects.len()).contains(&n_hidden));
}

#[test]
fn invalid_meshes_and_poses_do_not_panic() {
    let mut mesh = cylinder(0.1, 0.2, 16, [90; 3]);
    mesh.vertices[3].position = Point3::new(f32::NAN, 0.0, f32::INFINITY);
    mesh.vertices[8].normal = Vector3::new(f32::NAN, 0.0, 0.0);
    mesh.vertices[9].normal = Vector3::zeros();
    mesh.triangles.push(Triangle {
        vertices: [0, 1, u32::MAX],
        surface: 255,
    });
    let prepared = PreparedMesh::new(&mesh);
    assert!(prepared.n_skipped() > 0 && prepared.n_faces() > 0);
    let empty = PreparedMesh::new(&TriangleMesh::default());
    let mut rasterizer = Rasterizer::new(CAMERA).unwrap();
    let mut broken = RigidTransform::identity();
    broken.translation.x = f64::NAN;
    for pose in [
        broken,
        at(1e300, 0.0, 1.0),
        at(0.0, 0.0, 0.0),
        at(0.0, 0.0, 0.05),
        at(0.0, 0.0, 1.0),
        at(1e5, -1e5, 1e5),
    ] {
        let instances = [
            Instance::new(&empty, pose, 3),
            Instance::new(&prepared, pose, 1),
        ];
        let image = rasterizer.render(&instances);
        assert!(image.depth_m().iter().all(|z| *z > 0.0));
        assert!(rasterizer.n_unoccluded_px(&instances[0]) == 0);
        rasterizer.n_unoccluded_px(&instances[1]);
    }
    let stage = StaticScene {
        world_from_camera: broken,
        lights: Lights::ROOM,
        background: &[],
    };
    assert_eq!(rasterizer.prepare(&stage), Err(Error::Pose));
    let no_camera = PinholeCamera { width: 0, ..CAMERA };
    assert!(matches!(Rasterizer::new(no_camera), Err(Error::Camera(_))));
}
