//! Executive service: the control server and the thread of the executor.

use crate::config::Config;
use crate::executor::Executor;
use crate::task_requests::task_requests;
use channel::control::Server;
use message::{ProcessKind, ProcessState};
use service::{CommonArguments, Context, Failure, LiveConfig, TaskGroup};
use tokio::sync::oneshot;

/// Runs the service until shutdown.
///
/// # Errors
/// When the control server cannot be bound, or shared memory fails.
pub(crate) async fn run(
    context: Context,
    live: LiveConfig<Config>,
    common: CommonArguments,
) -> Result<(), Failure> {
    let (handler, requests) = task_requests();
    let server = Server::bind(&context.domain, ProcessKind::EXECUTIVE, handler)?;
    let (sender, ended) = oneshot::channel();
    let health = context.health.clone();
    let spawned = std::thread::Builder::new()
        .name("executor".into())
        .spawn(move || {
            let executor = Executor::new(context, live, common);
            let _ = sender.send(executor.and_then(|executor| executor.run(&requests)));
        });
    spawned.map_err(|error| {
        Failure::general(format!("could not start the executor's thread: {error}"))
    })?;
    let executor = async {
        let ended = ended.await;
        ended.map_err(|_| Failure::general("the executor's thread has panicked"))?
    };
    let mut tasks = TaskGroup::default();
    tasks.spawn("the control server", server.run());
    health.set_state(ProcessState::Ready, "");
    tasks.run(executor).await
}
