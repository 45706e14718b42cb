//! Control servers: shared memory for processes, a Unix socket for people.

use crate::request_router::RequestRouter;
use channel::Domain;
use channel::control::{AnswerFuture, Handler, Server, SocketServer};
use message::ProcessKind;
use std::sync::Arc;

/// The control servers of the gateway: shared memory for processes, a Unix socket for
/// people.
pub(crate) fn servers(
    domain: &Domain,
    router: RequestRouter,
) -> Result<(Server, SocketServer), channel::Error> {
    let router = Arc::new(router);
    let handler: Handler = Arc::new(move |command| -> AnswerFuture {
        let router = router.clone();
        Box::pin(async move { router.answer(command).await })
    });
    let processes = Server::new(domain, ProcessKind::Memory, handler.clone())?;
    let people = SocketServer::bind(&domain.control_socket(), handler)?;
    Ok((processes, people))
}
