//! Gateway service: set-up, tasks and shutdown.

use crate::config::Config;
use crate::history_position::HistoryPosition;
use crate::process_table::ProcessTable;
use crate::request_router::RequestRouter;
use crate::urgent_commands::UrgentCommands;
use channel::Domain;
use channel::control::{self, AccessControl, Handler, SocketServer};
use message::ProcessState;
use service::{Context, Failure, HealthCounters, LiveConfig, TaskGroup};
use std::sync::Arc;
use tokio::sync::mpsc::Receiver;

/// Runs the service until shutdown.
///
/// # Errors
/// When the control socket cannot be bound, or shared memory fails.
pub(crate) async fn run(context: Context, live: LiveConfig<Config>) -> Result<(), Failure> {
    let domain = &context.domain;
    let processes = Arc::new(ProcessTable::new(domain)?);
    let router = RequestRouter::new(domain, processes.clone(), HistoryPosition::new(domain)?);
    let (ordinary, urgent) = (
        ordinary_handler(router),
        urgent_handler(domain, processes.clone()),
    );
    let groups = &live.get().groups;
    let mut server = SocketServer::bind(&domain.control_socket(), groups, ordinary, urgent)?;
    let access = server.access_control();
    let progress = record_progress(server.heartbeat(), context.health.clone(), processes);
    let mut tasks = TaskGroup::default();
    tasks.spawn("the control socket", server.run());
    tasks.spawn("the record of progress", progress);
    tasks.spawn("the change of the groups", follow_groups(access, live));
    context.health.set_state(ProcessState::Ready, "");
    let shutdown = async {
        context.shutdown.requested().await;
        Ok(())
    };
    tasks.run(shutdown).await
}

/// Records progress while the thread of the control socket and this runtime both work.
async fn record_progress(
    mut heartbeat: Receiver<()>,
    health: Arc<HealthCounters>,
    processes: Arc<ProcessTable>,
) {
    while heartbeat.recv().await.is_some() {
        health.record_progress();
        processes.refresh();
    }
}

/// Takes the groups of each new configuration, until the future is dropped.
async fn follow_groups(access: AccessControl, mut live: LiveConfig<Config>) {
    loop {
        access.set_groups(&live.change().await.groups);
    }
}

fn ordinary_handler(router: RequestRouter) -> Handler {
    let router = Arc::new(router);
    control::handler(move |command, user| {
        let router = router.clone();
        async move { router.answer(command, user).await }
    })
}

fn urgent_handler(domain: &Domain, processes: Arc<ProcessTable>) -> Handler {
    let commands = Arc::new(UrgentCommands::new(domain, processes));
    control::handler(move |command, _user| {
        let commands = commands.clone();
        async move { commands.answer(command).await }
    })
}
