//! Finite state machine of a task: one pure function from state and signal to the next state.

use crate::phase::{TaskPhase, TaskSignal};

/// State of a task's machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MachineState {
    /// Phase of the task.
    pub phase: TaskPhase,
    /// True if someone has cancelled the task, which ends as soon as the hand is empty.
    pub is_cancelled: bool,
}

impl MachineState {
    /// State in which a task starts: the arm moves out of the camera's sight.
    pub const START: Self = Self {
        phase: TaskPhase::Return,
        is_cancelled: false,
    };

    /// State in which a task goes on whose executive was started anew.
    pub fn restored(is_holding: bool) -> Self {
        Self {
            phase: if is_holding {
                TaskPhase::Replan
            } else {
                TaskPhase::Return
            },
            is_cancelled: false,
        }
    }

    /// State after a signal. A signal that has no meaning in a phase changes nothing; an ended task
    /// never changes.
    pub fn after(self, signal: TaskSignal) -> Self {
        let phase = self.phase;
        let next = match signal {
            TaskSignal::Done => after_success(phase),
            TaskSignal::Failure => after_failure(phase),
            TaskSignal::Dropped => after_drop(phase),
            TaskSignal::NothingLeft => on_choice(phase, TaskPhase::Succeeded),
            TaskSignal::GoalMissed => on_choice(phase, TaskPhase::Failed),
            TaskSignal::NamesNeeded => on_choice(phase, TaskPhase::Ask),
            TaskSignal::Stopped => if_running(phase, TaskPhase::Halt),
            TaskSignal::ResumedWithObject => on_resumption(phase, TaskPhase::Replan),
            TaskSignal::ResumedEmpty => on_resumption(phase, TaskPhase::Return),
            TaskSignal::Cancel => after_cancellation(phase),
        };
        let is_cancelled = self.is_cancelled || (signal == TaskSignal::Cancel && !phase.is_end());
        Self {
            phase: if is_cancelled && !phase.is_end() {
                end_of_cancelled(next)
            } else {
                next
            },
            is_cancelled,
        }
    }
}

/// Phase after one that has reached its goal.
fn after_success(phase: TaskPhase) -> TaskPhase {
    match phase {
        TaskPhase::Look => TaskPhase::Choose,
        TaskPhase::Choose => TaskPhase::Plan,
        TaskPhase::Ask | TaskPhase::CheckPlace | TaskPhase::Return => TaskPhase::Look,
        TaskPhase::Plan => TaskPhase::Reach,
        TaskPhase::Reach => TaskPhase::Approach,
        TaskPhase::Approach => TaskPhase::Close,
        TaskPhase::Close => TaskPhase::Lift,
        TaskPhase::Lift => TaskPhase::CheckLift,
        TaskPhase::CheckLift | TaskPhase::Replan => TaskPhase::Carry,
        TaskPhase::Carry => TaskPhase::Lower,
        TaskPhase::Lower => TaskPhase::Release,
        TaskPhase::Release => TaskPhase::Retreat,
        TaskPhase::Retreat => TaskPhase::Leave,
        TaskPhase::Leave => TaskPhase::CheckPlace,
        TaskPhase::SetBack => TaskPhase::LetGo,
        TaskPhase::LetGo => TaskPhase::Return,
        TaskPhase::Halt | TaskPhase::Succeeded | TaskPhase::Failed | TaskPhase::Cancelled => phase,
    }
}

/// Phase after one that has failed. Nothing is dropped: without a way for a held object the task
/// ends with the object in the hand.
fn after_failure(phase: TaskPhase) -> TaskPhase {
    match phase {
        TaskPhase::Look | TaskPhase::Replan | TaskPhase::Return | TaskPhase::Failed => {
            TaskPhase::Failed
        }
        TaskPhase::Choose | TaskPhase::Ask | TaskPhase::Plan | TaskPhase::CheckPlace => {
            TaskPhase::Look
        }
        TaskPhase::Reach | TaskPhase::Leave | TaskPhase::LetGo => TaskPhase::Return,
        TaskPhase::Approach | TaskPhase::Close | TaskPhase::SetBack => TaskPhase::LetGo,
        TaskPhase::Lift | TaskPhase::CheckLift => TaskPhase::SetBack,
        TaskPhase::Carry | TaskPhase::Lower => TaskPhase::Replan,
        TaskPhase::Release => TaskPhase::Retreat,
        TaskPhase::Retreat => TaskPhase::Leave,
        TaskPhase::Halt | TaskPhase::Succeeded | TaskPhase::Cancelled => phase,
    }
}

/// Phase after the object was lost from between the fingers.
fn after_drop(phase: TaskPhase) -> TaskPhase {
    match phase {
        TaskPhase::Close
        | TaskPhase::Lift
        | TaskPhase::CheckLift
        | TaskPhase::Carry
        | TaskPhase::Replan
        | TaskPhase::Lower
        | TaskPhase::SetBack => TaskPhase::Return,
        TaskPhase::Look
        | TaskPhase::Choose
        | TaskPhase::Ask
        | TaskPhase::Plan
        | TaskPhase::Reach
        | TaskPhase::Approach
        | TaskPhase::Release
        | TaskPhase::Retreat
        | TaskPhase::Leave
        | TaskPhase::CheckPlace
        | TaskPhase::LetGo
        | TaskPhase::Return
        | TaskPhase::Halt
        | TaskPhase::Succeeded
        | TaskPhase::Failed
        | TaskPhase::Cancelled => phase,
    }
}

/// Next phase of the choice of an object; every other phase stays.
fn on_choice(phase: TaskPhase, next: TaskPhase) -> TaskPhase {
    if phase == TaskPhase::Choose {
        next
    } else {
        phase
    }
}

/// Next phase after a halt; every other phase stays.
fn on_resumption(phase: TaskPhase, next: TaskPhase) -> TaskPhase {
    if phase == TaskPhase::Halt {
        next
    } else {
        phase
    }
}

/// Next phase of a task that has not ended.
fn if_running(phase: TaskPhase, next: TaskPhase) -> TaskPhase {
    if phase.is_end() { phase } else { next }
}

/// Phase after a cancellation: an object in the hand goes to its place, or back.
fn after_cancellation(phase: TaskPhase) -> TaskPhase {
    match phase {
        TaskPhase::Look | TaskPhase::Choose | TaskPhase::Ask | TaskPhase::Plan => {
            TaskPhase::Cancelled
        }
        TaskPhase::Reach => TaskPhase::Return,
        TaskPhase::Approach | TaskPhase::Close => TaskPhase::LetGo,
        TaskPhase::Lift | TaskPhase::CheckLift => TaskPhase::SetBack,
        TaskPhase::Carry
        | TaskPhase::Replan
        | TaskPhase::Lower
        | TaskPhase::Release
        | TaskPhase::Retreat
        | TaskPhase::Leave
        | TaskPhase::CheckPlace
        | TaskPhase::SetBack
        | TaskPhase::LetGo
        | TaskPhase::Return
        | TaskPhase::Halt
        | TaskPhase::Succeeded
        | TaskPhase::Failed
        | TaskPhase::Cancelled => phase,
    }
}

/// Phase of a cancelled task in place of one that begins something new.
fn end_of_cancelled(next: TaskPhase) -> TaskPhase {
    match next {
        TaskPhase::Look
        | TaskPhase::Choose
        | TaskPhase::Ask
        | TaskPhase::Plan
        | TaskPhase::Succeeded => TaskPhase::Cancelled,
        TaskPhase::Reach
        | TaskPhase::Approach
        | TaskPhase::Close
        | TaskPhase::Lift
        | TaskPhase::CheckLift
        | TaskPhase::Carry
        | TaskPhase::Replan
        | TaskPhase::Lower
        | TaskPhase::Release
        | TaskPhase::Retreat
        | TaskPhase::Leave
        | TaskPhase::CheckPlace
        | TaskPhase::SetBack
        | TaskPhase::LetGo
        | TaskPhase::Return
        | TaskPhase::Halt
        | TaskPhase::Failed
        | TaskPhase::Cancelled => next,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn run(signals: &[TaskSignal]) -> MachineState {
        let all = signals.iter();
        all.fold(MachineState::START, |state, signal| state.after(*signal))
    }

    /// All states that can be reached.
    fn reachable() -> BTreeSet<MachineState> {
        let mut known = BTreeSet::from([MachineState::START]);
        let mut open = vec![MachineState::START];
        while let Some(state) = open.pop() {
            for signal in TaskSignal::ALL {
                let next = state.after(*signal);
                if known.insert(next) {
                    open.push(next);
                }
            }
        }
        known
    }

    #[test]
    fn object_after_object_is_cleared_until_none_is_left() {
        let one_object = [TaskSignal::Done; 15];
        let mut signals = one_object.to_vec();
        signals.extend([TaskSignal::Done, TaskSignal::NothingLeft]);
        assert_eq!(run(&one_object).phase, TaskPhase::Look);
        assert_eq!(run(&signals).phase, TaskPhase::Succeeded);
    }

    #[test]
    fn every_phase_is_reached_and_every_task_can_end() {
        let states = reachable();
        let phases: BTreeSet<_> = states.iter().map(|state| state.phase).collect();
        assert_eq!(phases.len(), TaskPhase::ALL.len());
        for start in states {
            let mut state = start;
            for _ in 0..TaskPhase::ALL.len() {
                state = match state.phase {
                    TaskPhase::Choose => state.after(TaskSignal::NothingLeft),
                    TaskPhase::Halt => state.after(TaskSignal::ResumedEmpty),
                    _ => state.after(TaskSignal::Done),
                };
            }
            assert!(state.phase.is_end(), "{start:?}");
        }
    }

    #[test]
    fn ended_task_never_changes() {
        for state in reachable().into_iter().filter(|state| state.phase.is_end()) {
            for signal in TaskSignal::ALL {
                assert_eq!(state.after(*signal), state);
            }
        }
    }

    #[test]
    fn no_task_ends_well_with_an_object_in_the_hand() {
        for state in reachable()
            .into_iter()
            .filter(|state| state.phase.has_object())
        {
            for signal in TaskSignal::ALL {
                let next = state.after(*signal).phase;
                let is_good_end = matches!(next, TaskPhase::Succeeded | TaskPhase::Cancelled);
                assert!(!is_good_end, "{state:?} {signal:?}");
            }
        }
    }

    #[test]
    fn cancelled_task_sets_its_object_down_and_begins_nothing_new() {
        for state in reachable().into_iter().filter(|state| state.is_cancelled) {
            let begins = [TaskPhase::Look, TaskPhase::Choose, TaskPhase::Plan];
            assert!(!begins.contains(&state.phase), "{state:?}");
        }
        let carrying = [TaskSignal::Done; 9];
        assert_eq!(run(&carrying).phase, TaskPhase::Carry);
        let cancelled = run(&carrying).after(TaskSignal::Cancel);
        assert_eq!(cancelled.phase, TaskPhase::Carry);
        let lowered = cancelled.after(TaskSignal::Done);
        assert_eq!(lowered.phase, TaskPhase::Lower);
    }

    #[test]
    fn stop_halts_until_a_person_lets_the_task_go_on() {
        let halted = run(&[TaskSignal::Done; 9]).after(TaskSignal::Stopped);
        assert_eq!(halted.phase, TaskPhase::Halt);
        for signal in [TaskSignal::Done, TaskSignal::Failure, TaskSignal::Dropped] {
            assert_eq!(halted.after(signal).phase, TaskPhase::Halt);
        }
        let with_object = halted.after(TaskSignal::ResumedWithObject);
        assert_eq!(with_object.phase, TaskPhase::Replan);
        let empty = halted.after(TaskSignal::ResumedEmpty);
        assert_eq!(empty.phase, TaskPhase::Return);
    }
}
