//! Control servers: shared memory for processes, a Unix socket for people.

use crate::process_table::ProcessTable;
use crate::request_router::RequestRouter;
use crate::urgent_commands::UrgentCommands;
use channel::Domain;
use channel::control::{AnswerFuture, Handler, RoleGroups, Server, SocketServer, UrgentHandler};
use message::ProcessKind;
use std::sync::Arc;

/// The control servers of the gateway: shared memory for processes, a Unix socket for
/// people.
pub(crate) fn servers(
    domain: &Domain,
    router: RequestRouter,
    groups: &RoleGroups,
) -> Result<(Server, SocketServer), channel::Error> {
    let processes = Arc::clone(&router.processes);
    let router = Arc::new(router);
    let handler: Handler = Arc::new(move |command, peer| -> AnswerFuture {
        let router = router.clone();
        Box::pin(async move { router.answer(command, peer).await })
    });
    let urgent = urgent_handler(domain.clone(), processes);
    let server = Server::new(domain, ProcessKind::Memory, handler.clone())?;
    let people = SocketServer::bind(&domain.control_socket(), groups, handler, urgent)?;
    Ok((server, people))
}

fn urgent_handler(domain: Domain, processes: Arc<ProcessTable>) -> UrgentHandler {
    Box::new(move || {
        let commands = Arc::new(UrgentCommands::new(&domain, processes)?);
        Ok(Arc::new(move |command, _peer| -> AnswerFuture {
            let commands = commands.clone();
            Box::pin(async move { commands.answer(command).await })
        }))
    })
}
