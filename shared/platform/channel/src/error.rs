//! What can go wrong with a domain and its ports.

use std::path::PathBuf;
use std::{fmt, io};

/// An error of the shared-memory transport.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The domain's name breaks the rules.
    DomainName(String),
    /// A file or folder of the run folder can not be used.
    RunFolder {
        /// What was tried.
        attempt: &'static str,
        /// On what.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// A name in the run folder or in `/dev/shm` is taken by something that another
    /// user controls, or that is of the wrong kind.
    Untrusted {
        /// File or folder in the way.
        path: PathBuf,
        /// Kind of the entry: "a symbolic link", "a folder", ...
        kind: &'static str,
        /// User id of its owner.
        owner: u32,
    },
    /// A process of this role runs in the domain already.
    RoleTaken {
        /// The role.
        role: String,
        /// The domain.
        domain: String,
        /// Process id of the other one, when it could be read.
        pid: Option<u32>,
    },
    /// Not enough shared memory.
    SharedMemory {
        /// Bytes the domain will reserve at most.
        needed: u64,
        /// Bytes that are free and not promised to others.
        available: u64,
    },
    /// A service exists with other types or limits.
    OtherVersion {
        /// The service.
        service: &'static str,
        /// The domain.
        domain: String,
    },
    /// iceoryx2 refused.
    Transport {
        /// What was tried.
        attempt: &'static str,
        /// The service, or empty.
        service: &'static str,
        /// iceoryx2's words.
        cause: String,
    },
    /// All loans of a publisher are held.
    NoLoan {
        /// The service.
        service: &'static str,
    },
    /// A receiver's queue is full, the message was not delivered to it.
    QueueFull {
        /// The service.
        service: &'static str,
    },
    /// More items than the service carries.
    TooLong {
        /// The service.
        service: &'static str,
        /// Items asked for.
        len: usize,
        /// Items possible.
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

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DomainName(name) => write!(
                f,
                "the domain name {name:?} is not usable; choose 1 to 32 of the characters a-z, 0-9 and -"
            ),
            Self::RunFolder {
                attempt,
                path,
                source,
            } => {
                write!(f, "could not {attempt} {}: {source}", path.display())
            }
            Self::Untrusted { path, kind, owner } => write!(
                f,
                "could not use {}: it is {kind} of user {owner}, and only a file or folder of \
                 user {} that nobody else may write is safe there; remove it (as root, if it \
                 belongs to another user), or set XDG_RUNTIME_DIR to a folder in memory that \
                 only you may write",
                path.display(),
                rustix::process::geteuid().as_raw()
            ),
            Self::RoleTaken { role, domain, pid } => {
                write!(f, "{role} is running in the domain {domain:?} already")?;
                if let Some(pid) = pid {
                    write!(f, " (process {pid})")?;
                }
                f.write_str("; stop it first, or choose another domain with --domain NAME")
            }
            Self::SharedMemory { needed, available } => write!(
                f,
                "the daemon may use up to {} MB of shared memory and only {} MB of /dev/shm are free; \
                 stop what uses it, or enlarge it (mount -o remount,size=512M /dev/shm; \
                 in a container start it with a larger --shm-size)",
                needed.div_ceil(1_000_000),
                available / 1_000_000
            ),
            Self::OtherVersion { service, domain } => write!(
                f,
                "the service {service} of the domain {domain:?} was made by another version of \
                 tabula; stop all its processes and start them from one build"
            ),
            Self::Transport {
                attempt,
                service,
                cause,
            } => {
                write!(f, "shared memory failed to {attempt} {service}: {cause}")
            }
            Self::NoLoan { service } => {
                write!(
                    f,
                    "all messages of {service} are in use; send or drop one first"
                )
            }
            Self::QueueFull { service } => {
                write!(
                    f,
                    "a receiver of {service} does not keep up, its queue is full"
                )
            }
            Self::TooLong { service, len, max } => {
                write!(
                    f,
                    "{service} carries at most {max} items in one message, not {len}"
                )
            }
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::RunFolder { source, .. } => Some(source),
            _ => None,
        }
    }
}
