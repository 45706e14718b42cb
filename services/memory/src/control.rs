//! The two carriers in front of the answers.

use crate::answer::Answerer;
use channel::Domain;
use channel::control::{AnswerFuture, Handler, Server, SocketServer};
use message::ProcessKind;
use std::sync::Arc;

/// The control servers of the gateway: shared memory for processes, a Unix socket for
/// people.
pub(crate) fn servers(
    domain: &Domain,
    answerer: Answerer,
) -> Result<(Server, SocketServer), channel::Error> {
    let answerer = Arc::new(answerer);
    let handler: Handler = Arc::new(move |command| -> AnswerFuture {
        let answerer = answerer.clone();
        Box::pin(async move { answerer.answer(command).await })
    });
    let processes = Server::new(domain, ProcessKind::Memory, handler.clone())?;
    let people = SocketServer::bind(&domain.control_socket(), handler)?;
    Ok((processes, people))
}
