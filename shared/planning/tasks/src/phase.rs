//! Phases of a task, and the signals that end them.

macro_rules! words {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $variant:ident = $word:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $name {
            $($(#[$variant_doc])* $variant,)+
        }

        impl $name {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$variant),+];

            /// Name as one word, as in records and documents.
            pub fn word(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)+
                }
            }

            /// That of a word; `None` for an unknown one.
            pub fn from_word(word: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|one| one.word() == word)
            }
        }
    };
}

words! {
    /// Phase of a task: the primitive that the robot carries out, or an end.
    TaskPhase {
        /// Looks at the table, with the arm out of the camera's sight.
        Look = "look",
        /// Chooses the next object.
        Choose = "choose",
        /// Waits for a person to name the objects that are left.
        Ask = "ask",
        /// Plans grasp, transport and place.
        Plan = "plan",
        /// Moves the open hand to the begin of the approach.
        Reach = "reach",
        /// Moves the hand straight to the object.
        Approach = "approach",
        /// Closes the fingers.
        Close = "close",
        /// Lifts the object straight up.
        Lift = "lift",
        /// Checks that the object was lifted, by the gripper and by sight.
        CheckLift = "check_lift",
        /// Moves the object over its place.
        Carry = "carry",
        /// Plans the rest of a transport anew, with the object in the hand.
        Replan = "replan",
        /// Lowers the object to its place.
        Lower = "lower",
        /// Opens the fingers at the place.
        Release = "release",
        /// Moves the open hand straight back from the place.
        Retreat = "retreat",
        /// Moves the arm out of the camera's sight, after an object was set down.
        Leave = "leave",
        /// Checks by sight that the object stands at its place.
        CheckPlace = "check_place",
        /// Sets the object back where it was lifted.
        SetBack = "set_back",
        /// Opens the fingers and moves them straight back, after an attempt that failed.
        LetGo = "let_go",
        /// Moves the arm out of the camera's sight, after an attempt that failed.
        Return = "return",
        /// Stands still after a protective stop, until a person lets the task go on.
        Halt = "halt",
        /// The task has ended and reached its goal.
        Succeeded = "succeeded",
        /// The task has ended without its goal.
        Failed = "failed",
        /// The task has ended because someone cancelled it.
        Cancelled = "cancelled",
    }
}

words! {
    /// Signal: an outcome of a phase, or something that interrupts it.
    TaskSignal {
        /// The phase has reached its goal.
        Done = "done",
        /// The phase has failed.
        Failure = "failure",
        /// The fingers have lost the object.
        Dropped = "dropped",
        /// No object is left for the task.
        NothingLeft = "nothing_left",
        /// The objects that are left could not be carried.
        GoalMissed = "goal_missed",
        /// The objects that are left need a name.
        NamesNeeded = "names_needed",
        /// The arm was stopped.
        Stopped = "stopped",
        /// A person lets the task go on after a stop; the hand holds an object.
        ResumedWithObject = "resumed_with_object",
        /// A person lets the task go on after a stop; the hand is empty.
        ResumedEmpty = "resumed_empty",
        /// Someone cancels the task.
        Cancel = "cancel",
    }
}

impl TaskPhase {
    /// True if the task has ended.
    pub fn is_end(self) -> bool {
        matches!(self, Self::Succeeded | Self::Failed | Self::Cancelled)
    }

    /// True if the hand holds the object of the step, unless it slips.
    pub fn has_object(self) -> bool {
        matches!(
            self,
            Self::Lift | Self::CheckLift | Self::Carry | Self::Replan | Self::Lower | Self::SetBack
        )
    }

    /// True if the arm or its fingers move.
    pub fn is_motion(self) -> bool {
        matches!(
            self,
            Self::Reach
                | Self::Approach
                | Self::Close
                | Self::Lift
                | Self::Carry
                | Self::Lower
                | Self::Release
                | Self::Retreat
                | Self::Leave
                | Self::SetBack
                | Self::LetGo
                | Self::Return
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn words_are_unique() {
        let phases: BTreeSet<_> = TaskPhase::ALL.iter().map(|phase| phase.word()).collect();
        assert_eq!(phases.len(), TaskPhase::ALL.len());
        let signals: BTreeSet<_> = TaskSignal::ALL.iter().map(|signal| signal.word()).collect();
        assert_eq!(signals.len(), TaskSignal::ALL.len());
        assert_eq!(TaskPhase::from_word("carry"), Some(TaskPhase::Carry));
        assert_eq!(TaskSignal::from_word("carry"), None);
    }

    #[test]
    fn ended_tasks_hold_and_move_nothing() {
        let ends = TaskPhase::ALL.iter().filter(|phase| phase.is_end());
        assert!(
            ends.clone()
                .all(|phase| !phase.has_object() && !phase.is_motion())
        );
        assert_eq!(ends.count(), 3);
    }
}
