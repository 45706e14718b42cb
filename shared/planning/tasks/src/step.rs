//! Steps of a task: one attempt to carry one object to its place each, as they are on record.

/// Greatest number of attempts for one object: the first one and two more. Chosen (execution manager
/// of the paper's successors: at most two retries).
pub(crate) const ATTEMPTS_MAX: u32 = 3;

/// Greatest number of failures in a row, of any objects: the next attempt would be in vain, too.
/// Chosen.
pub(crate) const FAILURES_IN_A_ROW_MAX: usize = 9;

/// State of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepState {
    /// The object is not in the hand yet, or no longer.
    Running,
    /// The object is in the hand.
    Held,
    /// The object stands at its place.
    Succeeded,
    /// The attempt has failed.
    Failed,
}

/// Step of a task.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CarryStep {
    /// Track-id of the object.
    pub track: u64,
    /// Label of the object when the step began.
    pub label: Option<String>,
    /// Name of the goal place.
    pub place: String,
    /// State of the step.
    pub state: StepState,
    /// Reason of a failure, a sentence without its full stop.
    pub reason: String,
}

impl StepState {
    /// Name of the state as one word, as on record.
    pub fn word(self) -> &'static str {
        match self {
            Self::Running => "running",
            Self::Held => "held",
            Self::Succeeded => "succeeded",
            Self::Failed => "failed",
        }
    }

    /// State of a word.
    pub fn from_word(word: &str) -> Option<Self> {
        let all = [Self::Running, Self::Held, Self::Succeeded, Self::Failed];
        all.into_iter().find(|state| state.word() == word)
    }

    /// True if the step has not ended.
    pub fn is_open(self) -> bool {
        matches!(self, Self::Running | Self::Held)
    }
}

/// Number of attempts for an object among the steps of a task.
pub fn n_attempts(steps: &[CarryStep], track: u64) -> u32 {
    let of_track = steps.iter().filter(|step| step.track == track);
    of_track.count() as u32
}

/// True if so many attempts in a row have failed that no further one is made.
pub fn is_hopeless(steps: &[CarryStep]) -> bool {
    let newest = steps.iter().rev();
    let failed = newest.take_while(|step| step.state == StepState::Failed);
    failed.count() >= FAILURES_IN_A_ROW_MAX
}

/// Reason for which an object is set aside, after as many failures as are tried.
pub fn set_aside(steps: &[CarryStep], track: u64) -> Option<&str> {
    let mut failed = steps
        .iter()
        .filter(|step| step.track == track && step.state == StepState::Failed);
    let n_failed = failed.clone().count() as u32;
    let last = failed.next_back()?;
    (n_failed >= ATTEMPTS_MAX).then_some(last.reason.as_str())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Step of a mug to the shelf.
    pub(crate) fn step(track: u64, state: StepState) -> CarryStep {
        CarryStep {
            track,
            label: Some("mug".to_owned()),
            place: "shelf".to_owned(),
            state,
            reason: match state {
                StepState::Failed => "the fingers closed on nothing".to_owned(),
                StepState::Running | StepState::Held | StepState::Succeeded => String::new(),
            },
        }
    }

    #[test]
    fn object_is_set_aside_after_three_failures() {
        let failed = |n: usize| vec![step(4, StepState::Failed); n];
        assert_eq!(set_aside(&failed(2), 4), None);
        assert_eq!(
            set_aside(&failed(3), 4),
            Some("the fingers closed on nothing")
        );
        assert_eq!(set_aside(&failed(3), 5), None);
        assert_eq!(
            (n_attempts(&failed(2), 4), n_attempts(&failed(2), 5)),
            (2, 0)
        );
    }

    #[test]
    fn nine_failures_in_a_row_are_hopeless() {
        let mut steps = vec![step(4, StepState::Failed); 8];
        steps.push(step(5, StepState::Succeeded));
        steps.extend(vec![step(6, StepState::Failed); 8]);
        assert!(!is_hopeless(&steps));
        steps.push(step(7, StepState::Failed));
        assert!(is_hopeless(&steps));
    }

    #[test]
    fn words_name_their_states() {
        for state in [
            StepState::Running,
            StepState::Held,
            StepState::Succeeded,
            StepState::Failed,
        ] {
            assert_eq!(StepState::from_word(state.word()), Some(state));
        }
        assert_eq!(StepState::from_word("begun"), None);
    }
}
