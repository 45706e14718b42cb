//! Fixed-step simulation of one frame interval, with rollback.
//!
//! A frame is rendered before its capture time. A command that reaches the arm in
//! between, above all a stop, must act at its own time: the interval is then simulated
//! again from its beginning, with the command in its place.

use geometry::Capsule;
use simulated_world::{ArmCommand, ArmStatus, STEP_NS, STEPS_PER_SECOND, World};
use std::sync::Arc;

/// Arm state at the end of a step.
#[derive(Debug, Clone)]
pub(crate) struct ArmSample {
    pub(crate) status: ArmStatus,
    pub(crate) capsules: Vec<Capsule>,
}

/// Frame interval: the simulation steps between two frames.
#[derive(Debug)]
pub(crate) struct FrameInterval {
    /// Snapshot of the world at the beginning, for rollback; kept only for scenes with an
    /// arm.
    start: Option<Arc<World>>,
    /// World at the end, shared with whoever renders it.
    world: Arc<World>,
    rate_hz: f64,
    frame: u64,
    /// Commands of this interval, each with the step before which it acts.
    commands: Vec<(usize, ArmCommand)>,
    samples: Vec<ArmSample>,
}

impl FrameInterval {
    pub(crate) fn new(world: World, rate_hz: f64) -> Self {
        Self {
            start: None,
            world: Arc::new(world),
            rate_hz,
            frame: 0,
            commands: Vec::new(),
            samples: Vec::new(),
        }
    }

    /// Simulated world at the end of the frame interval.
    pub(crate) fn shared_world(&self) -> Arc<World> {
        Arc::clone(&self.world)
    }

    /// Takes the accumulated messages of the world.
    pub(crate) fn take_notes(&mut self) -> Vec<String> {
        Arc::make_mut(&mut self.world).take_notes()
    }

    /// Number of frames completed so far.
    pub(crate) fn frame(&self) -> u64 {
        self.frame
    }

    /// Time that was simulated before this interval's end, nanoseconds.
    pub(crate) fn elapsed_ns(&self) -> u64 {
        self.n_steps_until(self.frame) * STEP_NS
    }

    /// Duration of this interval, nanoseconds.
    pub(crate) fn duration_ns(&self) -> u64 {
        self.n_steps() as u64 * STEP_NS
    }

    /// Arm state at the end of each step; empty without an arm.
    pub(crate) fn samples(&self) -> &[ArmSample] {
        &self.samples
    }

    /// Time from the end of a step to the end of the interval, nanoseconds.
    pub(crate) fn before_end_ns(&self, step: usize) -> u64 {
        (self.samples.len() - 1 - step) as u64 * STEP_NS
    }

    /// Advances the simulation to the next frame.
    pub(crate) fn advance(&mut self) {
        let has_arm = self.world.scene().arm.is_some();
        self.start = has_arm.then(|| Arc::clone(&self.world));
        self.commands.clear();
        self.frame += 1;
        self.run(self.n_steps());
    }

    /// Executes an arm command that arrived `before_end_ns` before the end of the
    /// interval: rolls the world back and repeats the later steps. Steps before `fixed`
    /// are kept. True if the world has changed.
    ///
    /// # Errors
    /// The sentence with which the arm refuses it.
    pub(crate) fn command(
        &mut self,
        command: &ArmCommand,
        before_end_ns: u64,
        fixed: usize,
    ) -> Result<bool, String> {
        let n_steps = self.samples.len();
        // Commands act in the order of arrival.
        let earliest = self.commands.last().map_or(fixed, |(step, _)| *step);
        let step = self.step_at(before_end_ns).max(earliest).max(fixed);
        self.commands.push((step, *command));
        let start = self.start.as_ref().filter(|_| step < n_steps);
        let Some(start) = start else {
            let world = Arc::make_mut(&mut self.world);
            return world.command_arm(command).map(|_| false);
        };
        self.world = Arc::clone(start);
        let answer = self.run(n_steps);
        answer.map_or(Ok(true), |answer| answer.map(|_| true))
    }

    /// Arm state at a time of the interval, or at its end.
    pub(crate) fn status_at(&self, before_end_ns: u64) -> Option<ArmStatus> {
        let at = self.samples.get(self.step_at(before_end_ns));
        at.map(|sample| sample.status.clone())
            .or_else(|| self.world.arm_status())
    }

    /// Index of the step that begins at a time.
    fn step_at(&self, before_end_ns: u64) -> usize {
        let n_after = usize::try_from(before_end_ns / STEP_NS).unwrap_or(usize::MAX);
        self.samples.len().saturating_sub(n_after)
    }

    /// Number of steps of this interval; frames are evenly spaced in the long run.
    fn n_steps(&self) -> usize {
        (self.n_steps_until(self.frame) - self.n_steps_until(self.frame - 1)) as usize
    }

    /// Number of steps of the first `n_frames` intervals.
    fn n_steps_until(&self, n_frames: u64) -> u64 {
        (n_frames as f64 * f64::from(STEPS_PER_SECOND) / self.rate_hz).round() as u64
    }

    /// Runs the steps; returns the arm's answer to the last command.
    fn run(&mut self, n_steps: usize) -> Option<Result<u64, String>> {
        self.samples.clear();
        let world = Arc::make_mut(&mut self.world);
        let mut answer = None;
        for step in 0..n_steps {
            for (_, command) in self.commands.iter().filter(|(at, _)| *at == step) {
                answer = Some(world.command_arm(command));
            }
            world.step();
            if let Some(status) = world.arm_status() {
                self.samples.push(ArmSample {
                    status,
                    capsules: world.arm_capsules(),
                });
            }
        }
        // Commands after the last step act in the next interval.
        for (_, command) in self.commands.iter().filter(|(at, _)| *at >= n_steps) {
            answer = Some(world.command_arm(command));
        }
        answer
    }
}
