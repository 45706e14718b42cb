//! Control loop of the simulated arm, on a thread of its own beside rendering.
//!
//! In each cycle it reads the stop word, looks at the lease of the commander, answers requests and
//! publishes the states of the arm that are due. It owns the simulated world, in which the arm moves.

use crate::arm_orders::{ChangedWorld, Order, Orders, Snapshot};
use crate::frame_interval::{ArmSample, FrameInterval};
use crate::wire_conversion;
use arm_driver::{Arm, ArmDuties, ArmReading, BrakingCause, FINAL_BRAKING, REQUESTS_PER_CYCLE};
use channel::Publisher;
use channel::topic::ArmStates;
use control_protocol::ArmMotion;
use crossbeam::channel::TryRecvError;
use service::monotonic_ns;
use simulated_world::{ArmCommand as SimulatedCommand, STEP_NS};
use std::thread::Thread;
use std::time::Duration;

/// The loop's parts that outlive a frame interval.
pub(crate) struct ArmLoop {
    pub(crate) interval: FrameInterval,
    pub(crate) duties: ArmDuties,
    /// Publisher of the states; `None` in a scene without an arm, which leaves the topic to others.
    pub(crate) publisher: Option<Publisher<ArmStates>>,
    /// True if the followers set the pace: time is that of the simulation.
    pub(crate) is_lockstep: bool,
    /// True if the loop is to have real-time priority.
    pub(crate) is_real_time: bool,
}

/// State of the running loop.
struct RunningLoop {
    arm: IntervalArm,
    duties: ArmDuties,
    publisher: Option<Publisher<ArmStates>>,
    /// First failure of a publication in this interval.
    failure: Option<channel::Error>,
}

/// Arm in the present frame interval.
struct IntervalArm {
    interval: FrameInterval,
    is_lockstep: bool,
    changed: ChangedWorld,
    camera: Option<Thread>,
    /// End of the frame interval, monotonic; `None` before the camera has said it.
    end_ns: Option<u64>,
    /// Number of states of this interval that are published.
    n_published: usize,
}

impl ArmLoop {
    /// Runs until the camera ends.
    pub(crate) fn run(self, orders: &Orders) {
        self.duties.take_this_thread(self.is_real_time);
        let mut running = RunningLoop {
            arm: IntervalArm {
                interval: self.interval,
                is_lockstep: self.is_lockstep,
                changed: orders.changed.clone(),
                camera: None,
                end_ns: None,
                n_published: 0,
            },
            duties: self.duties,
            publisher: self.publisher,
            failure: None,
        };
        while running.cycle(orders) {
            std::thread::park_timeout(running.arm.time_to_next_cycle());
        }
        running.brake_at_the_end();
    }
}

impl RunningLoop {
    /// One cycle of the loop; `false` when the camera has ended.
    fn cycle(&mut self, orders: &Orders) -> bool {
        self.duties.guard(&mut self.arm);
        loop {
            match orders.received.try_recv() {
                Ok(order) => self.obey(order),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return false,
            }
            self.duties.guard(&mut self.arm);
        }
        for _ in 0..REQUESTS_PER_CYCLE {
            let Some(request) = self.duties.next_request() else {
                break;
            };
            // The states before the answer are published before it.
            self.publish_until(monotonic_ns());
            self.duties.answer(request, &mut self.arm);
            // A command costs a simulation of the interval, for which no stop shall wait twice.
            self.duties.guard(&mut self.arm);
        }
        self.publish_until(monotonic_ns());
        true
    }

    fn obey(&mut self, order: Order) {
        match order {
            Order::Advance { answer, camera } => {
                for note in self.arm.interval.take_notes() {
                    self.duties.log().warn(note);
                }
                self.arm.advance();
                self.arm.camera = Some(camera);
                self.arm.changed.put(None);
                // The camera may have ended.
                let _ = answer.send(self.arm.snapshot());
            }
            Order::EndsAt(end_ns) => self.arm.end_ns = Some(end_ns),
            Order::Close { end_ns, answer } => {
                self.arm.end_ns = Some(end_ns);
                self.publish_until(u64::MAX);
                let _ = answer.send(self.failure.take().map_or(Ok(()), Err));
            }
        }
    }

    /// Publishes the states of the arm up to a time, monotonic.
    fn publish_until(&mut self, until_ns: u64) {
        let arm = &mut self.arm;
        while let Some(stamp_ns) = arm.stamp_ns(arm.n_published)
            && stamp_ns <= until_ns
        {
            let sample = &arm.interval.samples()[arm.n_published];
            let reading = wire_conversion::reading(&sample.status);
            if let Some(publisher) = &mut self.publisher
                && let Err(error) = send(publisher, &reading, sample, stamp_ns)
            {
                self.failure.get_or_insert(error);
            }
            arm.n_published += 1;
            self.duties.note_published(reading.is_at_rest());
        }
    }

    /// Brakes an arm that still moves when the camera ends, in real time.
    fn brake_at_the_end(&mut self) {
        if self.arm.is_lockstep {
            return;
        }
        if self.arm.reading().is_ok_and(|reading| reading.is_busy()) {
            self.duties.stop(&mut self.arm);
        }
        let end_ns = monotonic_ns() + FINAL_BRAKING.as_nanos() as u64;
        while self.duties.is_braking() && monotonic_ns() < end_ns {
            if self.arm.n_published == self.arm.interval.samples().len() {
                self.arm.advance();
            }
            let duration_ns = self.arm.interval.duration_ns();
            self.arm
                .end_ns
                .get_or_insert_with(|| monotonic_ns() + duration_ns);
            self.publish_until(monotonic_ns());
            std::thread::sleep(self.arm.time_to_next_cycle());
        }
    }
}

impl IntervalArm {
    /// Simulates the next frame interval, whose end is not known yet.
    fn advance(&mut self) {
        self.interval.advance();
        self.n_published = 0;
        self.end_ns = None;
    }

    fn snapshot(&self) -> Snapshot {
        Snapshot {
            world: self.interval.shared_world(),
            frame: self.interval.frame(),
        }
    }

    /// Time to the next cycle: that of the next state, or of a step.
    fn time_to_next_cycle(&self) -> Duration {
        let now_ns = monotonic_ns();
        let next_ns = self.stamp_ns(self.n_published);
        let wait_ns = next_ns.map_or(STEP_NS, |next_ns| next_ns.saturating_sub(now_ns));
        Duration::from_nanos(wait_ns.min(STEP_NS))
    }

    /// Time from an instant to the end of the interval, nanoseconds: nothing between two frames and
    /// in lockstep; as long as possible while the camera has not said when it ends.
    fn before_end_ns(&self, at_ns: u64) -> u64 {
        match self.end_ns {
            _ if self.is_lockstep => 0,
            Some(end_ns) => end_ns.saturating_sub(at_ns),
            None => u64::MAX,
        }
    }

    /// Time of a state of the arm, monotonic, nanoseconds; `None` while it is unknown, and behind
    /// the last one.
    fn stamp_ns(&self, step: usize) -> Option<u64> {
        let end_ns = self.end_ns?;
        (step < self.interval.samples().len())
            .then(|| end_ns.saturating_sub(self.interval.before_end_ns(step)))
    }

    /// Executes a command at its time in the interval, and hands the changed world to the camera.
    fn execute_at(&mut self, command: &SimulatedCommand, at_ns: u64) -> Result<(), String> {
        let before_end_ns = self.before_end_ns(at_ns);
        let interval = &mut self.interval;
        if interval.command(command, before_end_ns, self.n_published)? {
            self.changed.put(Some(self.snapshot()));
            if let Some(camera) = &self.camera {
                camera.unpark();
            }
        }
        Ok(())
    }
}

impl Arm for IntervalArm {
    fn begin(&mut self, motion: &ArmMotion, arrived_ns: u64) -> Result<(), String> {
        self.execute_at(&wire_conversion::command(motion)?, arrived_ns)
    }

    fn brake(&mut self, _cause: BrakingCause) {
        // A scene without an arm refuses it, and needs no stop.
        let _ = self.execute_at(&SimulatedCommand::Stop, monotonic_ns());
    }

    fn reading(&self) -> Result<ArmReading, String> {
        let before_end_ns = self.before_end_ns(monotonic_ns());
        let status = self.interval.status_at(before_end_ns);
        let status = status.ok_or("the scene has no arm")?;
        Ok(wire_conversion::reading(&status))
    }

    fn lease_clock_ns(&self) -> u64 {
        if self.is_lockstep {
            self.interval.elapsed_ns()
        } else {
            monotonic_ns()
        }
    }
}

fn send(
    publisher: &mut Publisher<ArmStates>,
    reading: &ArmReading,
    sample: &ArmSample,
    stamp_ns: u64,
) -> Result<(), channel::Error> {
    let capsules = wire_conversion::capsules(&sample.capsules);
    publisher.send_copy(reading.message(stamp_ns), &capsules)
}
