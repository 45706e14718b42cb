//! Connection to the daemon's control socket, made anew after a failure.

use control_protocol::{Refusal, TypedRequest};
use daemon_client::{CallError, DaemonClient, DomainName, RunFolder};
use std::time::Duration;

/// Time limit of a call. Chosen: less than the silence after which a lease of the arm ends.
const DEADLINE: Duration = Duration::from_millis(400);

/// Reason for which a request has no answer in its own type.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Unanswered {
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
pub(crate) struct DaemonLink {
    domain: DomainName,
    client: Option<DaemonClient>,
}

impl DaemonLink {
    pub(crate) fn new(domain: DomainName) -> Self {
        Self {
            domain,
            client: None,
        }
    }

    /// Answer to a request. Without one the next request has a new connection.
    ///
    /// # Errors
    /// The refusal, or the reason for which nobody answers.
    pub(crate) fn ask<T>(&mut self, request: &TypedRequest<T>) -> Result<T, Unanswered> {
        let no_answer = |error: CallError| Unanswered::NoAnswer(error.to_string());
        let mut client = match self.client.take() {
            Some(client) => client,
            None => DaemonClient::connect(&self.domain, &[RunFolder::of_user()], DEADLINE)
                .map_err(no_answer)?,
        };
        let reply = client.call(request.command().clone()).map_err(no_answer)?;
        self.client = Some(client);
        request.read(reply).map_err(Unanswered::Refused)
    }
}
