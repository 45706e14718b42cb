//! Emergency stop word of a robot arm in shared memory, and the lease of its one commander.
//!
//! Whoever drives an arm creates a [`StopWord`] in the domain's run folder and reads it in every
//! cycle of its loop; whoever wants the arm to stop [presses](StopButton::press) it. Neither needs
//! another process, a socket, a configuration or a disk. A [`CommandLease`] says who may move the
//! arm.

mod command_lease;
mod stop_button;
mod stop_word;
mod word_file;

pub use command_lease::{CommandLease, LEASE_TIME_NS, LeaseRefusal};
pub use stop_button::StopButton;
pub use stop_word::StopWord;
pub use word_file::{STOP_WORD_FILE, StopRecord, StopWordError, monotonic_ns};
