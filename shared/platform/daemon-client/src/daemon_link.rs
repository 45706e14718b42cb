//! Connection to the daemon's control socket, made anew after a failure.

use crate::{CallError, DaemonClient, DomainName, RunFolder};
use control_protocol::{Refusal, TypedRequest};
use std::time::{Duration, Instant};

/// Silence after which a connection is made anew: the gateway closes one after 10 s.
const IDLE_MAX: Duration = Duration::from_secs(5);

/// Reason for which a request has no answer in its own type.
#[derive(Debug, Clone, PartialEq)]
pub enum Unanswered {
    /// The owner of the request has refused it.
    Refused(Refusal),
    /// Nobody has answered; a repetition may succeed.
    NoAnswer(String),
}

impl std::fmt::Display for Unanswered {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Refused(refusal) => write!(f, "{refusal}"),
            Self::NoAnswer(sentence) => f.write_str(sentence),
        }
    }
}

/// Connection to the control socket of a domain.
#[derive(Debug)]
pub struct DaemonLink {
    domain: DomainName,
    folder: RunFolder,
    /// Time limit of a call.
    deadline: Duration,
    /// Connection with the time of its last answer.
    client: Option<(DaemonClient, Instant)>,
}

impl DaemonLink {
    /// Link to the daemon of a run folder, with the time limit of a call; connects with the first
    /// request.
    pub fn new(domain: DomainName, folder: RunFolder, deadline: Duration) -> Self {
        Self {
            domain,
            folder,
            deadline,
            client: None,
        }
    }

    /// Answer to a request. Without one the next request has a new connection.
    ///
    /// # Errors
    /// The refusal, or the reason for which nobody answers.
    pub fn ask<T>(&mut self, request: &TypedRequest<T>) -> Result<T, Unanswered> {
        let no_answer = |error: CallError| Unanswered::NoAnswer(error.to_string());
        let known = self.client.take();
        let fresh = known.filter(|(_, used)| used.elapsed() < IDLE_MAX);
        let mut client = match fresh {
            Some((client, _)) => client,
            None => DaemonClient::connect(
                &self.domain,
                std::slice::from_ref(&self.folder),
                self.deadline,
            )
            .map_err(no_answer)?,
        };
        let reply = client.call(request.command().clone()).map_err(no_answer)?;
        self.client = Some((client, Instant::now()));
        request.read(reply).map_err(Unanswered::Refused)
    }
}
