//! The world from one frame to the next, which can be taken back.
//!
//! A frame is rendered before its instant. What reaches the arm in between, a
//! stop above all, must act at its own instant: the increment is then run again
//! from its beginning, with the command in its place.

use geometry::Capsule;
use simulated_world::{ArmCommand, ArmStatus, STEP_NS, STEPS_PER_SECOND, World};

/// The arm at the end of one step.
#[derive(Debug, Clone)]
pub(crate) struct ArmSample {
    pub(crate) status: ArmStatus,
    pub(crate) capsules: Vec<Capsule>,
}

/// The steps between two frames.
#[derive(Debug)]
pub(crate) struct Increment {
    /// The world at the beginning; kept only where there is an arm to command.
    start: Option<World>,
    world: World,
    rate_hz: f64,
    frame: u64,
    /// Commands of this increment with the step before which they act.
    commands: Vec<(usize, ArmCommand)>,
    samples: Vec<ArmSample>,
}

impl Increment {
    pub(crate) fn new(world: World, rate_hz: f64) -> Self {
        Self {
            start: None,
            world,
            rate_hz,
            frame: 0,
            commands: Vec::new(),
            samples: Vec::new(),
        }
    }

    /// The world at the end of the increment.
    pub(crate) fn world(&self) -> &World {
        &self.world
    }

    pub(crate) fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// Frames so far.
    pub(crate) fn frame(&self) -> u64 {
        self.frame
    }

    /// The arm at the end of each step; empty without an arm.
    pub(crate) fn samples(&self) -> &[ArmSample] {
        &self.samples
    }

    /// Time from the end of a step to the end of the increment, nanoseconds.
    pub(crate) fn before_end_ns(&self, step: usize) -> u64 {
        (self.samples.len() - 1 - step) as u64 * STEP_NS
    }

    /// Goes on to the next frame.
    pub(crate) fn advance(&mut self) {
        let has_arm = self.world.scene().arm.is_some();
        self.start = has_arm.then(|| self.world.clone());
        self.commands.clear();
        self.frame += 1;
        self.run(self.n_steps());
    }

    /// Gives the arm a command that arrived `before_end_ns` before the end of the
    /// increment, and runs what comes after it again; steps before `fixed` stay as
    /// they are. Whether the world is another one now.
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
        // In the order in which they came.
        let earliest = self.commands.last().map_or(fixed, |(step, _)| *step);
        let step = self.step_at(before_end_ns).max(earliest).max(fixed);
        self.commands.push((step, *command));
        if step >= n_steps {
            return self.world.command_arm(command).map(|_| false);
        }
        let Some(start) = &self.start else {
            return self.world.command_arm(command).map(|_| false);
        };
        self.world = start.clone();
        let answer = self.run(n_steps);
        answer.map_or(Ok(true), |told| told.map(|_| true))
    }

    /// The arm at an instant of the increment, or at its end.
    pub(crate) fn status_at(&self, before_end_ns: u64) -> Option<ArmStatus> {
        let at = self.samples.get(self.step_at(before_end_ns));
        at.map(|sample| sample.status.clone())
            .or_else(|| self.world.arm_status())
    }

    /// The step at whose beginning an instant is.
    fn step_at(&self, before_end_ns: u64) -> usize {
        let n_after = (before_end_ns / STEP_NS) as usize;
        self.samples.len().saturating_sub(n_after)
    }

    /// Steps of this increment: frames are evenly spaced in the long run.
    fn n_steps(&self) -> usize {
        let steps_at =
            |frame: u64| (frame as f64 * f64::from(STEPS_PER_SECOND) / self.rate_hz).round() as u64;
        (steps_at(self.frame) - steps_at(self.frame - 1)) as usize
    }

    /// Runs the steps; what the arm said to the last command is returned.
    fn run(&mut self, n_steps: usize) -> Option<Result<u64, String>> {
        self.samples.clear();
        let mut answer = None;
        for step in 0..n_steps {
            for (_, command) in self.commands.iter().filter(|(at, _)| *at == step) {
                answer = Some(self.world.command_arm(command));
            }
            self.world.step();
            if let Some(status) = self.world.arm_status() {
                self.samples.push(ArmSample {
                    status,
                    capsules: self.world.arm_capsules(),
                });
            }
        }
        // Those that came after the last step act in the next increment.
        for (_, command) in self.commands.iter().filter(|(at, _)| *at >= n_steps) {
            answer = Some(self.world.command_arm(command));
        }
        answer
    }
}
