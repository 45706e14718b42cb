//! Conversion of world events to wire reports with sentences.

use crate::world_report::word;
use message::control::{Command, EventReport, LearningReport};
use working_memory::{Event, EventKind, Lesson, LessonKind, Outcome};

/// World-model event as a wire report.
pub(crate) fn event(event: &Event) -> EventReport {
    let EventText {
        event: word,
        track_id,
        task_id,
        label,
        sentence,
    } = EventText::of(&event.kind);
    EventReport {
        sequence: event.sequence,
        wall_ns: event.wall_ns,
        event: word,
        track_id,
        task_id,
        label,
        sentence,
    }
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

#[derive(Default)]
struct EventText {
    event: String,
    track_id: Option<u64>,
    task_id: Option<u64>,
    label: Option<String>,
    sentence: String,
}

impl EventText {
    fn of(kind: &EventKind) -> Self {
        match kind {
            EventKind::Lesson(learned) => Self::of_lesson(learned),
            EventKind::ActionEnded {
                command_id,
                outcome,
                note,
            } => Self {
                event: format!("action_{}", word(*outcome)),
                sentence: with_reason(
                    format!("the arm's command {command_id} {}", ended(*outcome)),
                    note,
                ),
                ..Self::default()
            },
            EventKind::TaskStarted { task, kind } => Self {
                event: "task_started".to_owned(),
                task_id: Some(*task),
                sentence: format!("task {task} ({kind}) began"),
                ..Self::default()
            },
            EventKind::TaskEnded {
                task,
                kind,
                outcome,
                reason,
            } => Self {
                event: format!("task_{}", word(*outcome)),
                task_id: Some(*task),
                sentence: with_reason(format!("task {task} ({kind}) {}", ended(*outcome)), reason),
                ..Self::default()
            },
            other => Self::of_object(other),
        }
    }

    fn of_lesson(learned: &Lesson) -> Self {
        let Lesson {
            category,
            track_id,
            author,
            ..
        } = learned;
        let track = track_id.map_or_else(String::new, |track| format!(" track {track} as"));
        let (event, did) = match learned.kind {
            LessonKind::Taught => ("taught", "taught"),
            LessonKind::Corrected => ("corrected", "corrected"),
            LessonKind::Forgot => ("forgot", "had forgotten"),
        };
        Self {
            event: event.to_owned(),
            track_id: *track_id,
            label: Some(category.clone()),
            sentence: format!("{author} {did}{track} {category}"),
            ..Self::default()
        }
    }

    fn of_object(kind: &EventKind) -> Self {
        let (event, track_id, label, sentence) = match kind {
            EventKind::Appeared {
                track_id,
                label,
                position_m,
            } => {
                let (called, place) = (called(label.as_ref()), metres(position_m));
                let sentence = format!("track {track_id} ({called}) appeared at {place}");
                ("appeared", Some(*track_id), label.clone(), sentence)
            }
            EventKind::Vanished { track_id, label } => {
                let sentence = format!("track {track_id} ({}) vanished", called(label.as_ref()));
                ("vanished", Some(*track_id), label.clone(), sentence)
            }
            EventKind::Relabelled {
                track_id,
                before,
                after,
            } => {
                let (before, now) = (called(before.as_ref()), called(after.as_ref()));
                let sentence = format!("track {track_id} is {now} now, was {before}");
                ("relabelled", Some(*track_id), after.clone(), sentence)
            }
            EventKind::Moved {
                track_id,
                from_m,
                to_m,
            } => {
                let (from, to) = (metres(from_m), metres(to_m));
                let sentence = format!("track {track_id} left {from} and was next at {to}");
                ("moved", Some(*track_id), None, sentence)
            }
            EventKind::Question {
                track_id,
                category,
                sentence,
            } => (
                "question",
                Some(*track_id),
                category.clone(),
                sentence.clone(),
            ),
            _ => ("started", None, None, "the memory started".to_owned()),
        };
        Self {
            event: event.to_owned(),
            track_id,
            label,
            sentence,
            ..Self::default()
        }
    }
}

fn called(label: Option<&String>) -> &str {
    label.map_or("unknown", String::as_str)
}

fn ended(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Succeeded => "succeeded",
        Outcome::Failed => "failed",
        Outcome::Cancelled => "was cancelled",
    }
}

fn with_reason(sentence: String, reason: &str) -> String {
    if reason.is_empty() {
        sentence
    } else {
        format!("{sentence}: {reason}")
    }
}

fn metres(position_m: &[f64; 3]) -> String {
    let [x, y, z] = position_m;
    format!("({x:.3} {y:.3} {z:.3})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_have_sentences() {
        let check = |kind, expected: (&str, &str)| {
            let event = event(&Event {
                sequence: 1,
                wall_ns: 2,
                kind,
            });
            assert_eq!((event.event.as_str(), event.sentence.as_str()), expected);
        };
        let relabelled = EventKind::Relabelled {
            track_id: 7,
            before: None,
            after: Some("mug".into()),
        };
        check(
            relabelled,
            ("relabelled", "track 7 is mug now, was unknown"),
        );
        let failed = EventKind::ActionEnded {
            command_id: 4,
            outcome: Outcome::Failed,
            note: "out of reach".into(),
        };
        let sentence = "the arm's command 4 failed: out of reach";
        check(failed, ("action_failed", sentence));
        let learned = |lesson, track_id| {
            EventKind::Lesson(Lesson {
                kind: lesson,
                category: "mug".into(),
                track_id,
                author: "anna".into(),
                history: 9,
            })
        };
        let forgot = learned(LessonKind::Forgot, None);
        check(forgot, ("forgot", "anna had forgotten mug"));
        let taught = learned(LessonKind::Taught, Some(7));
        check(taught, ("taught", "anna taught track 7 as mug"));
        check(EventKind::Started, ("started", "the memory started"));
    }
}
