//! Single-core detection time per frame.
//!
//! `detect_rendered` needs no data; `detect_real` runs on the labelled scenes in
//! `TABULA_DATA` and is skipped without them.

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use dataset::pcd;
use detection::{Config, Detection, DetectionInput, Execution, ScenePriors, Workspace, detect};
use divan::Bencher;
use point_cloud::{OrganizedCloud, Point};
use synthetic::{BoxOnTable, camera_from_table, render};

fn main() {
    divan::main();
}

fn bench_detect(bencher: Bencher<'_, '_>, points: &[Point]) {
    if let Ok(cloud) = OrganizedCloud::new(points, 640, 480) {
        bench_cloud(bencher, cloud);
    }
}

fn bench_cloud(bencher: Bencher<'_, '_>, cloud: OrganizedCloud<'_>) {
    let (mut workspace, mut detection) = (Workspace::default(), Detection::default());
    let config = Config::default();
    bencher.bench_local(|| {
        let frame = DetectionInput {
            cloud,
            up_in_camera: None,
            priors: ScenePriors::default(),
        };
        detect(
            &frame,
            &config,
            &mut workspace,
            &mut detection,
            Execution::default(),
        )
        .is_ok()
    });
}

fn rendered() -> Vec<Point> {
    let solid = |x: f64| BoxOnTable {
        centre: [x, 0.0],
        bottom: 0.0,
        sides: [0.1, 0.07, 0.12],
        rgb: [5; 3],
    };
    render(&[solid(-0.3), solid(0.0), solid(0.25)], 1.0)
}

#[divan::bench]
fn detect_rendered(bencher: Bencher<'_, '_>) {
    bench_detect(bencher, &rendered());
}

/// Rendered view without its empty pixels: in the camera frame, where it takes the image
/// path, or in the table's frame, where it takes the voxel path.
#[divan::bench(args = [true, false])]
fn detect_without_grid(bencher: Bencher<'_, '_>, in_camera: bool) {
    let table_from_camera = camera_from_table().inverse();
    let mut points = rendered();
    points.retain(Point::is_finite);
    for point in points.iter_mut().filter(|_| !in_camera) {
        let p = table_from_camera * point.position();
        (point.x, point.y, point.z) = (p.x as f32, p.y as f32, p.z as f32);
    }
    if let Ok(cloud) = OrganizedCloud::new(&points, points.len(), 1) {
        bench_cloud(bencher, cloud);
    }
}

/// Labelled scenes: three boxes, a stack, cylinders, clutter.
#[divan::bench(args = [13, 22, 36, 44])]
fn detect_real(bencher: Bencher<'_, '_>, scene: usize) {
    let path = test_data::find(&format!("tabletop-scenes/learn{scene}.pcd"));
    if let Some(Ok(scene)) = path.map(|path| pcd::open(&path)) {
        bench_detect(bencher, &scene.points);
    }
}
