//! Errors of domains and their ports.

use std::path::PathBuf;
use std::{fmt, io};

/// An error of the shared-memory transport.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Unusable file or folder of the run folder.
    #[error("could not {attempt} {}: {source}", .path.display())]
    RunFolder {
        /// File operation that failed.
        attempt: &'static str,
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// File or folder that another user controls, or of the wrong kind, at a path of
    /// the run folder or of `/dev/shm`.
    #[error(
        "could not use {}: it is {kind} of user {owner}, and only a file or folder of \
         user {} that nobody else may write is safe there; remove it (as root, if it \
         belongs to another user), or set XDG_RUNTIME_DIR to a folder in memory that \
         only you may write",
        .path.display(),
        own_uid()
    )]
    Untrusted {
        /// Path of the file or folder in the way.
        path: PathBuf,
        /// Kind of the entry, such as "a symbolic link" or "a folder".
        kind: &'static str,
        /// User id of the folder's owner.
        owner: u32,
    },
    /// Exclusive role that is taken by a running process.
    #[error(
        "{role} is running in the domain {domain:?} already{}; stop it first, or choose \
         another domain with --domain NAME",
        in_process(*.pid)
    )]
    RoleTaken {
        /// Name of the role that is taken.
        role: String,
        /// Name of the domain in which the role is taken.
        domain: String,
        /// Id of the process that has the role, when it could be read.
        pid: Option<u32>,
    },
    /// Topic whose guest places are all taken.
    #[error(
        "all {places} places for guests that read {service} are taken{}; end one of them, or raise \
         guest_places in the section [shared_memory] of the configuration and restart the daemon",
        by_processes(holders)
    )]
    NoGuestPlace {
        /// Name of the topic.
        service: &'static str,
        /// Number of guest places of the domain.
        places: u32,
        /// Ids of the processes that have them.
        holders: Vec<u32>,
    },
    /// Insufficient shared memory for the daemon.
    #[error(
        "the daemon may use up to {} MB of shared memory and only {} MB of /dev/shm are free; \
         stop what uses it, or enlarge it (mount -o remount,size={}M /dev/shm; \
         in a container start it with a larger --shm-size){}",
        .needed.div_ceil(1_000_000),
        .available / 1_000_000,
        ample_mib(*.needed),
        with_fewer_guests(*.fitting_places)
    )]
    SharedMemory {
        /// Upper bound of the domain's use, bytes.
        needed: u64,
        /// Shared memory that is free and not reserved by others, bytes.
        available: u64,
        /// Number of guest places with which it would fit; `None` when even none is too many.
        fitting_places: Option<u32>,
    },
    /// Memory of a segment that could not be allocated.
    #[error(
        "the shared memory of {service} ({}) could not be allocated: {source}; stop what uses \
         /dev/shm, or enlarge it (mount -o remount,size=1G /dev/shm; in a container start it \
         with a larger --shm-size)",
        .path.display()
    )]
    Backing {
        /// Name of the iceoryx2 service.
        service: &'static str,
        /// File of the segment.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Service that exists with other types or limits.
    #[error(
        "the service {service} of the domain {domain:?} was made by another version of \
         tabula; stop all its processes and start them from one build"
    )]
    OtherVersion {
        /// Name of the iceoryx2 service.
        service: &'static str,
        /// Name of the affected domain.
        domain: String,
    },
    /// Failure of the iceoryx2 transport.
    #[error("shared memory failed to {attempt} {service}: {cause}")]
    Transport {
        /// Transport operation that failed.
        attempt: &'static str,
        /// Name of the iceoryx2 service, or empty.
        service: &'static str,
        /// Error description from iceoryx2.
        cause: String,
    },
    /// All loans of a publisher are held.
    #[error("all messages of {service} are in use; send or drop one first")]
    NoLoan {
        /// Name of the iceoryx2 service.
        service: &'static str,
    },
    /// Receiver with a full queue; the message was not delivered to it.
    #[error("a receiver of {service} does not keep up, its queue is full")]
    QueueFull {
        /// Name of the iceoryx2 service.
        service: &'static str,
    },
    /// Message longer than the service can carry.
    #[error("{service} carries at most {max} items in one message, not {len}")]
    TooLong {
        /// Name of the iceoryx2 service.
        service: &'static str,
        /// Requested number of items in a message.
        len: usize,
        /// Largest number of items that a message may have.
        max: usize,
    },
}

impl Error {
    pub(crate) fn transport(
        attempt: &'static str,
        service: &'static str,
        cause: impl fmt::Debug,
    ) -> Self {
        Self::Transport {
            attempt,
            service,
            cause: format!("{cause:?}"),
        }
    }
}

/// User id of this process, for sentences.
fn own_uid() -> u32 {
    rustix::process::geteuid().as_raw()
}

/// Size of shared memory that leaves as much free as is needed, MiB.
fn ample_mib(needed: u64) -> u64 {
    (needed.div_ceil(1 << 20) * 2).next_multiple_of(256)
}

fn by_processes(holders: &[u32]) -> String {
    match holders {
        [] => String::new(),
        [one] => format!(" (by process {one})"),
        several => {
            let ids: Vec<String> = several.iter().map(u32::to_string).collect();
            format!(" (by processes {})", ids.join(", "))
        }
    }
}

fn with_fewer_guests(places: Option<u32>) -> String {
    places.map_or_else(String::new, |places| {
        format!(
            "; it fits with guest_places = {places} in the section [shared_memory] of the \
             configuration"
        )
    })
}

fn in_process(pid: Option<u32>) -> String {
    pid.map_or(String::new(), |pid| format!(" (process {pid})"))
}
