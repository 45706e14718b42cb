//! Errors of calls over the control protocol.

use control_protocol::Refusal;
use std::io;
use std::time::Duration;

/// Error of a request: no reply, or a refusal.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CallError {
    /// No daemon is running in this domain.
    #[error(
        "no daemon is running in the domain {domain:?}; start it with: tabula run{}",
        domain_option(.domain)
    )]
    NoDaemon {
        /// Name of the domain without a daemon.
        domain: String,
    },
    /// Process that does not run; the request was not sent.
    #[error(
        "tabula-{process} is not running just now; it is restarted if the daemon runs, try again"
    )]
    NotThere {
        /// Name of the process that did not answer.
        process: &'static str,
    },
    /// Process that ended before it answered. A mutation may or may not have been carried out.
    #[error("tabula-{process} ended before it answered; it is restarted, try again")]
    Interrupted {
        /// Name of the process that ended.
        process: &'static str,
    },
    /// Timeout. A mutation may or may not have been carried out: the same mutation id
    /// may be sent again.
    #[error(
        "no answer within {} s; the daemon is busy or stuck, see its log and `tabula doctor`",
        .after.as_secs_f64()
    )]
    TimedOut {
        /// Time limit that the reply exceeded.
        after: Duration,
    },
    /// Request that is too large, or too many open requests.
    #[error("{0}")]
    Refused(String),
    /// Refusal by the daemon: nothing was changed.
    #[error("{0}")]
    Refusal(Refusal),
    /// Failure of the socket.
    #[error("could not {attempt} the daemon: {source}")]
    Carrier {
        /// Transport operation that failed.
        attempt: &'static str,
        /// Error of the operating system.
        source: io::Error,
    },
}

/// Option that names a domain other than the default one.
fn domain_option(domain: &str) -> String {
    if domain == "default" {
        String::new()
    } else {
        format!(" --domain {domain}")
    }
}
