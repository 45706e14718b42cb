//! Supervised actors: bounded mailboxes, life cycle, worker pool, restarts with
//! back-off.
//!
//! A [`Supervisor`] owns actors of one kind by id. Each is a light task with a
//! bounded mailbox. A handler that panics, fails or hangs costs that actor one
//! message; the actor is rebuilt from its last committed state, and its neighbours
//! are not affected. The vocabulary is OTP's: restart, intensity, period, escalation.
//! An [`Escalation`] is for the owner of the process to turn into an exit code.
//!
//! ```
//! use actor::{Actor, Config, Flow, Placement, Progress, Refuse, Restart, RestartPolicy, Supervisor};
//! use std::{convert::Infallible, num::NonZeroUsize, sync::Arc, time::Duration};
//!
//! struct Counter(u64);
//!
//! impl Actor for Counter {
//!     type Message = u64;
//!     type Reply = u64;
//!     type Checkpoint = u64;
//!     type Context = ();
//!     type Error = Infallible;
//!     type Overflow = Refuse;
//!
//!     fn start(_: &Arc<()>, total: u64) -> Result<Self, Infallible> {
//!         Ok(Self(total))
//!     }
//!     fn handle(&mut self, n: u64, _: &Progress) -> Result<Flow<u64>, Infallible> {
//!         self.0 += n;
//!         Ok(Flow::Continue(self.0))
//!     }
//!     fn checkpoint(&self) -> u64 {
//!         self.0
//!     }
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let second = Duration::from_secs(1);
//! let config = Config {
//!     restart: Restart::Permanent,
//!     policy: RestartPolicy::new(3, 60 * second, second / 20, second)?,
//!     placement: Placement::Inline,
//!     mailbox_capacity: NonZeroUsize::MIN,
//!     shutdown: second,
//!     event_capacity: NonZeroUsize::MIN,
//! };
//! let runtime = tokio::runtime::Builder::new_multi_thread().enable_time().build()?;
//! let (supervisor, _events) = Supervisor::<&str, Counter>::new(config, Arc::new(()), runtime.handle().clone());
//! let address = supervisor.spawn("counter", 40)?;
//! let answer = address.ask(0, 2)?;
//! assert_eq!(runtime.block_on(answer)?, 42);
//! assert_eq!(runtime.block_on(supervisor.stop_all()), 0);
//! # Ok(()) }
//! ```
//!
//! Invariants:
//! - Handlers are synchronous and independent of tasks, threads and clocks.
//! - User code never runs while a lock of this crate is held.
//! - A message is delivered at most once; the message that broke its actor is not
//!   delivered again. A sender that awaits an answer is notified when it can no
//!   longer come.
//! - State is committed only after the handler succeeded; an answer leaves only
//!   after its state is committed.
//! - After a failure an actor begins with its last committed state.
//! - Nothing here exits the process, installs a panic hook or writes a log: every
//!   occurrence is an event, a count or an error for the owner to act on.

mod error;
mod panic_boundary;
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

mod actor_loop;
mod actor_registry;
mod address;
mod supervised_actor;
mod supervisor;

pub use actor::{Actor, Flow, Identity};
pub use address::Address;
pub use config::{Config, Placement, Restart};
pub use error::Error;
pub use event::{Cause, Escalation, Events, LifecycleEvent, StopReason};
pub use mailbox::{Backpressure, DropOldest, Refuse, SendError};
pub use progress::Progress;
pub use reply::{PendingReply, ReplyLost};
pub use restart_policy::{RestartDecision, RestartHistory, RestartPolicy};
pub use supervisor::Supervisor;
pub use worker_pool::{ForkJoin, JobLost, PoolConfig, WorkerPool};
