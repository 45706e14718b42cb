use super::*;
use crate::candidate_poses::hemisphere;
use geometry::{PinholeCamera, Plane};
use nalgebra::Point3;
use next_best_view::{SurfaceModel, ViewSelection};
use scene_client::{HypothesisSource, ObjectHypothesis};
use std::rc::Rc;

const CELL_M: f64 = 0.003;

fn looking_from(x: f64, y: f64, z: f64) -> RigidTransform {
    let eye = Point3::new(x, y, z);
    RigidTransform::face_towards(&eye, &Point3::origin(), &-Vector3::z())
}

/// Two boxes in a row along x, of which a camera along the row sees one, on a table.
struct Row(PlanContent);

impl Row {
    fn new() -> Self {
        let mesh = mesh::rounded_box([0.1; 3], 0.004, 0.1).mesh;
        let surface = Rc::new(SurfaceModel::of_mesh(&mesh, CELL_M).unwrap());
        let hypothesis = |(track, x)| ObjectHypothesis {
            track,
            label: None,
            source: HypothesisSource::Measured,
            surface: surface.clone(),
            plan_from_object: RigidTransform::translation(x, 0.0, 0.0),
            note: String::new(),
        };
        let spot = |i: u16| {
            let (column, row) = (f32::from(i % 200), f32::from(i / 200));
            [0.003 * column - 0.3, 0.003 * row - 0.3, -0.05]
        };
        Self(PlanContent {
            frame: PlanningFrame {
                world_from_plan: RigidTransform::identity(),
                plan_from_camera: looking_from(0.8, 0.0, 0.02),
                table_in_plan: Some(Plane::through(
                    &Point3::new(0.0, 0.0, -0.05),
                    Vector3::z_axis(),
                )),
                notes: Vec::new(),
            },
            hypotheses: [(7, -0.1), (9, 0.1)].map(hypothesis).into(),
            background: (0..40_000).map(spot).collect(),
            camera: PinholeCamera::KINECT_V1,
            occupancy: None,
            cell_m: CELL_M,
        })
    }

    fn plan(
        &self,
        candidates: &[RigidTransform],
        visited: &[RigidTransform],
        settings: PlanSettings,
    ) -> Result<ViewPlan, Failure> {
        plan(
            &self.0,
            candidates,
            visited,
            &settings,
            &mut Random::from_seed(1),
        )
    }
}

#[test]
fn plan_chooses_a_view_beside_the_row_that_shows_both_boxes() {
    let row = Row::new();
    let candidates = hemisphere(60, 0.8, 0.1);
    let default = PlanSettings::default();
    let perspective = PlanSettings {
        is_perspective: true,
        ..default
    };
    let segmented = PlanSettings {
        is_segmented: true,
        ..default
    };
    for settings in [default, perspective, segmented] {
        let plan = row.plan(&candidates, &[], settings).unwrap();
        let chosen = &plan.views[plan.chosen];
        assert_eq!(plan.present.n_objects_seen, 1, "{settings:?}");
        assert_eq!(chosen.n_objects_seen, 2, "{settings:?}");
        assert_eq!((chosen.rank, plan.reason), (Some(1), ChoiceReason::Utility));
        assert!(
            chosen.score.entropy > plan.present.score.entropy + 0.1,
            "{settings:?}"
        );
        let [[first_now, first_then], [second_now, _]] = plan.shares[..] else {
            panic!("{:?}", plan.shares)
        };
        assert!(first_now < 0.1 && second_now > 0.99, "{:?}", plan.shares);
        assert!(first_then > 0.5, "{:?}", plan.shares);
    }
}

#[test]
fn plan_leaves_out_what_is_visited_blocked_or_below_the_table() {
    let row = Row::new();
    let beside = looking_from(0.0, 0.8, 0.1);
    let candidates = [
        beside,
        looking_from(0.8, 0.0, 0.02),
        looking_from(0.12, 0.01, 0.0),
        looking_from(0.0, 0.6, -0.4),
        looking_from(0.6, 0.6, 0.3),
    ];
    let plan = row
        .plan(&candidates, &[beside], PlanSettings::default())
        .unwrap();
    let states: Vec<ViewState> = plan.views.iter().map(|view| view.state).collect();
    let expected = [
        ViewState::Visited,
        ViewState::Visited,
        ViewState::Blocked,
        ViewState::BelowTable,
        ViewState::Open,
    ];
    assert_eq!(states, expected);
    assert_eq!((plan.chosen, plan.views[4].rank), (4, Some(1)));
    assert!(plan.views[..4].iter().all(|view| view.rank.is_none()));
    let refused = row
        .plan(&candidates[..4], &[beside], PlanSettings::default())
        .unwrap_err();
    assert!(
        refused.sentence.starts_with(
            "none of the 4 candidate views is left: 2 were visited, 1 are inside an object or at \
             a surface, and 1 are below the table"
        ),
        "{refused}"
    );
}

#[test]
fn reachable_views_far_from_the_present_one_are_told_apart_by_their_entropy() {
    let row = Row::new();
    // All on the other side, and near each other; one of them sees one box only.
    let candidates = [
        looking_from(-0.8, 0.0, 0.02),
        looking_from(-0.75, 0.3, 0.1),
        looking_from(-0.72, 0.35, 0.1),
    ];
    let plan = row.plan(&candidates, &[], PlanSettings::default()).unwrap();
    assert_eq!(plan.reason, ChoiceReason::Utility);
    assert!(
        plan.chosen != 0 && plan.views[0].rank == Some(3),
        "{:?}",
        plan.views
    );
    let alone = row
        .plan(&candidates[..1], &[], PlanSettings::default())
        .unwrap();
    assert_eq!((alone.chosen, alone.reason), (0, ChoiceReason::Utility));
    assert!(alone.views[0].score.weight > 0.01, "{:?}", alone.views);
}

#[test]
fn drawn_views_differ_and_a_great_exponent_is_greedy() {
    let row = Row::new();
    let candidates = hemisphere(30, 0.8, 0.3);
    let mut random = Random::from_seed(5);
    let mut draw = |selection| {
        let settings = PlanSettings {
            selection,
            ..PlanSettings::default()
        };
        let plan = plan(&row.0, &candidates, &[], &settings, &mut random);
        plan.unwrap().chosen
    };
    let sampled = |beta| ViewSelection::Sampled { beta };
    let greedy = draw(ViewSelection::Greedy);
    let drawn: Vec<usize> = (0..8).map(|_| draw(sampled(1.0))).collect();
    assert!(drawn.iter().any(|&view| view != drawn[0]), "{drawn:?}");
    let sharp = (0..8).map(|_| draw(sampled(100.0)));
    assert!(sharp.filter(|&view| view == greedy).count() >= 4);
}
