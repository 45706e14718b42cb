//! Client of the control protocol, for command-line programs.
//!
//! [`connect`] reaches a daemon through its control socket and [`ask`] turns a
//! refusal into a failure with its exit code. [`change`] repeats a change until its outcome
//! is known. [`MemoryClient`] asks the memory of a
//! running daemon, or, without one, a child process that opens the stored memory.
//! [`SpawnedDaemon`] is a daemon that a program runs for itself. [`TrackReference`] is an object as
//! a person names it.
//!
//! Invariants: this crate never opens a database itself and never names one.
//!
//! ```
//! use control_client::read_history;
//!
//! // The history is read page by page; here the memory has no entries.
//! let ask = |_from: Option<u64>, _max: u32| Ok::<_, std::convert::Infallible>((Vec::new(), 0));
//! let (entries, last_sequence) = read_history(None, 5000, ask).unwrap();
//! assert!(entries.is_empty() && last_sequence == 0);
//! ```

mod authorship;
mod change;
mod connection;
mod document;
mod history;
mod import;
mod memory_client;
mod object_search;
mod spawned_daemon;
mod track_reference;

pub use authorship::{author_or_user, mutation_id};
pub use change::change;
pub use connection::{ask, ask_once, connect};
pub use document::{NewDocument, StoredDocument, read_document, try_put_document};
pub use history::read_history;
pub use import::{ImportError, ImportRequest, import};
pub use memory_client::{
    MemoryClient, connect_if_running, local_memory_folder, unexpected_outcome,
};
pub use object_search::find_objects;
pub use spawned_daemon::SpawnedDaemon;
pub use track_reference::{InvalidTrackReference, TrackReference, TrackScope, is_track_id};
