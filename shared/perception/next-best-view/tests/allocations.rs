//! Allocation test: scoring and choosing in steady state allocate nothing.

use allocation_counter::CountingAllocator;
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::{Point3, Vector3};
use next_best_view::{
    CandidateViews, Config, Hypothesis, OccupancyGrid, PlanningScene, RenderConfig, SurfaceModel,
    ViewPlanner, ViewProjection, ViewSelection, choose_view,
};
use random::Random;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Number of allocations of this thread.
fn n_allocations() -> u64 {
    CountingAllocator::counts_of_thread().0
}

/// Table below the objects.
fn background() -> Vec<[f32; 3]> {
    let place = |i: u16| f32::from(i) * 0.01 - 0.25;
    (0..2500_u16)
        .map(|i| [place(i % 50), place(i / 50), -0.06])
        .collect()
}

/// Cameras on a spiral around the objects.
fn candidates() -> Vec<RigidTransform> {
    let pose = |i: u32| {
        let angle = f64::from(i) * 0.3;
        let eye = Point3::new(angle.cos(), angle.sin(), 0.2 + 0.05 * f64::from(i));
        RigidTransform::face_towards(&eye, &Point3::origin(), &-Vector3::z())
    };
    (0..20).map(pose).collect()
}

#[test]
fn planning_allocates_nothing_in_steady_state() {
    let mesh = mesh::rounded_box([0.12, 0.08, 0.05], 0.004, 0.1).mesh;
    let model = SurfaceModel::of_mesh(&mesh, 0.003).unwrap();
    let (background, candidates) = (background(), candidates());
    let corners = [Point3::new(-0.3, -0.3, -0.1), Point3::new(0.3, 0.3, 0.2)];
    let grid = OccupancyGrid::new(corners[0], corners[1], 0.02).unwrap();
    let pinhole = PinholeCamera {
        fx_px: 146.25,
        fy_px: 146.25,
        cx_px: 79.5,
        cy_px: 59.5,
        width: 160,
        height: 120,
    };
    let projections = [
        ViewProjection::default(),
        ViewProjection::Perspective(pinhole),
    ];
    let mut scene = PlanningScene::default();
    let (mut planner, mut random) = (ViewPlanner::default(), Random::from_seed(1));
    for round in 0..8 {
        let at = |id: u32, x: f64| Hypothesis {
            id,
            model: &model,
            world_from_object: RigidTransform::translation(x, 0.01 * f64::from(round % 2), 0.0),
        };
        let hypotheses = [at(3, -0.1), at(1, 0.1), at(2, 0.0)];
        let before = n_allocations();
        scene.fill(&hypotheses, &background).unwrap();
        for projection in projections {
            let config = Config {
                render: RenderConfig {
                    projection,
                    ..RenderConfig::default()
                },
                gain_weight: 1.0,
                ..Config::default()
            };
            let views = CandidateViews {
                world_from_candidates: &candidates,
                world_from_current: candidates[0],
                world_from_visited: &candidates[1..3],
            };
            let scores = planner.score(&scene, &views, &config, Some(&grid)).unwrap();
            for selection in [ViewSelection::Greedy, ViewSelection::Sampled { beta: 1.0 }] {
                choose_view(scores, selection, &mut random).unwrap();
            }
        }
        let n = n_allocations() - before;
        assert!(round < 2 || n == 0, "{n} allocations in round {round}");
    }
}
