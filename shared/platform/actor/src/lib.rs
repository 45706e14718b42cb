//! Mailbox, life cycle, worker pool and supervision.
//!
//! One object, one actor: a [`Supervisor`] owns actors by id, each a light
//! task with a bounded mailbox. A handler that panics, fails or hangs costs
//! that actor one message; it is rebuilt from its last good state, and its
//! neighbours notice nothing. The words are OTP's: restart, intensity, period,
//! escalation.
//!
//! Two supervisors share these words. [`Supervisor`] is for actors of one kind
//! that come and go, as tracks do. [`Tree`] is for children known beforehand and
//! unlike each other: actors, tasks, supervisors, other trees, each with its
//! [`ChildSpec`], under a [`Strategy`]. A supervisor whose restarts exceed its
//! policy stops its children and has itself failed: above it a tree restarts it,
//! and at the root the [`Escalation`] is the owner's to turn into an exit code.
//!
//! ```no_run
//! # use actor::{ChildSpec, Escalation, ChildPath, Restart, RestartPolicy, Strategy, Tree, reports};
//! # use std::{convert::Infallible, num::NonZeroUsize, time::Duration};
//! # async fn run(policy: RestartPolicy, told_to_stop: impl Future<Output = ()>)
//! # -> Result<(), Box<dyn std::error::Error>> {
//! let courier = ChildSpec::task("courier", Restart::Permanent, Duration::from_secs(1), |stop| {
//!     async move {
//!         stop.await;
//!         Ok::<(), Infallible>(())
//!     }
//! });
//! let tree = Tree::new(Strategy::OneForOne, policy, vec![courier])?;
//! let (reports, events) = reports(NonZeroUsize::new(256).expect("not empty"));
//! tree.run(reports, told_to_stop).await?;
//! # drop(events);
//! # Ok(()) }
//! ```
//!
//! Invariants:
//! - Handlers are synchronous and know nothing of tasks, threads or clocks.
//! - User code never runs while a lock of this crate is held.
//! - A message is delivered at most once; the one that broke its actor never
//!   comes back. Who awaits an answer is told when it can no longer come.
//! - State is committed only after the handler succeeded; an answer leaves only
//!   after its state is committed.
//! - After a failure an actor begins with its last good state, after an
//!   escalation with its first.
//! - Nothing here exits the process, installs a panic hook or writes a log:
//!   what happened is an event, a count or an error for the owner to act on.

mod border;
mod error;
mod progress;
mod sync;

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
mod life;
mod roster;
mod supervisor;

mod tree;

pub use actor::{Actor, Flow, Identity};
pub use address::Address;
pub use config::{Config, Placement, Restart};
pub use error::Error;
pub use event::{Cause, Escalation, Event, Events, StopReason};
pub use mailbox::{Block, KeepLatest, Refuse, SendError};
pub use progress::Progress;
pub use reply::{Answer, Lost};
pub use restart_policy::{RestartHistory, RestartPolicy, Verdict};
pub use supervisor::Supervisor;
pub use tree::{ActorConfig, ChildPath, ChildSpec, Reports, Stop, Strategy, Tree, reports};
pub use worker_pool::{JobLost, PoolConfig, Team, WorkerPool};
