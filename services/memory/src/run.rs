//! The process.

use crate::announcer::Announcer;
use crate::answer::Answerer;
use crate::config::Config;
use crate::control;
use crate::process_table::ProcessTable;
use crate::scene_follower::SceneFollower;
use crate::upkeep;
use crate::world::World;
use crate::world_feed::WorldFeed;
use channel::control::Client;
use memory_requests::{MemoryDesk, MemoryDeskConfig};
use message::{ProcessKind, ProcessState};
use service::{Context, Failure, HealthBoard, exit_code, wall_clock_ns};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;
use store::{OpenReport, StoreConfig, StoreHandle, StoreThread};

/// How often the store is asked whether it still answers.
const PROBE: Duration = Duration::from_millis(500);

/// Answers until shutdown.
///
/// # Errors
/// When the store can not be opened or shared memory fails.
pub(crate) async fn run(context: Context, config: Config) -> Result<(), Failure> {
    let failed = |error: store::Error| Failure::new(exit_code::FAILURE, error);
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
                Ok(report) => tell(&health, report),
                Err(error) => tracing::error!("the memory could not be opened again: {error}"),
            }
        }),
    })
    .map_err(failed)?;
    tell(&context.health, &report);
    let (world_thread, world) = World::start(&context, &config)?;
    let world = Arc::new(world);
    let (desk, positions) = MemoryDesk::new(MemoryDeskConfig {
        store: store.clone(),
        scratch: context.home.path().join("exchange"),
        descriptor_kind: pipeline::DESCRIPTOR_KIND,
    });
    let domain = &context.domain;
    let processes = Arc::new(ProcessTable::new(domain)?);
    let answerer = Answerer {
        desk,
        perception: Client::new(domain, ProcessKind::Perception)?,
        arm: Client::new(domain, ProcessKind::Simulator)?,
        processes: processes.clone(),
        world: world.clone(),
    };
    let announcer = Announcer::new(domain, positions)?;
    let feed = WorldFeed::new(domain, world)?;
    let follower = SceneFollower::new(domain, context.health.clone(), feed, config.world_period)?;
    let reserved_bytes = announcer.reserved_bytes() + follower.reserved_bytes();
    context
        .health
        .shared_memory_bytes
        .store(reserved_bytes, Ordering::Relaxed);
    tokio::select! {
        served = control::serve(domain, answerer) => served?,
        () = announcer.run() => {}
        () = follower.run() => {}
        () = probe(&store, &context.health, &processes) => {}
        () = upkeep::run(&store, config.forgotten_kept) => {}
        () = context.shutdown.requested() => {}
    }
    let world_stopped = world_thread.stop();
    thread.stop().and(world_stopped).map_err(failed)
}

/// Says what was found when the store was opened, loudly when something is lost.
fn tell(health: &HealthBoard, report: &OpenReport) {
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

/// Makes progress visible: a round trip through the store's queue.
async fn probe(store: &StoreHandle, health: &HealthBoard, processes: &ProcessTable) {
    loop {
        let (sender, answered) = tokio::sync::oneshot::channel();
        store.read(
            |memory| Ok(memory.sequence()),
            move |answer| drop(sender.send(answer)),
        );
        if answered.await.is_ok() {
            health.tick();
        }
        processes.refresh();
        tokio::time::sleep(PROBE).await;
    }
}
