//! Document of an event of the world model; its sentence is made from its fields.

use crate::object::CategoryAnswer;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Event of the world model.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct EventDocument {
    /// Sequence of the event, ascending; a restart of the memory leaves a gap.
    pub sequence: u64,
    /// Time at which the event was observed, nanoseconds since 1970.
    pub wall_ns: u64,
    /// Kind of the event: `started`, `appeared`, `vanished`, `relabelled`, `moved`, `question`,
    /// `taught`, `corrected`, `forgot`, `action_succeeded`, `action_failed`, `action_cancelled`,
    /// `task_started`, `task_succeeded`, `task_failed`, `task_cancelled`, `step_running`,
    /// `step_held`, `step_succeeded` or `step_failed`.
    pub event: String,
    /// Track-id; null when no object is involved.
    pub track_id: Option<u64>,
    /// Task id; null when no task is involved.
    pub task_id: Option<u64>,
    /// Category after the event; null for none.
    pub label: Option<String>,
    /// Answer that `label` is: `is`, `probably`, or `unknown` for none.
    #[serde(default)]
    pub answer: CategoryAnswer,
    /// Category before a `relabelled` event; null for none.
    #[serde(default)]
    pub label_before: Option<String>,
    /// Answer that `label_before` is.
    #[serde(default)]
    pub answer_before: CategoryAnswer,
    /// Centre of the object's box after `appeared` and `moved`, world frame, metres.
    #[serde(default)]
    pub position_m: Option<[f64; 3]>,
    /// Centre of the object's box where it had rested before `moved`, world frame, metres.
    #[serde(default)]
    pub from_m: Option<[f64; 3]>,
    /// Id of the arm's command that ended; null for another event.
    #[serde(default)]
    pub command_id: Option<u64>,
    /// Kind of the task; null when no task is involved.
    #[serde(default)]
    pub task_kind: Option<String>,
    /// Number of the step in its task; null when no step is involved.
    #[serde(default)]
    pub step: Option<u64>,
    /// Primitive of the step; null when no step is involved.
    #[serde(default)]
    pub primitive: Option<String>,
    /// Reason of the end of a task or an action, or of the state of a step; empty when none was
    /// given.
    #[serde(default)]
    pub reason: String,
    /// Author of a lesson; null for another event.
    #[serde(default)]
    pub author: Option<String>,
    /// Sequence of a lesson in the memory's history; null for another event.
    #[serde(default)]
    pub history_sequence: Option<u64>,
    /// Description of the event, for people.
    pub sentence: String,
}

/// Events, oldest first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EventsDocument {
    /// Events of the world model, oldest first.
    pub events: Vec<EventDocument>,
    /// Sequence of the newest event overall. When it exceeds the last sequence of this answer, ask
    /// again at once; when it is below `since`, the memory was recreated: restart from 0.
    pub newest: u64,
}

impl EventDocument {
    /// Event with the sentence that its fields make; that of a question is kept.
    pub fn in_words(mut self) -> Self {
        if self.event != "question" {
            self.sentence = self.made_sentence();
        }
        self
    }

    fn made_sentence(&self) -> String {
        let number = |id: Option<u64>| id.map_or_else(String::new, |id| id.to_string());
        let track = format!("track {}", number(self.track_id));
        let label = self.answer.shown(self.label.as_deref());
        let place = |place_m: Option<[f64; 3]>| place_m.map_or_else(String::new, metres);
        let kind = self.task_kind.as_deref().unwrap_or_default();
        let task = format!("task {} ({kind})", number(self.task_id));
        match self.event.as_str() {
            "started" => "the memory started".to_owned(),
            "appeared" => format!("{track} ({label}) appeared at {}", place(self.position_m)),
            "vanished" => format!("{track} ({label}) vanished"),
            "relabelled" => {
                let before = self.answer_before.shown(self.label_before.as_deref());
                format!("{track} is {label} now, was {before}")
            }
            "moved" => {
                let (from, to) = (place(self.from_m), place(self.position_m));
                format!("{track} left {from} and was next at {to}")
            }
            "taught" | "corrected" | "forgot" => self.lesson_sentence(),
            "task_started" => format!("{task} began"),
            event => match event.split_once('_') {
                Some(("task", outcome)) => self.with_reason(&task, outcome),
                Some(("action", outcome)) => {
                    let command = format!("the arm's command {}", number(self.command_id));
                    self.with_reason(&command, outcome)
                }
                Some(("step", state)) => {
                    let (step, primitive) = (number(self.step), self.primitive.as_deref());
                    let primitive = primitive.unwrap_or_default();
                    self.with_reason(
                        &format!("step {step} of {task}, {primitive} of {track},"),
                        state,
                    )
                }
                _ => event.to_owned(),
            },
        }
    }

    fn lesson_sentence(&self) -> String {
        let author = self.author.as_deref().unwrap_or_default();
        let did = match self.event.as_str() {
            "forgot" => "had forgotten",
            did => did,
        };
        let track = self.track_id.map(|track| format!(" track {track} as"));
        let category = self.answer.shown(self.label.as_deref());
        format!("{author} {did}{} {category}", track.unwrap_or_default())
    }

    fn with_reason(&self, subject: &str, state: &str) -> String {
        let predicate = match state {
            "cancelled" => "was cancelled",
            "running" => "is running",
            "held" => "holds the object",
            state => state,
        };
        match self.reason.as_str() {
            "" => format!("{subject} {predicate}"),
            reason => format!("{subject} {predicate}: {reason}"),
        }
    }
}

fn metres([x, y, z]: [f64; 3]) -> String {
    format!("({x:.3} {y:.3} {z:.3})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentence_of_an_event_is_made_from_its_fields() {
        let event = |event: &str| EventDocument {
            event: event.to_owned(),
            track_id: Some(7),
            label: Some("mug".to_owned()),
            author: Some("anna".to_owned()),
            task_kind: Some("clear".to_owned()),
            command_id: Some(4),
            task_id: Some(2),
            position_m: Some([0.1, 0.2, 0.3]),
            from_m: Some([0.4, 0.5, 0.6]),
            ..EventDocument::default()
        };
        let failed = EventDocument {
            reason: "out of reach".to_owned(),
            ..event("action_failed")
        };
        let probable = EventDocument {
            answer: CategoryAnswer::Probably,
            ..event("vanished")
        };
        let whole_category = EventDocument {
            track_id: None,
            ..event("forgot")
        };
        for (document, sentence) in [
            (event("started"), "the memory started"),
            (
                event("appeared"),
                "track 7 (mug) appeared at (0.100 0.200 0.300)",
            ),
            (event("vanished"), "track 7 (mug) vanished"),
            (probable, "track 7 (mug?) vanished"),
            (event("relabelled"), "track 7 is mug now, was unknown"),
            (
                event("moved"),
                "track 7 left (0.400 0.500 0.600) and was next at (0.100 0.200 0.300)",
            ),
            (event("taught"), "anna taught track 7 as mug"),
            (whole_category, "anna had forgotten mug"),
            (event("task_started"), "task 2 (clear) began"),
            (event("task_cancelled"), "task 2 (clear) was cancelled"),
            (failed, "the arm's command 4 failed: out of reach"),
        ] {
            assert_eq!(document.in_words().sentence, sentence);
        }
    }

    #[test]
    fn sentence_of_a_step_names_task_primitive_and_object() {
        let event = |event: &str, reason: &str| EventDocument {
            event: event.to_owned(),
            track_id: Some(7),
            task_kind: Some("clear".to_owned()),
            task_id: Some(2),
            step: Some(3),
            primitive: Some("lift".to_owned()),
            reason: reason.to_owned(),
            ..EventDocument::default()
        };
        for (document, predicate) in [
            (event("step_running", ""), "is running"),
            (event("step_held", ""), "holds the object"),
            (event("step_failed", "it slipped"), "failed: it slipped"),
        ] {
            let sentence = format!("step 3 of task 2 (clear), lift of track 7, {predicate}");
            assert_eq!(document.in_words().sentence, sentence);
        }
    }
}
