//! Why a call got no reply.

use std::time::Duration;
use std::{fmt, io};

/// A request that was not answered.
#[derive(Debug)]
#[non_exhaustive]
pub enum CallError {
    /// Nobody answers in this domain.
    NoDaemon {
        /// The domain.
        domain: String,
    },
    /// The process is not there, or went away before it answered.
    NotThere {
        /// Who should have answered.
        process: &'static str,
    },
    /// No answer in time. A mutation may or may not have been carried out: the
    /// same mutation id may be sent again.
    TimedOut {
        /// How long was waited.
        after: Duration,
    },
    /// The request is too large, or too many requests are open.
    Refused(String),
    /// The carrier failed.
    Carrier {
        /// What was tried.
        attempt: &'static str,
        /// Why not.
        source: io::Error,
    },
}

impl fmt::Display for CallError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDaemon { domain } => write!(
                f,
                "no daemon is running in the domain {domain:?}; start it with: tabula run{}",
                if domain == "default" {
                    String::new()
                } else {
                    format!(" --domain {domain}")
                }
            ),
            Self::NotThere { process } => write!(
                f,
                "tabula-{process} is not running just now; it is restarted if the daemon runs, try again"
            ),
            Self::TimedOut { after } => write!(
                f,
                "no answer within {} s; the daemon is busy or stuck, see its log and `tabula doctor`",
                after.as_secs_f64()
            ),
            Self::Refused(sentence) => f.write_str(sentence),
            Self::Carrier { attempt, source } => {
                write!(f, "could not {attempt} the daemon: {source}")
            }
        }
    }
}

impl std::error::Error for CallError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Carrier { source, .. } => Some(source),
            _ => None,
        }
    }
}
