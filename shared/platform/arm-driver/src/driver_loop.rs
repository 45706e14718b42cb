//! Control loop of a real arm's driver, at a fixed rate on a thread of its own.

use crate::arm_requests::arm_requests;
use crate::{ArmDuties, ArmLog, BrakingCause, CyclicArm};
use arm_interface::StopWord;
use channel::Publisher;
use channel::control::Server;
use channel::topic::ArmStates;
use message::{ProcessKind, ProcessState};
use service::{Context, Failure, TaskGroup, monotonic_ns};
use std::sync::atomic::Ordering;
use std::time::Duration;
use tokio::runtime::Handle;
use tokio::sync::oneshot;

/// Period of the loop: 125 cycles a second. Chosen: the rate of the simulated arm is 120.
pub const CYCLE: Duration = Duration::from_millis(8);
/// Largest number of requests that are answered in a cycle. Chosen: the other duties wait meanwhile.
pub const REQUESTS_PER_CYCLE: usize = 16;
/// Longest time for which an arm that is to end brakes. Chosen: twice that of the fastest motion.
pub const FINAL_BRAKING: Duration = Duration::from_secs(1);

/// Loop of a driver, with its arm.
struct DriverLoop<A> {
    arm: A,
    duties: ArmDuties,
    publisher: Publisher<ArmStates>,
    context: Context,
}

/// Runs the driver of an arm until shutdown: serves the arm's requests in its domain, and moves the
/// arm.
///
/// # Errors
/// When the domain has an arm already, shared memory fails, or the arm cannot be moved any more.
pub async fn run(context: Context, arm: impl CyclicArm + Send + 'static) -> Result<(), Failure> {
    let (handler, requests) = arm_requests(context.domain.folder());
    // First: its only place is taken where another arm moves.
    let publisher = Publisher::new(&context.domain).map_err(|error| {
        Failure::general(format!(
            "arm/state could not be published: {error}; a simulated scene with an arm, or a \
             recording, has this topic already"
        ))
    })?;
    let server = Server::bind(&context.domain, ProcessKind::ARM, handler)?;
    let word = StopWord::create(context.domain.folder()).map_err(Failure::general)?;
    let log = ArmLog::start()
        .map_err(|error| Failure::general(format!("could not start the arm's log: {error}")))?;
    let shared_bytes = publisher.reservation().bytes();
    let health = context.health.clone();
    health
        .shared_memory_bytes
        .fetch_add(shared_bytes, Ordering::Relaxed);
    let driver = DriverLoop {
        arm,
        duties: ArmDuties::new(requests, Some(word), log),
        publisher,
        context,
    };
    let (sender, ended) = oneshot::channel();
    let runtime = Handle::current();
    let spawned = std::thread::Builder::new()
        .name("arm".into())
        .spawn(move || {
            let _entered = runtime.enter();
            let _ = sender.send(driver.run());
        });
    spawned
        .map_err(|error| Failure::general(format!("could not start the arm's loop: {error}")))?;
    let arm_loop = async {
        let ended = ended.await;
        ended.map_err(|_| Failure::general("the arm's loop has panicked"))?
    };
    let mut tasks = TaskGroup::default();
    tasks.spawn("the control server", server.run());
    health.set_state(ProcessState::Ready, "");
    tasks.run(arm_loop).await
}

impl<A: CyclicArm> DriverLoop<A> {
    fn run(mut self) -> Result<(), Failure> {
        self.duties.take_this_thread(true);
        let shutdown = self.context.shutdown.clone();
        let mut next_ns = monotonic_ns();
        while !shutdown.is_requested() {
            next_ns = self.one_cycle(next_ns)?;
        }
        self.brake_at_the_end(next_ns)
    }

    /// One cycle, and the wait for the next one, in which requests are answered; returns the time at
    /// which that is due.
    fn one_cycle(&mut self, due_ns: u64) -> Result<u64, Failure> {
        self.duties.guard(&mut self.arm);
        let moved = self.move_and_publish();
        if moved.is_err() {
            // What it is worth: an arm that cannot be moved may brake nevertheless.
            self.arm.brake(BrakingCause::Stop);
        }
        moved?;
        self.context.health.record_progress();
        let cycle_ns = CYCLE.as_nanos() as u64;
        // Cycles that were missed are left out.
        let next_ns = (due_ns + cycle_ns).max(monotonic_ns());
        loop {
            self.answer_requests();
            let wait_ns = next_ns.saturating_sub(monotonic_ns());
            if wait_ns == 0 {
                return Ok(next_ns);
            }
            std::thread::park_timeout(Duration::from_nanos(wait_ns));
        }
    }

    fn answer_requests(&mut self) {
        for _ in 0..REQUESTS_PER_CYCLE {
            let Some(request) = self.duties.next_request() else {
                return;
            };
            self.duties.answer(request, &mut self.arm);
            self.duties.guard(&mut self.arm);
        }
    }

    fn move_and_publish(&mut self) -> Result<(), Failure> {
        let now_ns = monotonic_ns();
        self.arm.cycle(now_ns).map_err(Failure::general)?;
        let reading = self.arm.reading().map_err(Failure::general)?;
        let capsules = self.arm.capsules();
        self.publisher
            .send_copy(reading.message(now_ns), &capsules)?;
        self.duties.note_published(reading.is_at_rest());
        Ok(())
    }

    /// Brakes an arm that still moves when its driver ends.
    fn brake_at_the_end(&mut self, mut next_ns: u64) -> Result<(), Failure> {
        self.duties.stop(&mut self.arm);
        let begin_ns = monotonic_ns();
        while self.duties.is_braking()
            && monotonic_ns() < begin_ns + FINAL_BRAKING.as_nanos() as u64
        {
            next_ns = self.one_cycle(next_ns)?;
        }
        Ok(())
    }
}
