//! The two carriers in front of the answers.

use crate::answer::Answerer;
use channel::Domain;
use channel::control::{AnswerFuture, Handler, Server, SocketServer};
use message::ProcessKind;
use std::sync::Arc;

/// Serves processes through shared memory, and people through the socket, until
/// the future is dropped.
pub(crate) async fn serve(domain: &Domain, answerer: Answerer) -> Result<(), channel::Error> {
    let answerer = Arc::new(answerer);
    let handler: Handler = Arc::new(move |command| -> AnswerFuture {
        let answerer = answerer.clone();
        Box::pin(async move { answerer.answer(command).await })
    });
    let processes = Server::new(domain, ProcessKind::Memory, handler.clone())?;
    let people = SocketServer::bind(&domain.control_socket(), handler)?;
    tokio::join!(processes.run(), people.run());
    Ok(())
}
