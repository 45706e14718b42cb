//! Daemon with a simulated arm that swings to and fro, under the lease of this process.

use crate::measured_daemon::MeasuredDaemon;
use arm_interface::StopButton;
use channel::topic::ArmStates;
use channel::{Domain, Role, Subscriber};
use control_protocol::{ArmLease, ArmMotion, TypedRequest, request};
use daemon_client::{DaemonClient, RunFolder};
use service::Failure;
use std::cell::RefCell;
use std::path::Path;
use std::time::{Duration, Instant};

/// Turn of the first joint in a motion, radians.
const TURN_RAD: f64 = 1.2;
/// Speed above which the arm moves, rad/s.
const MOVING_RAD_S: f64 = 0.2;
/// Maximum time until a commanded arm moves.
const MOVING_TIMEOUT: Duration = Duration::from_secs(20);
/// Pause between two looks at the state of the arm.
const POLL_PERIOD: Duration = Duration::from_millis(2);
/// Time limit for an answer of the daemon.
const ANSWER_LIMIT: Duration = Duration::from_secs(2);
/// Period in which the lease is renewed.
const RENEWAL: Duration = Duration::from_millis(100);

/// Daemon with an arm.
pub(crate) struct MovingArm {
    states: RefCell<Subscriber<ArmStates>>,
    domain: Domain,
    daemon: MeasuredDaemon,
}

impl MovingArm {
    /// Joins the daemon's domain.
    pub(crate) fn new(daemon: MeasuredDaemon) -> Result<Self, Failure> {
        let domain = Domain::join(daemon.domain(), &RunFolder::of_user(), Role::Guest)?;
        Ok(Self {
            states: RefCell::new(Subscriber::polled(&domain)?),
            domain,
            daemon,
        })
    }

    pub(crate) fn daemon(&self) -> &MeasuredDaemon {
        &self.daemon
    }

    /// Answer of the daemon to a request.
    pub(crate) fn ask<T>(&self, request: &TypedRequest<T>) -> Result<T, Failure> {
        let folders = [RunFolder::of_user()];
        let answer = DaemonClient::ask_once(self.daemon.domain(), &folders, ANSWER_LIMIT, request);
        answer.map_err(Failure::general)
    }

    /// Folder of the domain.
    pub(crate) fn folder(&self) -> &Path {
        self.domain.folder()
    }

    /// Stop button of the arm.
    pub(crate) fn button(&self) -> Result<StopButton, Failure> {
        StopButton::open(self.folder()).map_err(Failure::general)
    }

    /// Lets the arm swing to the side of `turn`, and returns when it moves.
    ///
    /// # Errors
    /// When the arm does not move in time.
    pub(crate) fn swing(&self, turn: usize) -> Result<(), Failure> {
        let id = getrandom::u64().map_err(Failure::general)?;
        let lease = ArmLease {
            id,
            holder: "tabula latency stop".to_owned(),
        };
        let begun = Instant::now();
        let side = if turn.is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut renewed = self.command(&lease, side * TURN_RAD);
        let mut at = Instant::now();
        while begun.elapsed() < MOVING_TIMEOUT {
            if self.is_moving()? {
                return Ok(());
            }
            if at.elapsed() >= RENEWAL {
                // A memory that is killed takes no part; a busy gateway is asked again.
                renewed = match renewed {
                    Ok(()) => self.ask(&request::hold_arm(lease.clone())).map(drop),
                    Err(_) => self.command(&lease, side * TURN_RAD),
                };
                at = Instant::now();
            }
            std::thread::sleep(POLL_PERIOD);
        }
        let reason = renewed
            .err()
            .map_or(String::new(), |error| format!(": {error}"));
        Err(Failure::general(format!(
            "the arm, which was to be stopped, has not moved within 20 s{reason}"
        )))
    }

    /// Turns the first joint to an angle from its home.
    fn command(&self, lease: &ArmLease, turn_rad: f64) -> Result<(), Failure> {
        let mut angles_rad = self.ask(&request::arm())?.joint_angles_rad;
        angles_rad[0] = turn_rad;
        let motion = ArmMotion::MoveJoints { angles_rad };
        self.ask(&request::move_arm(lease.clone(), motion))
            .map(drop)
    }

    /// True if the newest state shows a moving arm.
    fn is_moving(&self) -> Result<bool, Failure> {
        let mut is_moving = false;
        self.states.borrow_mut().take_all(|state| {
            let speeds = state.header().joint_velocities_rad_s;
            is_moving = speeds.iter().any(|speed| speed.abs() > MOVING_RAD_S);
        })?;
        Ok(is_moving)
    }
}
