//! Ports over iceoryx2 shared memory, and the control protocol's two carriers.
//!
//! A [`Domain`] is one daemon on one machine: a name, a run folder on tmpfs, a
//! prefix in shared memory. Its services are [`topic`]s; each has one owner of
//! its limits, its overflow policy and its types. A message is loaned, filled
//! and sent by value; a received cloud is a [`SharedFrame`] that any number of
//! threads may read and that returns its memory when the last one drops it.
//!
//! This crate is the only one that names iceoryx2's ports. It never copies a
//! payload, never blocks a tokio thread, and never interprets what a message
//! means.

pub mod control;
mod domain;
mod domain_folder;
mod error;
mod inspection;
mod lock_file;
mod log_bridge;
mod publisher;
mod reservation;
mod segment;
mod shared_frame;
mod shared_memory;
mod subscriber;
pub mod topic;
mod trusted_folder;
mod wake;

pub use domain::{Domain, Role};
pub use domain_folder::{DomainName, RunFolder};
pub use error::Error;
pub use inspection::DomainState;
pub use publisher::{Loan, Publisher};
pub use reservation::{Reservation, domain_reservation};
pub use shared_frame::SharedFrame;
pub use shared_memory::{SharedMemory, remove_leftovers};
pub use subscriber::{Received, Subscriber};
