//! Report of a task in words: what was done, what was not, and why.

use crate::selection::{LeftObject, LeftReason, TaskGoal};
use crate::step::{CarryStep, StepState};

/// Report of a task with its steps and the objects that are left.
pub fn report(goal: &TaskGoal, steps: &[CarryStep], left: &[LeftObject]) -> String {
    let mut sentences = vec![done(steps)];
    let is_worth_a_word = |object: &&LeftObject| match &object.reason {
        LeftReason::AtItsPlace | LeftReason::NotWanted => false,
        LeftReason::StandardItem
        | LeftReason::SetAside(_)
        | LeftReason::NoPlace
        | LeftReason::Unnamed
        | LeftReason::NameNeeded
        | LeftReason::Carries(_)
        | LeftReason::NotSeen => true,
    };
    let words = left.iter().filter(is_worth_a_word).map(left_words);
    sentences.extend(words);
    if steps.is_empty() && sentences.len() == 1 {
        match goal {
            TaskGoal::FetchCategory { category, .. } => {
                return format!("No {category} is seen on the table.");
            }
            TaskGoal::FetchTrack { track, .. } => {
                return format!("Object {track} is not seen on the table.");
            }
            TaskGoal::ClearTable => {}
        }
    }
    sentences.join(" ")
}

/// Objects that were carried to their places, as a sentence.
fn done(steps: &[CarryStep]) -> String {
    let succeeded = steps
        .iter()
        .filter(|step| step.state == StepState::Succeeded);
    let words: Vec<String> = succeeded
        .map(|step| {
            let name = object_words(step.track, step.label.as_deref());
            format!("{name} to {}", step.place)
        })
        .collect();
    match words.as_slice() {
        [] => "Nothing was moved.".to_owned(),
        words => format!("Carried {}.", words.join(", ")),
    }
}

/// Object in words, with its track-id.
pub fn object_words(track: u64, label: Option<&str>) -> String {
    label.map_or_else(
        || format!("unknown object {track}"),
        |label| format!("{label} {track}"),
    )
}

/// Object that was left, as a sentence.
pub fn left_words(object: &LeftObject) -> String {
    let name = object_words(object.track, object.label.as_deref());
    let why = match &object.reason {
        LeftReason::StandardItem => "it is a standard item".to_owned(),
        LeftReason::AtItsPlace => "it stands at its place".to_owned(),
        LeftReason::NotWanted => "the task is not about it".to_owned(),
        LeftReason::SetAside(reason) => format!("all attempts failed, the last since {reason}"),
        LeftReason::NoPlace => "no place of the configuration has it".to_owned(),
        LeftReason::Unnamed => "nobody has named it".to_owned(),
        LeftReason::NameNeeded => "it needs a name".to_owned(),
        LeftReason::Carries(other) => format!("object {other} lies on it"),
        LeftReason::NotSeen => "it is not seen".to_owned(),
    };
    format!("Left {name}: {why}.")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::tests::step;

    #[test]
    fn report_tells_what_was_done_and_what_was_not() {
        let steps = [step(4, StepState::Failed), step(4, StepState::Succeeded)];
        let left = |track, reason| LeftObject {
            track,
            label: None,
            reason,
        };
        let all = [
            left(
                5,
                LeftReason::SetAside("the fingers closed on nothing".to_owned()),
            ),
            left(6, LeftReason::AtItsPlace),
        ];
        assert_eq!(
            report(&TaskGoal::ClearTable, &steps, &all),
            "Carried mug 4 to shelf. Left unknown object 5: all attempts failed, the last since the \
             fingers closed on nothing."
        );
        assert_eq!(
            report(&TaskGoal::ClearTable, &[], &[]),
            "Nothing was moved."
        );
    }

    #[test]
    fn absent_category_is_a_sentence() {
        let goal = TaskGoal::FetchCategory {
            category: "spoon".to_owned(),
            place: "hand-over".to_owned(),
        };
        assert_eq!(report(&goal, &[], &[]), "No spoon is seen on the table.");
    }
}
