//! Blocking client of a daemon's control socket, for any program.
//!
//! It needs no runtime, no shared memory and no arguments: [`DomainName`] and [`RunFolder`] say
//! where a daemon listens, [`DaemonClient`] asks it, and `control-protocol` has the requests and
//! replies.
//!
//! ```no_run
//! use control_protocol::request;
//! use daemon_client::{DaemonClient, DomainName, RunFolder};
//! use std::time::Duration;
//!
//! let domain = DomainName::default();
//! let deadline = Duration::from_secs(5);
//! let mut daemon = DaemonClient::connect(&domain, &RunFolder::candidates(), deadline)?;
//! let scene = daemon.ask(&request::objects())?;
//! println!("{} objects", scene.objects.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod call_error;
mod daemon_client;
mod daemon_link;
mod domain_name;
mod run_folder;

pub use call_error::CallError;
pub use daemon_client::DaemonClient;
pub use daemon_link::{DaemonLink, Unanswered};
pub use domain_name::{DomainName, InvalidDomainName};
pub use run_folder::RunFolder;

/// Folder of POSIX shared memory, on tmpfs.
const SHARED_MEMORY_FOLDER: &str = "/dev/shm";
