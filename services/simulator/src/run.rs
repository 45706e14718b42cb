//! Simulator service: the simulation thread and the control server.

use crate::arm_loop::ArmLoop;
use crate::arm_orders::OrderSender;
use crate::config::Config;
use crate::frame_interval::FrameInterval;
use crate::simulator_source::{SimulatorSource, warm_camera};
use crate::world_publishers::WorldPublishers;
use arm_driver::{ArmDuties, ArmLog, ArmRequests, arm_requests};
use arm_interface::StopWord;
use capture::{CaptureEnd, CaptureLoop};
use channel::Publisher;
use channel::control::Server;
use message::ProcessKind;
use service::{Context, Failure, TaskGroup};
use simulated_world::World;
use tokio::runtime::Handle;
use tokio::sync::oneshot;

/// Runs the simulation until shutdown.
///
/// # Errors
/// When the scene cannot be set up, or shared memory fails.
pub(crate) async fn run(context: Context, config: Config) -> Result<(), Failure> {
    let (handler, requests) = arm_requests(context.domain.folder());
    let server = Server::bind(&context.domain, ProcessKind::SIMULATOR, handler)?;
    let (sender, ended) = oneshot::channel();
    let runtime = Handle::current();
    let spawned = std::thread::Builder::new()
        .name("simulation".into())
        .spawn(move || {
            let _ = sender.send(play(context, &config, requests, runtime));
        });
    spawned.map_err(|error| {
        Failure::general(format!("could not start the simulation's thread: {error}"))
    })?;
    let simulation = async {
        let ended = ended.await;
        outcome(ended.map_err(|_| Failure::general("the simulation's thread has panicked"))?)
    };
    let mut tasks = TaskGroup::default();
    tasks.spawn("the control server", server.run());
    tasks.run(simulation).await
}

/// Outcome of the process: a simulation ends only when it is stopped.
fn outcome(ended: Result<CaptureEnd, Failure>) -> Result<(), Failure> {
    match ended? {
        CaptureEnd::Stopped => Ok(()),
        CaptureEnd::EndOfRecording => {
            Err(Failure::general("the simulation has ended unexpectedly"))
        }
    }
}

fn play(
    context: Context,
    config: &Config,
    requests: ArmRequests,
    runtime: Handle,
) -> Result<CaptureEnd, Failure> {
    let (scene, library) = config.scene().map_err(Failure::usage)?;
    tracing::info!(
        "setting up {} with {} objects",
        config.name(),
        scene.objects.len()
    );
    let mut world = World::new(scene, library).map_err(Failure::usage)?;
    for note in world.take_notes() {
        tracing::warn!("{note}");
    }
    let names: Vec<_> = world
        .objects()
        .iter()
        .map(|object| object.model.name.as_str())
        .collect();
    tracing::info!("on the table: {}", names.join(", "));
    let entered = runtime.enter();
    let world_publishers = WorldPublishers::new(&context.domain)?;
    let has_arm = world.scene().arm.is_some();
    let publisher = has_arm.then(|| Publisher::new(&context.domain));
    let publisher = publisher.transpose()?;
    drop(entered);
    let arm_bytes = publisher.as_ref().map(|one| one.reservation().bytes());
    let shared_bytes = world_publishers.reserved_bytes() + arm_bytes.unwrap_or_default();
    let kinect = warm_camera(&world).map_err(Failure::usage)?;
    let word = has_arm.then(|| StopWord::create(context.domain.folder()));
    let word = word.transpose().map_err(Failure::general)?;
    let log = ArmLog::start().map_err(|error| not_started(&error))?;
    let arm_loop = ArmLoop {
        interval: FrameInterval::new(world, config.rate_hz),
        duties: ArmDuties::new(requests, word, log),
        publisher,
        is_lockstep: config.pace.is_lockstep(),
        is_real_time: config.real_time && has_arm,
    };
    let arm_loop = OrderSender::start(move |orders| arm_loop.run(&orders))
        .map_err(|error| not_started(&error))?;
    let source = SimulatorSource::new(
        config.name(),
        config.rate_hz,
        kinect,
        arm_loop,
        world_publishers,
    );
    let health = context.health.clone();
    let capture = CaptureLoop::new(context, Box::new(source), config.pace.clone(), runtime)?;
    health
        .shared_memory_bytes
        .fetch_add(shared_bytes, std::sync::atomic::Ordering::Relaxed);
    capture.run()
}

fn not_started(error: &std::io::Error) -> Failure {
    Failure::general(format!("could not start the arm's loop: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use service::exit_code;

    #[test]
    fn a_simulation_that_ends_by_itself_is_a_failure() {
        assert!(outcome(Ok(CaptureEnd::Stopped)).is_ok());
        let failure = outcome(Ok(CaptureEnd::EndOfRecording)).unwrap_err();
        assert_eq!(failure.code, exit_code::FAILURE);
        assert!(failure.to_string().contains("the simulation"), "{failure}");
    }
}
