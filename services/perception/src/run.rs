//! Perception service: set-up, main loop and shutdown.

use crate::actor_event_publisher::ActorEventPublisher;
use crate::config::Config;
use crate::control;
use crate::frame_loop::{FrameLoop, FrameLoopParts};
use crate::latest_scene::LatestScene;
use crate::liveness_probe::LivenessProbe;
use crate::memory_replica::{MemoryReplica, SharedCategories};
use crate::novelty_prior_file;
use crate::object_actor::ObjectActor;
use crate::object_actors::ObjectActors;
use crate::outbox::outbox;
use crate::restart_backoff::RestartBackoff;
use crate::track_ids::TrackIds;
use actor::{Events, Placement, PoolConfig, Restart, Supervisor, WorkerPool};
use channel::control::{Client, Server};
use message::{ProcessKind, ProcessState};
use service::{Context, Failure, HealthCounters, LiveConfig, TaskGroup};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Duration;
use tokio::runtime::Handle;

/// Time in which the memory usually answers, when both are started together.
const MEMORY_PATIENCE: Duration = Duration::from_secs(5);
/// Time limit for an actor to finish its message at shutdown.
const ACTOR_SHUTDOWN: Duration = Duration::from_secs(2);
/// Number of stalled workers at which the process gives up.
const MAX_ABANDONED: NonZeroUsize = NonZeroUsize::new(3).unwrap();
/// Mailbox capacity of an actor: a newer frame replaces one that is not begun.
const MAILBOX: NonZeroUsize = NonZeroUsize::new(1).unwrap();
/// Capacity of the event queue: all actors may start and stop in one frame.
const EVENTS: NonZeroUsize = NonZeroUsize::new(1024).unwrap();

/// Runs the service until shutdown.
///
/// # Errors
/// When shared memory fails, too many workers stall, or too many actors fail.
pub(crate) async fn run(context: Context, live: LiveConfig<Config>) -> Result<(), Failure> {
    let (config, domain) = (live.get(), &context.domain);
    let health = context.health.clone();
    let pool = start_pool(&config)?;
    let categories = SharedCategories::default();
    let (supervisor, events) = start_supervisor(&config, &pool)?;
    let memory = Arc::new(Client::new(domain, ProcessKind::MEMORY));
    let (outbox, outbox_sender) = outbox(memory.clone());
    let ids = Arc::new(TrackIds::default());
    // The configuration has laws with names only.
    let noise_law = config.detection.get().depth_noise.name().unwrap_or("");
    let latest_scene = Arc::new(LatestScene::new(noise_law));
    let backoff = Arc::new(RestartBackoff::default());
    let mut event_publisher =
        ActorEventPublisher::new(domain, events, backoff.clone(), health.clone())?;
    let (replica, sync_barrier) = MemoryReplica::new(domain, memory.clone(), categories.clone())?;
    let handler = control::handler(latest_scene.clone(), sync_barrier.clone(), health.clone());
    let server = Server::bind(domain, ProcessKind::PERCEPTION, handler)?;
    let (novelty_prior, prior_writer) = novelty_prior_file::open(&context.home);
    let parts = FrameLoopParts {
        pool: pool.clone(),
        actors: actors(&config, supervisor, backoff),
        ids: ids.clone(),
        outbox,
        sync_barrier,
        categories,
        novelty_prior,
        latest_scene,
        health: health.clone(),
    };
    let mut frames = FrameLoop::new(domain, live, parts)?;
    let mut tasks = TaskGroup::default();
    tasks.spawn("the control server", server.run());
    tasks.spawn("the replica of the memory", replica.run());
    tasks.spawn("the sender of key views", outbox_sender.run());
    tasks.spawn("the writer of the prior of novelty", prior_writer.run());
    tasks.spawn("the lease of track-ids", ids.clone().keep(memory.clone()));
    let liveness_probe = LivenessProbe::new(pool.clone(), health.clone());
    let work = async {
        let first_ids = liveness_probe.while_waiting(ids.fetch_first(&memory));
        wait_for_memory(first_ids, &health).await;
        health.set_state(ProcessState::Ready, "");
        frames.run().await.map_err(Failure::from)
    };
    let main = async {
        tokio::select! {
            biased;
            () = context.shutdown.requested() => Ok(()),
            outcome = work => outcome,
            () = pool.exhausted() => Err(Failure::general("too many worker threads have stalled")),
            escalated = event_publisher.watch() => Err(Failure::general(escalated)),
        }
    };
    let outcome = tasks.run(Box::pin(main)).await;
    frames.stop().await;
    outcome
}

/// Waits for the first track-ids. If the memory does not answer in time, the process reports
/// itself degraded, which ends the wait of its parent, and goes on waiting.
async fn wait_for_memory(first_ids: impl Future<Output = ()>, health: &HealthCounters) {
    tokio::pin!(first_ids);
    let timely = tokio::time::timeout(MEMORY_PATIENCE, &mut first_ids).await;
    if timely.is_err() {
        let note = "no objects are tracked: the memory does not answer; see its log";
        health.set_state(ProcessState::Degraded, note);
        first_ids.await;
    }
}

fn actors(
    config: &Config,
    supervisor: Supervisor<u64, ObjectActor>,
    backoff: Arc<RestartBackoff>,
) -> ObjectActors {
    ObjectActors::new(
        supervisor,
        backoff,
        config.pipeline,
        #[cfg(feature = "fault-injection")]
        config.fault,
    )
}

fn start_pool(config: &Config) -> Result<WorkerPool, Failure> {
    let pool = WorkerPool::start(PoolConfig {
        name: "kernel".into(),
        n_workers: config.workers,
        stall_after: config.worker_stall,
        max_abandoned: MAX_ABANDONED,
    })
    .map_err(Failure::general)?;
    pool.start_watchdog().map_err(Failure::general)?;
    Ok(pool)
}

fn start_supervisor(
    config: &Config,
    pool: &WorkerPool,
) -> Result<(Supervisor<u64, ObjectActor>, Events<u64>), Failure> {
    let policy = config.restart_policy().map_err(Failure::general)?;
    let supervision = actor::Config {
        restart: Restart::Transient,
        policy,
        placement: Placement::Pool(pool.clone()),
        mailbox_capacity: MAILBOX,
        shutdown: ACTOR_SHUTDOWN,
        event_capacity: EVENTS,
    };
    Ok(Supervisor::new(
        supervision,
        Arc::new(()),
        Handle::current(),
    ))
}
