//! Inter-process communication: publish-subscribe topics over iceoryx2 shared memory, and
//! request-response over Unix sockets.
//!
//! A [`Domain`] is one daemon on one machine: a name, a run folder on tmpfs, a prefix
//! in shared memory. Its services are [`topic`]s; each defines its limits, its
//! overflow policy and its types in one place. A message is loaned, filled and sent
//! by value (zero-copy). A received message is a [`SharedMessage`] that any number of
//! threads may read and that returns its memory when the last one drops it.
//!
//! This crate is the only one that names iceoryx2's ports. It never copies a payload,
//! never blocks a tokio thread, and never interprets the meaning of a message. It
//! uses no file or folder that another user controls.
//!
//! ```
//! use channel::topic::Scene;
//! use channel::{Domain, Publisher, Role, RunFolder, Subscriber};
//! use message::{SceneObject, SceneSummary};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir_in("/dev/shm")?;
//! let run_folder = RunFolder::at(folder.path().to_owned());
//! let name = format!("example-{}", std::process::id()).parse()?;
//! let domain = Domain::join(&name, &run_folder, Role::Guest)?;
//! let mut publisher = Publisher::<Scene>::new(&domain)?;
//! let mut subscriber = Subscriber::<Scene>::polled(&domain)?;
//! publisher.send_copy(SceneSummary::default(), &[SceneObject::default()])?;
//! let scene = subscriber.latest()?.ok_or("no message")?;
//! assert_eq!(scene.items().len(), 1);
//! # Ok(()) }
//! ```

pub mod control;
mod domain;
mod domain_reservation;
mod domain_state;
mod error;
mod group;
mod guest_places;
mod live_file;
mod lock_file;
mod log_bridge;
mod publisher;
mod reservation;
mod segment_backing;
mod segment_map;
mod service_creation;
mod shared_memory;
mod shared_message;
mod subscriber;
pub mod topic;
mod topic_service;
mod trusted_folder;
mod wake_event;

pub use daemon_client::{DomainName, RunFolder};
pub use domain::{Domain, Role};
pub use domain_reservation::{domain_bytes, domain_reservation, fitting_guest_places};
pub use domain_state::DomainState;
pub use error::Error;
pub use guest_places::{GUEST_PLACES, MAX_GUEST_PLACES};
pub use live_file::LiveFile;
pub use publisher::{Loan, Publisher};
pub use reservation::Reservation;
pub use shared_memory::{SharedMemory, check_shared_memory};
pub use shared_message::SharedMessage;
pub use subscriber::{Received, Subscriber};
