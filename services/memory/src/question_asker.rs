//! Question asker: turns a question that lasts into an event, once for each object.

use control_protocol::QuestionReport;
use std::collections::BTreeSet;

/// Time for which a question about an object has to stand before it is asked, nanoseconds. Chosen:
/// recognition has settled.
const LASTS_NS: u64 = 3_000_000_000;

/// Least time between two questions, nanoseconds. Chosen: a person can answer one.
const PAUSE_NS: u64 = 30_000_000_000;

/// Asker of questions; time is that of the scenes.
#[derive(Debug, Default)]
pub(crate) struct QuestionAsker {
    /// Object that the question is about, and since when.
    pending: Option<(u64, u64)>,
    /// Objects that were asked about and are still there.
    asked: BTreeSet<u64>,
    last_asked_ns: Option<u64>,
}

impl QuestionAsker {
    /// Track-ids that were asked about already.
    pub(crate) fn asked(&self) -> &BTreeSet<u64> {
        &self.asked
    }

    /// Forgets the objects that are gone.
    pub(crate) fn retain(&mut self, is_present: impl Fn(u64) -> bool) {
        self.asked.retain(|track_id| is_present(*track_id));
    }

    /// Takes the question of a scene; true if it is to be asked now.
    pub(crate) fn is_due(&mut self, question: Option<&QuestionReport>, now_ns: u64) -> bool {
        let track_id = question.map(|question| question.track_id);
        let Some(track_id) = track_id.filter(|track_id| !self.asked.contains(track_id)) else {
            self.pending = None;
            return false;
        };
        let since_ns = match self.pending {
            Some((pending, since_ns)) if pending == track_id && since_ns <= now_ns => since_ns,
            _ => now_ns,
        };
        self.pending = Some((track_id, since_ns));
        let is_paused = self
            .last_asked_ns
            .is_some_and(|last| last <= now_ns && now_ns - last < PAUSE_NS);
        if is_paused || now_ns - since_ns < LASTS_NS {
            return false;
        }
        self.pending = None;
        self.last_asked_ns = Some(now_ns);
        self.asked.insert(track_id);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_protocol::QuestionKind;

    const SECOND_NS: u64 = 1_000_000_000;

    fn question(track_id: u64) -> QuestionReport {
        QuestionReport {
            track_id,
            kind: QuestionKind::NewObject,
            uncertainty: 1.0,
            categories: vec![],
            position_m: [0.0; 3],
            sentence: String::new(),
        }
    }

    #[test]
    fn question_that_lasts_is_asked_once_and_others_after_a_pause() {
        let mut asker = QuestionAsker::default();
        let mut due = |track_id: u64, seconds: std::ops::Range<u64>| -> Vec<u64> {
            let is_due = |second: &u64| asker.is_due(Some(&question(track_id)), second * SECOND_NS);
            seconds.filter(is_due).collect()
        };
        assert_eq!(due(4, 0..20), [3]);
        assert_eq!(due(5, 20..60), [33]);
        assert_eq!(due(4, 60..120), [0; 0]);
        assert!(asker.asked().contains(&4));
        asker.retain(|track_id| track_id != 4);
        assert!(!asker.asked().contains(&4));
    }

    #[test]
    fn question_that_changes_or_ends_is_not_asked() {
        let mut asker = QuestionAsker::default();
        for second in 0..40 {
            let question = (second % 2 == 0).then(|| question(second));
            assert!(!asker.is_due(question.as_ref(), second * SECOND_NS));
        }
    }
}
