use super::CandidateState::{Blocked, Open, Visited};
use super::*;
use crate::{
    ChoiceReason, Hypothesis, RenderConfig, SurfaceModel, TotalArea, ViewProjection, ViewSelection,
    choose_view,
};
use geometry::RigidTransform;
use nalgebra::{Point3, Vector3};
use point_cloud::Point;
use random::Random;

/// Rule of the paper: weight by distance, and nothing else.
const PLAIN: Config = Config {
    render: RenderConfig {
        projection: ViewProjection::Orthographic { cell_m: 0.003 },
        splat_radius: 1,
        tolerance_m: 0.005,
        near_m: 0.05,
    },
    total_area: TotalArea::Visible,
    log_base: 2.0,
    sigma_share: 0.35,
    visited_share: 0.0,
    gain_weight: 0.0,
};

fn cube() -> SurfaceModel {
    SurfaceModel::of_mesh(&mesh::rounded_box([0.1; 3], 0.002, 0.1).mesh, 0.003).unwrap()
}

fn camera(azimuth: f64, distance_m: f64) -> RigidTransform {
    let eye = Point3::new(azimuth.cos(), azimuth.sin(), 0.3) * distance_m;
    RigidTransform::face_towards(&eye, &Point3::origin(), &-Vector3::z())
}

fn ring(n: u32) -> Vec<RigidTransform> {
    (0..n)
        .map(|i| camera(f64::from(i) * std::f64::consts::TAU / f64::from(n), 1.0))
        .collect()
}

fn scene_of(model: &SurfaceModel) -> PlanningScene {
    let at = |id, x| Hypothesis {
        id,
        model,
        world_from_object: RigidTransform::translation(x, 0.0, 0.0),
    };
    PlanningScene::new(&[at(1, -0.1), at(2, 0.1)], &[]).unwrap()
}

fn views<'a>(
    candidates: &'a [RigidTransform],
    visited: &'a [RigidTransform],
) -> CandidateViews<'a> {
    CandidateViews {
        world_from_candidates: candidates,
        world_from_current: candidates[0],
        world_from_visited: visited,
    }
}

#[test]
fn current_and_visited_views_are_never_chosen() {
    let candidates = ring(12);
    let visited = [candidates[1], candidates[11], candidates[6]];
    let mut planner = ViewPlanner::default();
    let views = views(&candidates, &visited);
    let scene = scene_of(&cube());
    let scores = planner.score(&scene, &views, &PLAIN, None).unwrap();
    // The weight alone would choose the current view.
    let heaviest = (0..12).max_by(|&a, &b| scores[a].weight.total_cmp(&scores[b].weight));
    assert_eq!((heaviest, scores[0].weight), (Some(0), 1.0));
    for closed in [0, 1, 6, 11] {
        assert_eq!(scores[closed].state, Visited);
    }
    let mut random = Random::from_seed(1);
    for selection in [
        ViewSelection::Greedy,
        ViewSelection::Least,
        ViewSelection::Sampled { beta: 1.0 },
    ] {
        for _ in 0..200 {
            let choice = choose_view(scores, selection, &mut random).unwrap();
            assert!(![0, 1, 6, 11].contains(&choice.candidate));
        }
    }
}

#[test]
fn views_across_a_row_have_more_entropy_and_near_ones_more_weight() {
    let candidates = ring(16);
    let mut planner = ViewPlanner::default();
    let model = cube();
    let scene = scene_of(&model);
    let views = views(&candidates, &[]);
    let far = Config {
        sigma_share: 1000.0,
        ..PLAIN
    };
    let scores = planner.score(&scene, &views, &far, None).unwrap();
    // Candidate 4 looks across the row of two boxes, candidate 0 and 8 along it.
    assert!(scores[4].entropy > 0.99 && scores[4].entropy <= 1.0 + 1e-9);
    assert!(scores[0].entropy < 0.95 && scores[8].entropy < 0.95);
    assert!(scores.iter().all(|score| score.weight > 0.999));
    let scores = planner.score(&scene, &views, &PLAIN, None).unwrap();
    for (near, far) in [(1, 2), (2, 4), (4, 8), (15, 14)] {
        assert!(scores[near].weight > scores[far].weight);
        assert!(scores[near].distance_m < scores[far].distance_m);
    }
    assert!((scores[4].utility - scores[4].weight * scores[4].entropy).abs() < 1e-12);
}

#[test]
fn camera_inside_an_object_or_at_the_table_is_blocked() {
    let model = cube();
    let at = Hypothesis {
        id: 1,
        model: &model,
        world_from_object: RigidTransform::identity(),
    };
    let table: Vec<[f32; 3]> = (0..400_u16)
        .map(|i| {
            [
                f32::from(i % 20) * 0.02 - 0.2,
                f32::from(i / 20) * 0.02 - 0.2,
                -0.3,
            ]
        })
        .collect();
    let scene = PlanningScene::new(&[at], &table).unwrap();
    let inside = RigidTransform::translation(0.01, 0.0, 0.02);
    let at_table = RigidTransform::translation(0.005, 0.0, -0.28);
    let candidates = [camera(0.0, 1.0), inside, at_table, camera(1.0, 1.0)];
    let mut planner = ViewPlanner::default();
    let views = views(&candidates, &[]);
    let scores = planner.score(&scene, &views, &PLAIN, None).unwrap();
    let states: Vec<_> = scores.iter().map(|score| score.state).collect();
    assert_eq!(states, [Visited, Blocked, Blocked, Open]);
}

#[test]
fn without_hypotheses_the_view_of_unknown_space_is_chosen_else_the_farthest() {
    let scene = PlanningScene::new(&[], &[[0.0; 3], [f32::NAN; 3]]).unwrap();
    let candidates = ring(9);
    let views = views(&candidates, &[]);
    let mut planner = ViewPlanner::default();
    let mut random = Random::from_seed(1);
    let scores = planner.score(&scene, &views, &PLAIN, None).unwrap();
    let choice = choose_view(scores, ViewSelection::Greedy, &mut random).unwrap();
    assert_eq!(choice.reason, ChoiceReason::Distance);
    assert!([4, 5].contains(&choice.candidate), "{choice:?}");
    // A wall that hides the half behind it from the current camera at +x.
    let (least, greatest) = (Point3::new(-0.2, -0.2, -0.2), Point3::new(0.2, 0.2, 0.2));
    let mut grid = OccupancyGrid::new(least, greatest, 0.02).unwrap();
    let wall: Vec<Point> = (0..10_000)
        .map(|i| {
            let [y, z] = [i % 100, i / 100].map(|k| f64::from(k) * 0.01 - 0.5);
            let p = candidates[0].inverse() * Point3::new(0.001, y, z);
            let [x, y, z] = [p.x as f32, p.y as f32, p.z as f32];
            Point {
                x,
                y,
                z,
                ..Point::default()
            }
        })
        .collect();
    grid.observe(&wall, &candidates[0]).unwrap();
    let scores = planner.score(&scene, &views, &PLAIN, Some(&grid)).unwrap();
    assert!(scores[0].gain < 0.05 && scores[4].gain > 0.9);
    assert!(scores.iter().all(|score| (0.0..=1.0).contains(&score.gain)));
    let choice = choose_view(scores, ViewSelection::Greedy, &mut random).unwrap();
    assert_eq!(choice.reason, ChoiceReason::InformationGain);
    assert!([3, 4, 5, 6].contains(&choice.candidate), "{choice:?}");
    let weighted = Config {
        gain_weight: 2.0,
        ..PLAIN
    };
    let scores = planner
        .score(&scene, &views, &weighted, Some(&grid))
        .unwrap();
    let expected = scores[4].weight * 2.0 * scores[4].gain;
    assert!((scores[4].utility - expected).abs() < 1e-12);
}

#[test]
fn impossible_candidates_and_settings_are_refused_with_a_sentence() {
    let model = cube();
    let scene = scene_of(&model);
    let mut planner = ViewPlanner::default();
    let mut refused = |candidates: &[RigidTransform], current: RigidTransform, config: Config| {
        let views = CandidateViews {
            world_from_candidates: candidates,
            world_from_current: current,
            world_from_visited: &[],
        };
        planner
            .score(&scene, &views, &config, None)
            .unwrap_err()
            .to_string()
    };
    let (good, config) = (camera(0.0, 1.0), PLAIN);
    let nowhere = RigidTransform::translation(0.0, f64::INFINITY, 0.0);
    assert!(refused(&[], good, config).contains("no candidate view"));
    assert!(refused(&[good, nowhere], good, config).contains("candidate view 1 is not finite"));
    assert!(refused(&[good], nowhere, config).contains("current"));
    assert!(refused(&[good, camera(0.0, 1e6)], good, config).contains("100 m"));
    for broken in [
        Config {
            log_base: 1.0,
            ..config
        },
        Config {
            sigma_share: f64::NAN,
            ..config
        },
        Config {
            gain_weight: -1.0,
            ..config
        },
    ] {
        assert!(refused(&[good], good, broken).contains("must lie between"));
    }
}

#[test]
fn penalty_near_visited_views_leaves_the_views_between_them() {
    let candidates = ring(16);
    let visited = [candidates[8]];
    let model = cube();
    let scene = scene_of(&model);
    let penalised = Config {
        sigma_share: 1000.0,
        visited_share: 0.2,
        ..PLAIN
    };
    let mut planner = ViewPlanner::default();
    let views = views(&candidates, &visited);
    let scores = planner.score(&scene, &views, &penalised, None).unwrap();
    assert_eq!((scores[0].weight, scores[8].weight), (0.0, 0.0));
    for (near, far) in [(1, 2), (2, 4), (7, 6), (6, 4), (15, 12), (9, 12)] {
        assert!(scores[near].weight < scores[far].weight, "{near} {far}");
    }
}
