//! Control loop of the simulated arm, on a thread of its own beside rendering.
//!
//! In each cycle it reads the stop word, looks at the lease of the commander, answers requests and
//! publishes the states of the arm that are due. It owns the simulated world, in which the arm moves.

use crate::arm_log::ArmLog;
use crate::arm_orders::{ChangedWorld, Order, Orders, Snapshot};
use crate::arm_requests::{ArmRequest, ArmRequests};
use crate::frame_interval::{ArmSample, FrameInterval};
use crate::wire_conversion;
use arm_interface::{CommandLease, LEASE_TIME_NS, StopWord, StopWordError};
use channel::Publisher;
use channel::topic::ArmStates;
use control_protocol::{ArmCommand, ArmLease, ArmReport, Refusal, RefusalKind};
use crossbeam::channel::TryRecvError;
use service::monotonic_ns;
use simulated_world::{ArmCommand as SimulatedCommand, STEP_NS};
use std::thread::Thread;
use std::time::Duration;
use tracing::Level;

/// Speed below which a joint is at rest, rad/s.
const REST_SPEED_RAD_S: f64 = 0.01;
/// Largest number of requests that are answered in a cycle. Chosen: the camera waits meanwhile.
const REQUESTS_PER_CYCLE: usize = 16;
/// Longest name of a commander, bytes. Chosen.
const MAX_HOLDER_BYTES: usize = 64;
/// Longest time for which the arm brakes after the end of the camera, nanoseconds. Chosen: twice
/// that of the fastest motion.
const FINAL_BRAKING_NS: u64 = 1_000_000_000;

/// The loop's parts that outlive a frame interval.
pub(crate) struct ArmLoop {
    pub(crate) interval: FrameInterval,
    pub(crate) requests: ArmRequests,
    pub(crate) publisher: Publisher<ArmStates>,
    /// Stop word; `None` in a scene without an arm.
    pub(crate) word: Option<StopWord>,
    /// True if the followers set the pace: time is that of the simulation.
    pub(crate) is_lockstep: bool,
    /// True if the loop is to have real-time priority.
    pub(crate) is_real_time: bool,
    pub(crate) log: ArmLog,
}

/// State of the running loop.
struct RunningLoop {
    parts: ArmLoop,
    changed: ChangedWorld,
    camera: Option<Thread>,
    lease: CommandLease,
    /// Time at which the commander was heard last, monotonic, nanoseconds.
    heard_ns: u64,
    /// End of the frame interval, monotonic; `None` before the camera has said it.
    end_ns: Option<u64>,
    /// Number of states of this interval that are published.
    n_published: usize,
    /// True from a stop until all joints are at rest.
    is_braking: bool,
    /// True if the stop word could not be read in the last cycle.
    is_word_lost: bool,
    /// First failure of a publication in this interval.
    failure: Option<channel::Error>,
}

impl ArmLoop {
    /// Runs until the camera ends.
    pub(crate) fn run(self, orders: &Orders) {
        if self.is_real_time {
            self.raise_priority();
        }
        self.requests.wake_this_thread();
        let mut running = RunningLoop {
            parts: self,
            changed: orders.changed.clone(),
            camera: None,
            lease: CommandLease::default(),
            heard_ns: 0,
            end_ns: None,
            n_published: 0,
            is_braking: false,
            is_word_lost: false,
            failure: None,
        };
        while running.cycle(orders) {
            std::thread::park_timeout(running.time_to_next_cycle());
        }
        running.brake_at_the_end();
    }

    fn raise_priority(&self) {
        match service::set_real_time_priority() {
            Ok(priority) => {
                let sentence = format!("the arm's loop has real-time priority {priority}");
                self.log.info(sentence);
            }
            Err(error) => self.log.info(format!(
                "the arm's loop runs without real-time priority ({error}); on a busy machine a \
                 stop takes longer"
            )),
        }
    }
}

impl RunningLoop {
    /// One cycle of the loop; `false` when the camera has ended.
    fn cycle(&mut self, orders: &Orders) -> bool {
        self.guard();
        loop {
            match orders.received.try_recv() {
                Ok(order) => self.obey(order),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return false,
            }
            self.guard();
        }
        for _ in 0..REQUESTS_PER_CYCLE {
            let Some(request) = self.parts.requests.next() else {
                break;
            };
            // The states before the answer are published before it.
            self.publish_until(monotonic_ns());
            self.answer(request);
            // A command costs a simulation of the interval, for which no stop shall wait twice.
            self.guard();
        }
        self.publish_until(monotonic_ns());
        true
    }

    /// Time to the next cycle: that of the next state, or of a step.
    fn time_to_next_cycle(&self) -> Duration {
        let now_ns = monotonic_ns();
        let next_ns = self.stamp_ns(self.n_published);
        let wait_ns = next_ns.map_or(STEP_NS, |next_ns| next_ns.saturating_sub(now_ns));
        Duration::from_nanos(wait_ns.min(STEP_NS))
    }

    /// Stops the arm when its stop word was pressed, or its commander is silent.
    fn guard(&mut self) {
        if let Some(word) = &mut self.parts.word {
            let polled = word.poll(monotonic_ns());
            let was_lost = std::mem::replace(&mut self.is_word_lost, polled.is_err());
            if let Err(error) = &polled
                && !was_lost
            {
                let sentence = format!("the arm is stopped, since its stop word is lost: {error}");
                self.parts.log.write(Level::ERROR, sentence);
            }
            if polled.unwrap_or(true) {
                self.stop();
            }
        }
        // In lockstep neither a fast simulation nor a slow one makes a commander silent.
        let is_heard = monotonic_ns() < self.heard_ns + LEASE_TIME_NS;
        if !(self.parts.is_lockstep && is_heard)
            && let Some(holder) = self.lease.expire(self.now_ns())
        {
            self.parts.log.warn(format!(
                "{holder} commands the arm and was silent for 0.5 s: the arm brakes"
            ));
            self.brake();
        }
    }

    /// Brakes the arm, and ends what was to be done.
    fn stop(&mut self) {
        let commander = self.lease.stop();
        self.parts.requests.refuse_commands();
        self.brake();
        if let Some(commander) = commander {
            let sentence = format!("the arm is stopped; {commander} commanded it");
            self.parts.log.info(sentence);
        }
        self.is_braking = true;
        self.acknowledge(|word| word.record_braking(monotonic_ns()));
    }

    fn brake(&mut self) {
        // A scene without an arm refuses it, and needs no stop.
        let _ = self.execute(&SimulatedCommand::Stop);
    }

    /// Writes into the file of the stop word.
    fn acknowledge(&self, write: impl FnOnce(&StopWord) -> Result<(), StopWordError>) {
        if let Some(Err(error)) = self.parts.word.as_ref().map(write) {
            let sentence = format!("a stop of the arm could not be acknowledged: {error}");
            self.parts.log.warn(sentence);
        }
    }

    fn obey(&mut self, order: Order) {
        match order {
            Order::Advance { answer, camera } => {
                for note in self.parts.interval.take_notes() {
                    self.parts.log.warn(note);
                }
                self.parts.interval.advance();
                self.n_published = 0;
                self.end_ns = None;
                self.camera = Some(camera);
                self.changed.put(None);
                // The camera may have ended.
                let _ = answer.send(self.snapshot());
            }
            Order::EndsAt(end_ns) => self.end_ns = Some(end_ns),
            Order::Close { end_ns, answer } => {
                self.end_ns = Some(end_ns);
                self.publish_until(u64::MAX);
                let _ = answer.send(self.failure.take().map_or(Ok(()), Err));
            }
        }
    }

    fn snapshot(&self) -> Snapshot {
        Snapshot {
            world: self.parts.interval.shared_world(),
            frame: self.parts.interval.frame(),
        }
    }

    fn answer(&mut self, request: ArmRequest) {
        let executed = self.carry_out(&request.command, request.arrived_ns);
        let report = executed.and_then(|()| {
            let no_arm = "the scene has no arm";
            self.report()
                .ok_or_else(|| Refusal::new(RefusalKind::Invalid, no_arm))
        });
        // The client may have gone.
        let _ = request.answer.send(report);
    }

    fn carry_out(&mut self, command: &ArmCommand, arrived_ns: u64) -> Result<(), Refusal> {
        let invalid = |sentence: String| Refusal::new(RefusalKind::Invalid, sentence);
        match command {
            ArmCommand::State => Ok(()),
            ArmCommand::Hold(lease) => self.renew(lease),
            ArmCommand::Release { lease } => {
                self.lease.release(*lease);
                if self.lease.holder().is_none() && self.is_busy() {
                    self.brake();
                }
                Ok(())
            }
            ArmCommand::Move { lease, motion } => {
                let motion_command = wire_conversion::command(motion).map_err(invalid)?;
                self.renew(lease)?;
                let sentence = format!("arm: {motion:?}, commanded by {}", lease.holder);
                self.parts.log.info(sentence);
                let before_end_ns = self.before_end_ns(arrived_ns);
                self.execute_at(&motion_command, before_end_ns)
                    .map_err(invalid)
            }
            ArmCommand::Stop => {
                let sentence = "a stop is a word in shared memory, and no request to the loop";
                Err(Refusal::new(RefusalKind::Internal, sentence))
            }
        }
    }

    /// Begins or renews the lease of a commander.
    fn renew(&mut self, lease: &ArmLease) -> Result<(), Refusal> {
        let holder = lease.holder.trim();
        let is_name = !holder.is_empty() && !holder.chars().any(char::is_control);
        if !is_name || holder.len() > MAX_HOLDER_BYTES {
            let sentence = format!(
                "{:?} is no name for a commander of the arm; choose 1 to {MAX_HOLDER_BYTES} bytes \
                 without control characters",
                lease.holder
            );
            return Err(Refusal::new(RefusalKind::Invalid, sentence));
        }
        let renewed = self.lease.renew(lease.id, holder, self.now_ns());
        if renewed.is_ok() {
            self.heard_ns = monotonic_ns();
        }
        renewed
            .map(drop)
            .map_err(|refusal| Refusal::new(RefusalKind::Conflict, refusal.to_string()))
    }

    /// Time for the lease, nanoseconds: that of the simulation in lockstep.
    fn now_ns(&self) -> u64 {
        if self.parts.is_lockstep {
            self.parts.interval.elapsed_ns()
        } else {
            monotonic_ns()
        }
    }

    fn is_busy(&self) -> bool {
        let status = self
            .parts
            .interval
            .status_at(self.before_end_ns(monotonic_ns()));
        status.is_some_and(|status| wire_conversion::is_busy(&status))
    }

    fn report(&self) -> Option<ArmReport> {
        let before_end_ns = self.before_end_ns(monotonic_ns());
        let status = self.parts.interval.status_at(before_end_ns)?;
        Some(ArmReport {
            commander: self.lease.holder().map(str::to_owned),
            ..wire_conversion::report(&status)
        })
    }

    /// Time from an instant to the end of the interval, nanoseconds: nothing between two frames and
    /// in lockstep; as long as possible while the camera has not said when it ends.
    fn before_end_ns(&self, at_ns: u64) -> u64 {
        match self.end_ns {
            _ if self.parts.is_lockstep => 0,
            Some(end_ns) => end_ns.saturating_sub(at_ns),
            None => u64::MAX,
        }
    }

    fn execute(&mut self, command: &SimulatedCommand) -> Result<(), String> {
        self.execute_at(command, self.before_end_ns(monotonic_ns()))
    }

    /// Executes a command at its time in the interval, and hands the changed world to the camera.
    fn execute_at(&mut self, command: &SimulatedCommand, before_end_ns: u64) -> Result<(), String> {
        let interval = &mut self.parts.interval;
        if interval.command(command, before_end_ns, self.n_published)? {
            self.changed.put(Some(self.snapshot()));
            if let Some(camera) = &self.camera {
                camera.unpark();
            }
        }
        Ok(())
    }

    /// Time of a state of the arm, monotonic, nanoseconds; `None` while it is unknown, and behind
    /// the last one.
    fn stamp_ns(&self, step: usize) -> Option<u64> {
        let interval = &self.parts.interval;
        let end_ns = self.end_ns?;
        (step < interval.samples().len())
            .then(|| end_ns.saturating_sub(interval.before_end_ns(step)))
    }

    /// Publishes the states of the arm up to a time, monotonic.
    fn publish_until(&mut self, until_ns: u64) {
        while let Some(stamp_ns) = self.stamp_ns(self.n_published)
            && stamp_ns <= until_ns
        {
            let sample = &self.parts.interval.samples()[self.n_published];
            let sent = send(&mut self.parts.publisher, sample, stamp_ns);
            let is_at_rest = is_at_rest(sample);
            if let Err(error) = sent {
                self.failure.get_or_insert(error);
            }
            self.n_published += 1;
            if self.is_braking && is_at_rest {
                self.is_braking = false;
                self.acknowledge(|word| word.record_rest(monotonic_ns()));
            }
        }
    }

    /// Brakes an arm that still moves when the camera ends, in real time.
    fn brake_at_the_end(&mut self) {
        if self.parts.is_lockstep {
            return;
        }
        if self.is_busy() {
            self.stop();
        }
        let begin_ns = monotonic_ns();
        while self.is_braking && monotonic_ns() < begin_ns + FINAL_BRAKING_NS {
            if self.n_published == self.parts.interval.samples().len() {
                self.parts.interval.advance();
                self.n_published = 0;
                self.end_ns = None;
            }
            let duration_ns = self.parts.interval.duration_ns();
            self.end_ns
                .get_or_insert_with(|| monotonic_ns() + duration_ns);
            self.publish_until(monotonic_ns());
            std::thread::sleep(self.time_to_next_cycle());
        }
    }
}

fn is_at_rest(sample: &ArmSample) -> bool {
    let speeds = sample.status.joint_velocities_rad_s;
    speeds.iter().all(|speed| speed.abs() < REST_SPEED_RAD_S)
}

fn send(
    publisher: &mut Publisher<ArmStates>,
    sample: &ArmSample,
    stamp_ns: u64,
) -> Result<(), channel::Error> {
    let capsules = wire_conversion::capsules(&sample.capsules);
    publisher.send_copy(
        wire_conversion::arm_state(&sample.status, stamp_ns),
        &capsules,
    )
}
