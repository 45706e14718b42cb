//! Memory service: set-up, tasks and shutdown.

use crate::change_publisher::ChangePublisher;
use crate::config::Config;
use crate::control;
use crate::daily_purge;
use crate::process_table::ProcessTable;
use crate::request_router::RequestRouter;
use crate::scene_follower::SceneFollower;
use crate::working_memory::WorkingMemory;
use crate::world_model_updater::WorldModelUpdater;
use channel::control::Client;
use memory_requests::{MemoryRequestHandler, MemoryRequestHandlerConfig};
use message::{ProcessKind, ProcessState};
use service::{Context, Failure, HealthCounters, exit_code, wall_clock_ns};
use std::fmt::Display;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;
use store::{OpenReport, StoreConfig, StoreHandle, StoreThread};

/// Period of the liveness probe of the store.
const PROBE: Duration = Duration::from_millis(500);

/// Runs the service until shutdown.
///
/// # Errors
/// When the store cannot be opened or shared memory fails.
pub(crate) async fn run(context: Context, config: Config) -> Result<(), Failure> {
    let folder = context.home.perceptual_memory();
    let (thread, store, report) = StoreThread::start(StoreConfig {
        folder,
        queue_capacity: config.queue_requests,
        limits: config.limits,
        write_buffer_bytes: config.write_buffer_bytes,
        wall_clock: || wall_clock_ns().max(0) as u64,
        on_reopened: Box::new({
            let health = context.health.clone();
            move |opened| match opened {
                Ok(report) => log_report(&health, report),
                Err(error) => tracing::error!("the memory could not be opened again: {error}"),
            }
        }),
    })
    .map_err(failed)?;
    log_report(&context.health, &report);
    let (world_thread, world) = WorkingMemory::start(&context, &config)?;
    let world = Arc::new(world);
    let (desk, positions) = MemoryRequestHandler::new(MemoryRequestHandlerConfig {
        store: store.clone(),
        scratch: context.home.path().join("exchange"),
        descriptor_kind: pipeline::DESCRIPTOR_KIND,
    });
    let domain = &context.domain;
    let processes = Arc::new(ProcessTable::new(domain)?);
    let router = RequestRouter {
        desk,
        perception: Client::new(domain, ProcessKind::Perception)?,
        arm: Client::new(domain, ProcessKind::Simulator)?,
        processes: processes.clone(),
        world: world.clone(),
        position: positions.clone(),
    };
    let change_publisher = ChangePublisher::new(domain, positions)?;
    let feed = WorldModelUpdater::new(domain, world)?;
    let follower = SceneFollower::new(domain, context.health.clone(), feed, config.world_period)?;
    let reserved_bytes = change_publisher.reserved_bytes() + follower.reserved_bytes();
    context
        .health
        .shared_memory_bytes
        .store(reserved_bytes, Ordering::Relaxed);
    let (processes_server, people_server) = control::servers(domain, router)?;
    let probe = probe(&store, &context.health, &processes);
    let daily_purge = daily_purge::run(&store, config.forgotten_kept);
    // The shutdown comes first: it may end other tasks in the same instant.
    let outcome = tokio::select! {
        biased;
        () = context.shutdown.requested() => Ok(()),
        ended = essential("the control server", processes_server.run()) => ended,
        ended = essential("the control socket", people_server.run()) => ended,
        ended = essential("the publisher of changes", change_publisher.run()) => ended,
        ended = essential("the scene follower", follower.run()) => ended,
        ended = essential("the probe of the store", probe) => ended,
        ended = essential("the daily purge", daily_purge) => ended,
    };
    let world_stopped = world_thread.stop();
    let stopped = thread.stop().and(world_stopped).map_err(failed);
    outcome.and(stopped)
}

fn failed(error: impl Display) -> Failure {
    Failure::new(exit_code::FAILURE, error)
}

/// Runs an essential task: its end is a failure that names it.
async fn essential(name: &str, task: impl Future<Output = ()>) -> Result<(), Failure> {
    task.await;
    Err(failed(format!("{name} has ended unexpectedly")))
}

/// Logs the result of opening the store; a loss degrades the health.
fn log_report(health: &HealthCounters, report: &OpenReport) {
    if report.is_loss() {
        tracing::error!("{report}");
        health.set_state(ProcessState::Degraded, &report.to_string());
    } else if report.is_damage() {
        tracing::warn!("{report}");
        health.set_state(ProcessState::Ready, &report.to_string());
    } else {
        tracing::info!("{report}");
        health.set_state(ProcessState::Ready, "");
    }
}

/// Liveness probe: a round trip through the store's queue.
async fn probe(store: &StoreHandle, health: &HealthCounters, processes: &ProcessTable) {
    loop {
        let (sender, answered) = tokio::sync::oneshot::channel();
        store.read(
            |memory| Ok(memory.sequence()),
            move |answer| drop(sender.send(answer)),
        );
        if answered.await.is_ok() {
            health.record_progress();
        }
        processes.refresh();
        tokio::time::sleep(PROBE).await;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn the_end_of_an_essential_task_is_a_failure_that_names_it() {
        let ended = essential("the publisher", std::future::ready(())).await;
        let failure = ended.unwrap_err();
        assert_eq!(failure.code, exit_code::FAILURE);
        assert!(failure.to_string().contains("the publisher"), "{failure}");
    }
}
