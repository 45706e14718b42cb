//! Memory service: set-up, tasks and shutdown.

use crate::change_publisher::ChangePublisher;
use crate::config::Config;
use crate::configuration_change::ConfigurationChange;
use crate::daily_purge;
use crate::health_conditions::{Condition, HealthConditions, Store};
use crate::request_router::RequestRouter;
use crate::scene_follower::SceneFollower;
use crate::working_memory::WorkingMemory;
use crate::world_model_updater::WorldModelUpdater;
use channel::control::{self, Client, Server};
use memory_requests::{MemoryRequestHandler, MemoryRequestHandlerConfig};
use message::ProcessKind;
use perceptual_memory::{OpenReport, StoreConfig, StoreHandle, StoreThread};
use service::{Context, Failure, HealthCounters, LiveConfig, TaskGroup, wall_clock_ns};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use working_memory::WorldThread;

/// Period of the liveness probe of the store.
const PROBE: Duration = Duration::from_millis(500);
/// Time after which a store that is still being opened counts as hung. Chosen: opening
/// takes a second, and a rebuild 5 us for each entry of the history.
const LONGEST_OPENING: Duration = Duration::from_secs(600);

/// Runs the service until shutdown.
///
/// # Errors
/// When the store cannot be opened or shared memory fails.
pub(crate) async fn run(context: Context, live: LiveConfig<Config>) -> Result<(), Failure> {
    let config = live.get();
    context.home.prepare_memories()?;
    let health = Arc::new(HealthConditions::new(context.health.clone()));
    let (threads, store, world) = open_memories(&context, &config, &health)?;
    let world = Arc::new(world);
    let (handler, positions) = MemoryRequestHandler::new(MemoryRequestHandlerConfig {
        store: store.clone(),
        scratch: context.home.path().join("exchange"),
        uploads: config.uploads,
        descriptor_kind: learning::DESCRIPTOR_KIND,
    });
    let handler = Arc::new(handler);
    let domain = &context.domain;
    let (change_publisher, announced) = ChangePublisher::new(domain, positions.clone())?;
    let router = RequestRouter {
        handler: handler.clone(),
        perception: Client::new(domain, ProcessKind::PERCEPTION),
        world: world.clone(),
        synonyms: Arc::default(),
        position: positions,
        announced,
    };
    let feed = WorldModelUpdater::new(domain, world.clone())?;
    let follower = SceneFollower::new(domain, context.health.clone(), feed, live.clone())?;
    let reserved_bytes = change_publisher.reserved_bytes() + follower.reserved_bytes();
    context
        .health
        .shared_memory_bytes
        .store(reserved_bytes, Ordering::Relaxed);
    let router = Arc::new(router);
    let answers = control::handler(move |command, user| {
        let router = router.clone();
        async move { router.answer(command, user).await }
    });
    let server = Server::bind(domain, ProcessKind::MEMORY, answers)?;
    let probe = probe(store.clone(), context.health.clone());
    let configuration_change = ConfigurationChange {
        store: store.clone(),
        handler,
        world,
    };
    let mut tasks = TaskGroup::default();
    tasks.spawn("the request server", server.run());
    tasks.spawn("the publisher of changes", change_publisher.run());
    tasks.spawn("the scene follower", follower.run());
    tasks.spawn("the probe of the store", probe);
    spawn_upkeep(&mut tasks, store, configuration_change, live);
    health.begin_service();
    let shutdown = async {
        context.shutdown.requested().await;
        Ok(())
    };
    let outcome = tasks.run(shutdown).await;
    outcome.and(threads.stop())
}

/// Threads that write the memories.
struct MemoryThreads {
    store: StoreThread,
    world: WorldThread,
}

impl MemoryThreads {
    /// Stops both when they have written what they have taken.
    fn stop(self) -> Result<(), Failure> {
        let world = self.world.stop().map_err(Failure::general);
        self.store.stop().map_err(Failure::general).and(world)
    }
}

/// Opens both memories. A large store takes its time, and a rebuild minutes, which is no reason to
/// begin again: progress is recorded meanwhile.
fn open_memories(
    context: &Context,
    config: &Config,
    health: &Arc<HealthConditions>,
) -> Result<(MemoryThreads, StoreHandle, WorkingMemory), Failure> {
    context.health.record_progress_during(LONGEST_OPENING, || {
        let (store_thread, store, report) = open_store(context, config, health)?;
        log_report(health, &report);
        let (world_thread, world) = WorkingMemory::start(context, config, health)?;
        let threads = MemoryThreads {
            store: store_thread,
            world: world_thread,
        };
        Ok((threads, store, world))
    })
}

/// Spawns what keeps the memory in order, with the newest configuration.
fn spawn_upkeep(
    tasks: &mut TaskGroup,
    store: StoreHandle,
    configuration_change: ConfigurationChange,
    live: LiveConfig<Config>,
) {
    let handler = configuration_change.handler.clone();
    let expiry = async move { handler.expire_jobs().await };
    tasks.spawn("the expiry of jobs", expiry);
    tasks.spawn("the daily purge", daily_purge::run(store, live.clone()));
    let configuration_change = configuration_change.follow(live);
    tasks.spawn("the change of the configuration", configuration_change);
}

fn open_store(
    context: &Context,
    config: &Config,
    health: &Arc<HealthConditions>,
) -> Result<(StoreThread, StoreHandle, OpenReport), Failure> {
    StoreThread::start(StoreConfig {
        folder: context.home.perceptual_memory(),
        queue_capacity: config.queue_requests,
        limits: config.limits,
        write_buffer_bytes: config.write_buffer_bytes,
        wall_clock: || wall_clock_ns().max(0) as u64,
        on_reopened: Box::new({
            let health = health.clone();
            move |opened| match opened {
                Ok(report) => log_report(&health, report),
                Err(error) => {
                    let note = format!("the memory could not be opened again: {error}");
                    tracing::error!("{note}");
                    health.set(Store::Perceptual, Condition::degraded(note));
                }
            }
        }),
        on_notice: Box::new(|notice| tracing::warn!("{notice}")),
    })
    .map_err(Failure::general)
}

/// Logs the result of opening the store; a loss, or a store that can only be read, degrades the
/// health.
fn log_report(health: &HealthConditions, report: &OpenReport) {
    let is_degraded = report.is_loss() || report.is_read_only();
    if is_degraded {
        tracing::error!("{report}");
    } else if report.is_damage() {
        tracing::warn!("{report}");
    } else {
        tracing::info!("{report}");
    }
    let note = if is_degraded || report.is_damage() {
        report.to_string()
    } else {
        String::new()
    };
    health.set(Store::Perceptual, Condition { is_degraded, note });
}

/// Liveness probe: a round trip through the store's queue.
async fn probe(store: StoreHandle, health: Arc<HealthCounters>) {
    loop {
        let (sender, answered) = tokio::sync::oneshot::channel();
        store.read(
            |memory| Ok(memory.sequence()),
            move |answer| drop(sender.send(answer)),
        );
        // An answer that is an error is no progress: the store may be stuck with it.
        let answered = while_opening(&store, &health, answered).await;
        if matches!(answered, Ok(Ok(_))) {
            health.record_progress();
        }
        tokio::time::sleep(PROBE).await;
    }
}

/// Waits for an answer of the store. Opening a large store again is progress, though it answers
/// nothing meanwhile, for a limited time.
async fn while_opening<T>(
    store: &StoreHandle,
    health: &HealthCounters,
    answer: impl Future<Output = T>,
) -> T {
    tokio::pin!(answer);
    let begun = Instant::now();
    loop {
        tokio::select! {
            biased;
            answer = &mut answer => return answer,
            () = tokio::time::sleep(PROBE) => {
                if store.is_opening() && begun.elapsed() < LONGEST_OPENING {
                    health.record_progress();
                }
            }
        }
    }
}
