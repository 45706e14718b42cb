//! Health of the memory process, from the conditions of its two stores.

use message::ProcessState;
use parking_lot::Mutex;
use service::HealthCounters;
use std::sync::Arc;

/// Store whose condition counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Store {
    /// Learned views and labels.
    Perceptual,
    /// Facts, events and tasks.
    Working,
}

/// Condition of a store.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Condition {
    /// `true` if the store cannot do all that it should.
    pub(crate) is_degraded: bool,
    /// Explanation; empty when all is well.
    pub(crate) note: String,
}

impl Condition {
    /// Condition of a store that cannot do all that it should.
    pub(crate) fn degraded(note: String) -> Self {
        Self {
            is_degraded: true,
            note,
        }
    }
}

/// Conditions of both stores. The process is degraded while one of them is, and starting until it
/// serves requests.
#[derive(Debug)]
pub(crate) struct HealthConditions {
    health: Arc<HealthCounters>,
    present: Mutex<Present>,
}

#[derive(Debug, Default)]
struct Present {
    /// Conditions of the perceptual and of the working memory.
    conditions: [Condition; 2],
    is_serving: bool,
}

impl HealthConditions {
    pub(crate) fn new(health: Arc<HealthCounters>) -> Self {
        Self {
            health,
            present: Mutex::default(),
        }
    }

    /// Replaces the condition of a store.
    pub(crate) fn set(&self, store: Store, condition: Condition) {
        let mut present = self.present.lock();
        present.conditions[store as usize] = condition;
        self.tell(&present);
    }

    /// Ends the start: requests are served from now on.
    pub(crate) fn begin_service(&self) {
        let mut present = self.present.lock();
        present.is_serving = true;
        self.tell(&present);
    }

    fn tell(&self, present: &Present) {
        if present.is_serving {
            let (state, note) = joined(&present.conditions);
            self.health.set_state(state, &note);
        }
    }
}

/// State and explanation of the process; degraded stores come first.
fn joined(conditions: &[Condition; 2]) -> (ProcessState, String) {
    let is_degraded = conditions.iter().any(|condition| condition.is_degraded);
    let reported = conditions
        .iter()
        .filter(|condition| condition.is_degraded == is_degraded && !condition.note.is_empty());
    let notes: Vec<&str> = reported.map(|condition| condition.note.as_str()).collect();
    let state = if is_degraded {
        ProcessState::Degraded
    } else {
        ProcessState::Ready
    };
    (state, notes.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn condition(is_degraded: bool, note: &str) -> Condition {
        Condition {
            is_degraded,
            note: note.into(),
        }
    }

    #[test]
    fn process_is_degraded_while_a_store_is() {
        let health = Arc::new(HealthCounters::default());
        let conditions = HealthConditions::new(health.clone());
        let state = || {
            let (state, note) = health.state();
            (state, note.as_str().unwrap().to_owned())
        };
        conditions.set(Store::Perceptual, condition(false, "rebuilt"));
        assert_eq!(state().0, ProcessState::Starting);
        conditions.begin_service();
        assert_eq!(state(), (ProcessState::Ready, "rebuilt".into()));
        conditions.set(Store::Perceptual, condition(true, "no room"));
        conditions.set(Store::Working, condition(true, "not on disk"));
        assert_eq!(
            state(),
            (ProcessState::Degraded, "no room; not on disk".into())
        );
        conditions.set(Store::Perceptual, Condition::default());
        assert_eq!(state(), (ProcessState::Degraded, "not on disk".into()));
        conditions.set(Store::Working, Condition::default());
        assert_eq!(state(), (ProcessState::Ready, String::new()));
    }
}
