//! Mailbox, life cycle, worker pool and supervision.
//!
//! One object, one actor: a [`Supervisor`] owns actors by id, each a light
//! task with a bounded mailbox. A handler that panics, fails or hangs costs
//! that actor one message; it is rebuilt from its last good state, and its
//! neighbours notice nothing. The words are OTP's: restart, intensity, period,
//! escalation.
//!
//! Invariants:
//! - Handlers are synchronous and know nothing of tasks, threads or clocks.
//! - User code never runs while a lock of this crate is held.
//! - A message is delivered at most once; the one that broke its actor never
//!   comes back. Who awaits an answer is told when it can no longer come.
//! - State is committed only after the handler succeeded; an answer leaves only
//!   after its state is committed.
//! - Nothing here exits the process, installs a panic hook or writes a log:
//!   what happened is an event, a count or an error for the owner to act on.

mod border;
mod error;
mod progress;

pub mod mailbox;

mod actor;
mod reply;

mod job;
mod worker_pool;

mod config;
mod event;
mod restart_policy;

mod address;
mod child;
mod roster;
mod supervisor;

pub use actor::{Actor, Flow, Identity};
pub use address::Address;
pub use config::{Config, Placement, Restart};
pub use error::Error;
pub use event::{Cause, Event, Events, StopReason};
pub use mailbox::{Block, KeepLatest, Refuse, SendError};
pub use progress::Progress;
pub use reply::{Answer, Lost};
pub use restart_policy::{RestartHistory, RestartPolicy, Verdict};
pub use supervisor::Supervisor;
pub use worker_pool::{JobLost, PoolConfig, WorkerPool};
