//! The process.

use crate::actor_events::EventDesk;
use crate::config::Config;
use crate::control;
use crate::frame_loop::{FrameLoop, Surroundings};
use crate::key_view_outbox::outbox;
use crate::learned::{Follower, SharedLearned};
use crate::object_actor::{ObjectActor, ObjectContext};
use crate::observation_round::Actors;
use crate::resting::Resting;
use crate::track_ids::TrackIds;
use crate::world::World;
use actor::{Events, Placement, PoolConfig, Restart, RestartPolicy, Supervisor, WorkerPool};
use channel::control::{Client, Server};
use message::{ProcessKind, ProcessState};
use service::{Context, Failure, exit_code};
use std::fmt::Display;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Duration;
use tokio::runtime::Handle;

/// How soon an actor that has failed starts again; each further time within the
/// window twice as late.
const FIRST_BACKOFF: Duration = Duration::from_millis(50);
const LONGEST_BACKOFF: Duration = Duration::from_secs(1);
/// An actor gets this long to finish the message at work.
const ACTOR_SHUTDOWN: Duration = Duration::from_secs(2);
/// Workers that may be left behind before the process gives up.
const MAX_ABANDONED: NonZeroUsize = NonZeroUsize::new(3).unwrap();
/// A newer frame replaces the one an actor has not begun.
const MAILBOX: NonZeroUsize = NonZeroUsize::new(1).unwrap();
/// All actors may come and go in one frame.
const EVENTS: NonZeroUsize = NonZeroUsize::new(1024).unwrap();

fn failed(error: impl Display) -> Failure {
    Failure::new(exit_code::FAILURE, error)
}

/// Works until shutdown.
///
/// # Errors
/// When shared memory fails, too many workers stall, or too many actors fail.
pub(crate) async fn run(context: Context, config: Config) -> Result<(), Failure> {
    let domain = &context.domain;
    let health = context.health.clone();
    let pool = start_pool(&config)?;
    let learned = SharedLearned::default();
    let (supervisor, events) = start_supervisor(&config, &pool, learned.clone())?;
    let memory = Arc::new(Client::new(domain, ProcessKind::Memory)?);
    let couriers = Arc::new(Client::new(domain, ProcessKind::Memory)?);
    let (outbox, courier) = outbox(couriers);
    let ids = Arc::new(TrackIds::default());
    let world = Arc::new(World::default());
    let resting = Arc::new(Resting::default());
    let mut desk = EventDesk::new(domain, events, resting.clone(), health.clone())?;
    let (follower, catch_up) = Follower::new(domain, memory.clone(), learned.clone())?;
    let handler = control::handler(world.clone(), catch_up.clone());
    let server = Server::new(domain, ProcessKind::Perception, handler)?;
    let given = Surroundings {
        pool: pool.clone(),
        actors: actors(&config, supervisor, resting),
        ids: ids.clone(),
        outbox,
        catch_up,
        learned,
        world,
        health: health.clone(),
    };
    let mut frames = FrameLoop::new(domain, &config, given)?;
    let work = async {
        ids.fetch_first(&memory).await;
        health.set_state(ProcessState::Ready, "");
        frames.run().await.map_err(Failure::from)
    };
    let keep_ids = ids.clone().keep(memory.clone());
    // The shutdown comes first: it may end other tasks in the same instant.
    let outcome = tokio::select! {
        biased;
        () = context.shutdown.requested() => Ok(()),
        outcome = work => outcome,
        ended = essential("the control server", server.run()) => ended,
        ended = essential("the replica of the memory", follower.run()) => ended,
        ended = essential("the sender of key views", courier.run()) => ended,
        ended = essential("the lease of track-ids", keep_ids) => ended,
        () = pool.exhausted() => Err(failed("too many worker threads have stalled")),
        escalated = desk.watch() => Err(failed(escalated)),
    };
    frames.stop().await;
    outcome
}

/// Runs a task that the process cannot do without: its end is a failure that names it.
async fn essential(name: &str, task: impl Future<Output = ()>) -> Result<(), Failure> {
    task.await;
    Err(failed(format!("{name} has ended unexpectedly")))
}

fn actors(
    config: &Config,
    supervisor: Supervisor<u64, ObjectActor>,
    resting: Arc<Resting>,
) -> Actors {
    #[cfg(not(feature = "fault-injection"))]
    let _ = config;
    Actors::new(
        supervisor,
        resting,
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
    .map_err(failed)?;
    pool.start_watchdog().map_err(failed)?;
    Ok(pool)
}

fn start_supervisor(
    config: &Config,
    pool: &WorkerPool,
    learned: SharedLearned,
) -> Result<(Supervisor<u64, ObjectActor>, Events<u64>), Failure> {
    let policy = RestartPolicy::new(
        config.actor_restarts_max,
        config.actor_restart_window,
        FIRST_BACKOFF,
        LONGEST_BACKOFF,
    )
    .map_err(failed)?;
    let supervision = actor::Config {
        restart: Restart::Transient,
        policy,
        placement: Placement::Pool(pool.clone()),
        mailbox_capacity: MAILBOX,
        shutdown: ACTOR_SHUTDOWN,
        event_capacity: EVENTS,
    };
    let context = Arc::new(ObjectContext {
        config: config.pipeline,
        learned,
    });
    Ok(Supervisor::new(supervision, context, Handle::current()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn the_end_of_an_essential_task_is_a_failure_that_names_it() {
        let ended = essential("the announcer", std::future::ready(())).await;
        let failure = ended.unwrap_err();
        assert_eq!(failure.code, exit_code::FAILURE);
        assert!(failure.to_string().contains("the announcer"), "{failure}");
    }
}
