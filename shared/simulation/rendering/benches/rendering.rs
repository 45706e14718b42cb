//! Benchmarks of one frame of a table scene on one core: rasterising, sensor model, both; and ray
//! casting of the same image as a reference.

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use divan::Bencher;
use geometry::PinholeCamera;
use parry3d::math::Vector;
use parry3d::query::{Ray, RayCast};
use parry3d::shape::TriMesh;
use point_cloud::Point;
use rendering::kinect::{FrameSeed, KinectSensor, SensorModel};
use rendering::{Error, Lights, Rasterizer, StaticScene};
use synthetic::TableScene;

fn main() {
    divan::main();
}

const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;
const N_OBJECTS: [usize; 3] = [1, 10, 30];

fn rasterizer(scene: &TableScene, lights: Lights) -> Result<Rasterizer, Error> {
    let mut rasterizer = Rasterizer::new(CAMERA)?;
    rasterizer.prepare(&StaticScene {
        world_from_camera: TableScene::world_from_camera(),
        lights,
        background: &scene.background(),
    })?;
    Ok(rasterizer)
}

fn bench_render(bencher: Bencher<'_, '_>, n_objects: usize, lights: Lights) {
    let scene = TableScene::new(n_objects);
    let Ok(mut rasterizer) = rasterizer(&scene, lights) else {
        return;
    };
    let objects = scene.objects();
    bencher.bench_local(|| rasterizer.render(&objects).depth_m()[0]);
}

#[divan::bench(args = N_OBJECTS)]
fn render(bencher: Bencher<'_, '_>, n_objects: usize) {
    bench_render(bencher, n_objects, Lights::ROOM);
}

#[divan::bench(args = N_OBJECTS)]
fn render_without_shadows(bencher: Bencher<'_, '_>, n_objects: usize) {
    bench_render(
        bencher,
        n_objects,
        Lights {
            shadow: None,
            ..Lights::ROOM
        },
    );
}

/// Rendering everything, without a prepared background.
#[divan::bench(args = N_OBJECTS)]
fn render_with_moving_camera(bencher: Bencher<'_, '_>, n_objects: usize) {
    let scene = TableScene::new(n_objects);
    let Ok(mut rasterizer) = rasterizer(&scene, Lights::ROOM) else {
        return;
    };
    let instances = [scene.background(), scene.objects()].concat();
    let stage = StaticScene {
        world_from_camera: TableScene::world_from_camera(),
        lights: Lights::ROOM,
        background: &[],
    };
    bencher.bench_local(|| {
        let is_prepared = rasterizer.prepare(&stage).is_ok();
        (is_prepared, rasterizer.render(&instances).depth_m()[0])
    });
}

#[divan::bench(args = N_OBJECTS)]
fn count_unoccluded(bencher: Bencher<'_, '_>, n_objects: usize) {
    let scene = TableScene::new(n_objects);
    let Ok(mut rasterizer) = rasterizer(&scene, Lights::ROOM) else {
        return;
    };
    let objects = scene.objects();
    bencher.bench_local(|| {
        objects
            .iter()
            .map(|object| rasterizer.n_unoccluded_px(object))
            .sum::<usize>()
    });
}

fn bench_sense(bencher: Bencher<'_, '_>, n_objects: usize, model: SensorModel) {
    let scene = TableScene::new(n_objects);
    let (Ok(mut rasterizer), Ok(mut sensor)) = (
        rasterizer(&scene, Lights::ROOM),
        KinectSensor::new(CAMERA, model),
    ) else {
        return;
    };
    let image = rasterizer.render(&scene.objects());
    let mut points = vec![Point::default(); CAMERA.n_pixels()];
    let mut shot = FrameSeed::default();
    bencher.bench_local(|| {
        shot.frame_index += 1;
        sensor.sense(image, shot, &mut points).is_ok()
    });
}

#[divan::bench(args = N_OBJECTS)]
fn sense(bencher: Bencher<'_, '_>, n_objects: usize) {
    bench_sense(bencher, n_objects, SensorModel::KINECT_V1);
}

#[divan::bench]
fn sense_perfect(bencher: Bencher<'_, '_>) {
    bench_sense(bencher, 10, SensorModel::PERFECT);
}

#[divan::bench(args = N_OBJECTS)]
fn render_and_sense(bencher: Bencher<'_, '_>, n_objects: usize) {
    let scene = TableScene::new(n_objects);
    let (Ok(mut rasterizer), Ok(mut sensor)) = (
        rasterizer(&scene, Lights::ROOM),
        KinectSensor::new(CAMERA, SensorModel::KINECT_V1),
    ) else {
        return;
    };
    let objects = scene.objects();
    let mut points = vec![Point::default(); CAMERA.n_pixels()];
    let mut shot = FrameSeed::default();
    bencher.bench_local(|| {
        shot.frame_index += 1;
        let image = rasterizer.render(&objects);
        sensor.sense(image, shot, &mut points).is_ok()
    });
}

/// Frame of a camera on a moving arm: prepare the background, render the objects, apply the
/// sensor model.
#[divan::bench(args = N_OBJECTS)]
fn frame_with_moving_camera(bencher: Bencher<'_, '_>, n_objects: usize) {
    let scene = TableScene::new(n_objects);
    let (Ok(mut rasterizer), Ok(mut sensor)) = (
        rasterizer(&scene, Lights::ROOM),
        KinectSensor::new(CAMERA, SensorModel::KINECT_V1),
    ) else {
        return;
    };
    let (background, objects) = (scene.background(), scene.objects());
    let mut points = vec![Point::default(); CAMERA.n_pixels()];
    let mut shot = FrameSeed::default();
    bencher.bench_local(|| {
        shot.frame_index += 1;
        let stage = StaticScene {
            world_from_camera: TableScene::orbiting_camera(shot.frame_index),
            lights: Lights::ROOM,
            background: &background,
        };
        let is_prepared = rasterizer.prepare(&stage).is_ok();
        let image = rasterizer.render(&objects);
        (is_prepared, sensor.sense(image, shot, &mut points).is_ok())
    });
}

/// Whole scene as one triangle mesh, camera frame.
fn one_mesh(scene: &TableScene) -> Option<TriMesh> {
    let camera_from_world = TableScene::world_from_camera().inverse();
    let (mut vertices, mut indices) = (vec![], vec![]);
    for (mesh, world_from_mesh) in scene.meshes() {
        let first = vertices.len() as u32;
        let camera_from_mesh = camera_from_world * world_from_mesh;
        vertices.extend(mesh.vertices.iter().map(|vertex| {
            let p = (camera_from_mesh * vertex.position.cast::<f64>()).cast::<f32>();
            Vector::new(p.x, p.y, p.z)
        }));
        indices.extend(
            mesh.triangles
                .iter()
                .map(|triangle| triangle.vertices.map(|i| first + i)),
        );
    }
    TriMesh::new(vertices, indices).ok()
}

/// Ray casting of depth only, one ray per pixel.
#[divan::bench(args = N_OBJECTS, sample_count = 5)]
fn ray_cast_depth_only(bencher: Bencher<'_, '_>, n_objects: usize) {
    let Some(mesh) = one_mesh(&TableScene::new(n_objects)) else {
        return;
    };
    let mut depth_m = vec![0.0_f32; CAMERA.n_pixels()];
    bencher.bench_local(|| {
        for (pixel, depth_m) in depth_m.iter_mut().enumerate() {
            let (column, row) = (pixel % 640, pixel / 640);
            let ray = CAMERA.ray(column as f64, row as f64).cast::<f32>();
            let ray = Ray::new(Vector::new(0.0, 0.0, 0.0), Vector::new(ray.x, ray.y, ray.z));
            *depth_m = mesh
                .cast_local_ray(&ray, 20.0, true)
                .unwrap_or(f32::INFINITY);
        }
        depth_m[0]
    });
}
