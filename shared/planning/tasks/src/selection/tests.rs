//! Choices among objects with and without names.

use super::*;
use crate::step::tests::step;
use crate::table_object::tests::object;

const CUP: [f64; 3] = [0.08, 0.08, 0.1];

fn place(name: &str, categories: &[&str], x_m: f64) -> NamedPlace {
    let mut corners = [
        Point2::new(x_m, 0.0),
        Point2::new(x_m + 0.2, 0.0),
        Point2::new(x_m + 0.2, 0.2),
        Point2::new(x_m, 0.2),
    ];
    NamedPlace {
        name: name.to_owned(),
        categories: categories.iter().map(|one| (*one).to_owned()).collect(),
        outline: ConvexPolygon::convex_hull_of(&mut corners),
    }
}

fn rules(unnamed: UnnamedPolicy) -> TaskRules {
    TaskRules {
        standard_items: vec!["vase".to_owned()],
        unnamed,
        doubts_are_unnamed: true,
        is_answer_overdue: false,
    }
}

fn select_from(
    goal: &TaskGoal,
    rules: &TaskRules,
    objects: &[TableObject],
    steps: &[CarryStep],
) -> Selection {
    let places = [
        place("shelf", &["cup", "tray"], 1.0),
        place(UNKNOWN_PLACE, &[], 2.0),
    ];
    let view = TaskView {
        objects,
        places: &places,
        steps,
        arm_base: Point2::origin(),
    };
    select(goal, rules, &view)
}

fn tracks(selection: &Selection) -> Vec<u64> {
    selection.next.iter().map(|next| next.track).collect()
}

fn reason(selection: &Selection, track: u64) -> Option<&LeftReason> {
    let mut left = selection.left.iter();
    left.find(|object| object.track == track)
        .map(|object| &object.reason)
}

#[test]
fn nearest_object_comes_first_and_standard_items_stay() {
    let objects = [
        object(1, "cup", [0.5, 0.0, 0.0], CUP),
        object(2, "cup", [0.3, 0.0, 0.0], CUP),
        object(3, "vase", [0.1, 0.0, 0.0], CUP),
        object(4, "cup", [1.1, 0.1, 0.0], CUP),
        object(5, "spoon", [0.2, 0.2, 0.0], CUP),
    ];
    let found = select_from(
        &TaskGoal::ClearTable,
        &rules(UnnamedPolicy::Leave),
        &objects,
        &[],
    );
    assert_eq!(tracks(&found), [2, 1]);
    assert_eq!(found.next[0].place, "shelf");
    assert_eq!(reason(&found, 3), Some(&LeftReason::StandardItem));
    assert_eq!(reason(&found, 4), Some(&LeftReason::AtItsPlace));
    assert_eq!(reason(&found, 5), Some(&LeftReason::NoPlace));
    assert!(!found.is_goal_reached(&TaskGoal::ClearTable, &[]));
}

#[test]
fn what_lies_on_another_thing_goes_first() {
    let tray = object(1, "tray", [0.3, 0.0, 0.0], [0.4, 0.3, 0.02]);
    let on_it = object(2, "cup", [0.45, 0.0, 0.02], CUP);
    let leave = rules(UnnamedPolicy::Leave);
    let found = select_from(
        &TaskGoal::ClearTable,
        &leave,
        &[tray.clone(), on_it.clone()],
        &[],
    );
    assert_eq!(tracks(&found), [2, 1]);
    let failed = vec![step(2, StepState::Failed); 3];
    let found = select_from(&TaskGoal::ClearTable, &leave, &[tray, on_it], &failed);
    assert_eq!(tracks(&found), [] as [u64; 0]);
    assert_eq!(reason(&found, 1), Some(&LeftReason::Carries(2)));
    assert!(matches!(reason(&found, 2), Some(LeftReason::SetAside(_))));
    assert!(!found.is_goal_reached(&TaskGoal::ClearTable, &failed));
}

#[test]
fn unnamed_objects_follow_the_policy() {
    let objects = [object(1, "", [0.3, 0.0, 0.0], CUP)];
    let by = |rules: &TaskRules| select_from(&TaskGoal::ClearTable, rules, &objects, &[]);
    let asked = by(&rules(UnnamedPolicy::Ask));
    assert_eq!(asked.need_names().collect::<Vec<_>>(), [1]);
    let overdue = TaskRules {
        is_answer_overdue: true,
        ..rules(UnnamedPolicy::Ask)
    };
    assert_eq!(reason(&by(&overdue), 1), Some(&LeftReason::Unnamed));
    assert_eq!(
        reason(&by(&rules(UnnamedPolicy::Leave)), 1),
        Some(&LeftReason::Unnamed)
    );
    let carried = by(&rules(UnnamedPolicy::UnknownPlace));
    assert_eq!(
        (tracks(&carried), &*carried.next[0].place),
        (vec![1], UNKNOWN_PLACE)
    );
}

#[test]
fn doubtful_name_counts_by_the_rules() {
    let mut doubtful = object(1, "cup", [0.3, 0.0, 0.0], CUP);
    doubtful.answer = CategoryAnswer::Probably;
    let strict = rules(UnnamedPolicy::Leave);
    let lenient = TaskRules {
        doubts_are_unnamed: false,
        ..strict.clone()
    };
    let by = |rules| select_from(&TaskGoal::ClearTable, rules, &[doubtful.clone()], &[]);
    assert_eq!(reason(&by(&strict), 1), Some(&LeftReason::Unnamed));
    assert_eq!(tracks(&by(&lenient)), [1]);
}

#[test]
fn one_object_is_fetched() {
    let objects = [
        object(1, "cup", [0.5, 0.0, 0.0], CUP),
        object(2, "cup", [0.3, 0.0, 0.0], CUP),
    ];
    let goal = TaskGoal::FetchCategory {
        category: "cup".to_owned(),
        place: UNKNOWN_PLACE.to_owned(),
    };
    let leave = rules(UnnamedPolicy::Leave);
    assert_eq!(tracks(&select_from(&goal, &leave, &objects, &[])), [2, 1]);
    let done = [step(2, StepState::Succeeded)];
    let found = select_from(&goal, &leave, &objects, &done);
    assert!(found.next.is_empty() && found.is_goal_reached(&goal, &done));
    assert!(!found.is_goal_reached(&goal, &[]));
    let goal = TaskGoal::FetchTrack {
        track: 1,
        place: UNKNOWN_PLACE.to_owned(),
    };
    assert_eq!(tracks(&select_from(&goal, &leave, &objects, &[])), [1]);
}
