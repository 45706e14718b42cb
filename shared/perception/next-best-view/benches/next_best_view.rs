//! Benchmark of view planning: 100 candidate views of 15 objects on a table.

use divan::{Bencher, black_box};
use geometry::RigidTransform;
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use next_best_view::{
    CandidateViews, Config, Hypothesis, OccupancyGrid, PlanningScene, RenderConfig, SurfaceModel,
    ViewPlanner, VirtualView,
};
use point_cloud::Point;
use random::Random;

/// Spacing of the models: that of the cells, metres.
const SPACING_M: f64 = 0.003;

fn main() {
    divan::main();
}

/// Boxes with sides of 4 to 15 cm.
fn models(n: usize, random: &mut Random) -> Vec<SurfaceModel> {
    let mut model = || {
        let sides = [(); 3].map(|()| random.between(0.04, 0.15) as f32);
        let mesh = mesh::rounded_box(sides, 0.004, 0.1).mesh;
        SurfaceModel::of_mesh(&mesh, SPACING_M).ok()
    };
    (0..n).filter_map(|_| model()).collect()
}

/// Table of 60 by 50 cm.
fn table() -> Vec<[f32; 3]> {
    let spot = |i: u16| {
        [
            f32::from(i % 200) * 0.003 - 0.3,
            f32::from(i / 200) * 0.003 - 0.25,
            0.0,
        ]
    };
    (0..200 * 166).map(spot).collect()
}

/// Camera poses evenly over the upper hemisphere, 80 cm away.
fn cameras(n: u32) -> Vec<RigidTransform> {
    let pose = |i: u32| {
        let z = (f64::from(i) + 0.5) / f64::from(n);
        let angle = f64::from(i) * 2.399_963;
        let ring = (1.0 - z * z).sqrt();
        let eye = Point3::new(ring * angle.cos(), ring * angle.sin(), z) * 0.8;
        RigidTransform::face_towards(&eye, &Point3::origin(), &-Vector3::z())
    };
    (0..n).map(pose).collect()
}

fn scene() -> Option<PlanningScene> {
    let mut random = Random::from_seed(3);
    let models = models(15, &mut random);
    let mut number = 0;
    let hypotheses: Vec<Hypothesis<'_>> = models
        .iter()
        .map(|model| {
            number += 1;
            let [x, y] = [random.between(-0.18, 0.18), random.between(-0.15, 0.15)];
            let turn = Vector3::from_fn(|_, _| random.between(-2.0, 2.0));
            let rotation = UnitQuaternion::from_scaled_axis(turn);
            Hypothesis {
                id: number,
                model,
                world_from_object: RigidTransform::from_parts(
                    Translation3::new(x, y, 0.08),
                    rotation,
                ),
            }
        })
        .collect();
    PlanningScene::new(&hypotheses, &table()).ok()
}

/// One virtual view.
#[divan::bench]
fn virtual_view(bencher: Bencher<'_, '_>) {
    let (scene, cameras) = (scene(), cameras(100));
    let mut view = VirtualView::default();
    bencher.bench_local(|| {
        let scene = scene.as_ref()?;
        view.render(black_box(scene), &cameras[20], &RenderConfig::default())
            .ok()
    });
}

/// Scores of 100 candidate views by entropy and distance.
#[divan::bench]
fn virtual_views(bencher: Bencher<'_, '_>) {
    let (scene, cameras) = (scene(), cameras(100));
    let mut planner = ViewPlanner::default();
    bencher.bench_local(|| {
        let views = CandidateViews {
            world_from_candidates: &cameras,
            world_from_current: cameras[0],
            world_from_visited: &cameras[..3],
        };
        let scores = planner.score(black_box(scene.as_ref()?), &views, &Config::default(), None);
        scores.ok().map(<[_]>::len)
    });
}

/// Scores of 100 candidate views with the unknown voxels of 1 cm that they would see.
#[divan::bench]
fn information_gain(bencher: Bencher<'_, '_>) {
    let (scene, cameras) = (scene(), cameras(100));
    let corners = [
        Point3::new(-0.3, -0.25, -0.02),
        Point3::new(0.3, 0.25, 0.28),
    ];
    let grid = OccupancyGrid::new(corners[0], corners[1], 0.01).ok();
    let points: Vec<Point> = table()
        .iter()
        .map(|&[x, y, z]| {
            let p = cameras[60].inverse() * Point3::new(x, y, z).cast::<f64>();
            let [x, y, z] = [p.x as f32, p.y as f32, p.z as f32];
            Point {
                x,
                y,
                z,
                ..Point::default()
            }
        })
        .collect();
    let grid = grid.and_then(|mut grid| {
        grid.observe(&points, &cameras[60]).ok()?;
        Some(grid)
    });
    let mut planner = ViewPlanner::default();
    bencher.bench_local(|| {
        let views = CandidateViews {
            world_from_candidates: &cameras,
            world_from_current: cameras[0],
            world_from_visited: &[],
        };
        let config = Config::default();
        let scores = planner.score(black_box(scene.as_ref()?), &views, &config, grid.as_ref());
        scores.ok().map(<[_]>::len)
    });
}
