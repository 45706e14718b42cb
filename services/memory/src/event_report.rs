//! Conversion of world events to their documents.

use crate::task_report::{step_word, word};
use crate::world_report::answer;
use control_protocol::{Command, LearningReport};
use scene_document::{CategoryAnswer, EventDocument};
use working_memory::{Event, EventKind, Lesson, LessonKind, StepChange};

/// Document of a world-model event.
pub(crate) fn event(event: &Event) -> EventDocument {
    let document = match &event.kind {
        EventKind::Lesson(lesson) => of_lesson(lesson),
        EventKind::ActionEnded {
            command_id,
            outcome,
            note,
        } => EventDocument {
            event: format!("action_{}", word(*outcome)),
            command_id: Some(*command_id),
            reason: note.clone(),
            ..EventDocument::default()
        },
        EventKind::TaskStarted { task, kind } => of_task("started", *task, kind),
        EventKind::TaskEnded {
            task,
            kind,
            outcome,
            reason,
        } => EventDocument {
            reason: reason.clone(),
            ..of_task(word(*outcome), *task, kind)
        },
        EventKind::TaskStep(change) => of_step(change),
        kind => of_object(kind),
    };
    EventDocument {
        sequence: event.sequence,
        wall_ns: event.wall_ns,
        ..document
    }
    .in_words()
}

/// Learning event of a command, once it is answered; `None` for a command that changes no
/// label.
pub(crate) fn lesson(command: &Command) -> Option<impl FnOnce(&LearningReport) -> Lesson + use<>> {
    let (lesson, track_id, author) = match command {
        Command::Teach(label) => (LessonKind::Taught, Some(label.track_id), &label.author),
        Command::Correct(label) => (LessonKind::Corrected, Some(label.track_id), &label.author),
        Command::Forget { author, .. } => (LessonKind::Forgot, None, author),
        _ => return None,
    };
    let author = author.clone();
    Some(move |report: &LearningReport| Lesson {
        kind: lesson,
        category: report.category.clone(),
        track_id,
        author,
        history: report.sequence,
    })
}

fn of_task(what: &str, task: u64, kind: &str) -> EventDocument {
    EventDocument {
        event: format!("task_{what}"),
        task_id: Some(task),
        task_kind: Some(kind.to_owned()),
        ..EventDocument::default()
    }
}

fn of_step(change: &StepChange) -> EventDocument {
    EventDocument {
        event: format!("step_{}", step_word(change.state)),
        track_id: Some(change.track_id),
        task_id: Some(change.task),
        task_kind: Some(change.kind.clone()),
        step: Some(change.step),
        primitive: Some(change.primitive.clone()),
        reason: change.reason.clone(),
        ..EventDocument::default()
    }
}

fn of_lesson(lesson: &Lesson) -> EventDocument {
    let event = match lesson.kind {
        LessonKind::Taught => "taught",
        LessonKind::Corrected => "corrected",
        LessonKind::Forgot => "forgot",
    };
    EventDocument {
        event: event.to_owned(),
        track_id: lesson.track_id,
        label: Some(lesson.category.clone()),
        answer: CategoryAnswer::Is,
        author: Some(lesson.author.clone()),
        history_sequence: Some(lesson.history),
        ..EventDocument::default()
    }
}

/// Document of an event of an object, or of the start of the memory.
fn of_object(kind: &EventKind) -> EventDocument {
    let about = |event: &str, track_id: u64, label: &Option<String>, is_probable| EventDocument {
        event: event.to_owned(),
        track_id: Some(track_id),
        label: label.clone(),
        answer: answer(label.as_ref(), is_probable),
        ..EventDocument::default()
    };
    match kind {
        EventKind::Appeared {
            track_id,
            label,
            is_probable,
            position_m,
        } => EventDocument {
            position_m: Some(*position_m),
            ..about("appeared", *track_id, label, *is_probable)
        },
        EventKind::Vanished {
            track_id,
            label,
            is_probable,
        } => about("vanished", *track_id, label, *is_probable),
        EventKind::Relabelled {
            track_id,
            before,
            after,
            before_is_probable,
            after_is_probable,
        } => EventDocument {
            label_before: before.clone(),
            answer_before: answer(before.as_ref(), *before_is_probable),
            ..about("relabelled", *track_id, after, *after_is_probable)
        },
        EventKind::Moved {
            track_id,
            from_m,
            to_m,
        } => EventDocument {
            from_m: Some(*from_m),
            position_m: Some(*to_m),
            ..about("moved", *track_id, &None, false)
        },
        EventKind::Question {
            track_id,
            category,
            sentence,
        } => EventDocument {
            sentence: sentence.clone(),
            ..about("question", *track_id, category, true)
        },
        _ => EventDocument {
            event: "started".to_owned(),
            ..EventDocument::default()
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use working_memory::{Outcome, StepState};

    fn document(kind: EventKind) -> EventDocument {
        event(&Event {
            sequence: 1,
            wall_ns: 2,
            kind,
        })
    }

    #[test]
    fn event_keeps_places_labels_ids_and_reasons_as_fields() {
        let moved = document(EventKind::Moved {
            track_id: 7,
            from_m: [0.1, 0.2, 0.3],
            to_m: [0.4, 0.5, 0.6],
        });
        assert_eq!(moved.event, "moved");
        assert_eq!(moved.from_m, Some([0.1, 0.2, 0.3]));
        assert_eq!(moved.position_m, Some([0.4, 0.5, 0.6]));
        let relabelled = document(EventKind::Relabelled {
            track_id: 7,
            before: Some("cup".into()),
            after: None,
            before_is_probable: true,
            after_is_probable: false,
        });
        let labels = (relabelled.label_before.as_deref(), relabelled.label);
        assert_eq!(labels, (Some("cup"), None));
        assert_eq!(relabelled.sentence, "track 7 is unknown now, was cup?");
        let failed = document(EventKind::ActionEnded {
            command_id: 4,
            outcome: Outcome::Failed,
            note: "out of reach".into(),
        });
        assert_eq!(
            (failed.command_id, failed.reason.as_str()),
            (Some(4), "out of reach")
        );
        let taught = document(EventKind::Lesson(Lesson {
            kind: LessonKind::Taught,
            category: "mug".into(),
            track_id: Some(7),
            author: "anna".into(),
            history: 9,
        }));
        assert_eq!(
            (taught.history_sequence, taught.author.as_deref()),
            (Some(9), Some("anna"))
        );
        assert_eq!(taught.sentence, "anna taught track 7 as mug");
        let slipped = document(EventKind::TaskStep(StepChange {
            task: 2,
            kind: "clear".into(),
            step: 3,
            track_id: 7,
            state: StepState::Failed,
            primitive: "lift".into(),
            reason: "it slipped".into(),
        }));
        assert_eq!((slipped.task_id, slipped.step), (Some(2), Some(3)));
        assert_eq!(
            (slipped.track_id, slipped.primitive.as_deref()),
            (Some(7), Some("lift"))
        );
        assert_eq!(
            slipped.sentence,
            "step 3 of task 2 (clear), lift of track 7, failed: it slipped"
        );
        let started = document(EventKind::Started);
        assert_eq!(started.sentence, "the memory started");
    }
}
