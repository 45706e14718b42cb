//! Tasks of the robot: clearing the table and fetching an object.
//!
//! A task is a finite state machine ([`MachineState::after`]), whose graph is drawn from itself
//! ([`mermaid`]). What comes next is chosen from the objects of the newest scene and the steps on
//! record ([`select`]); what was done is verified by sight ([`is_place_empty`], [`object_at`]) and
//! told in words ([`report`]). After Kasaei et al. (2018), "Execution Manager".
//!
//! Frames and units: world, z against gravity, metres.
//!
//! Invariants: this crate does no I/O, reads no clock and draws no random numbers.

mod graph;
mod phase;
mod report;
mod selection;
mod state_machine;
mod step;
mod table_object;
mod verification;

pub use graph::mermaid;
pub use phase::{TaskPhase, TaskSignal};
pub use report::{left_words, object_words, report};
pub use selection::{
    LeftObject, LeftReason, NamedPlace, NextObject, Selection, TaskGoal, TaskRules, TaskView,
    UNKNOWN_PLACE, UnnamedPolicy, place_of_category, select,
};
pub use state_machine::MachineState;
pub use step::{CarryStep, StepState, is_hopeless, n_attempts, set_aside};
pub use table_object::TableObject;
pub use verification::{is_place_empty, object_at};
