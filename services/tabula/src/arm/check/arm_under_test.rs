//! Arm under test: requests to it, its published states, and motions of its last joint.

use super::arm_record::{RecordedState, is_at_rest};
use super::lease_keeper::LeaseKeeper;
use crate::arm;
use channel::topic::ArmStates;
use channel::{Domain, DomainState, Role, RunFolder, Subscriber};
use control_client::ask_once;
use control_protocol::{
    ArmLease, ArmMotion, ArmReport, Refusal, RefusalKind, TypedRequest, request,
};
use daemon_client::{CallError, DaemonClient};
use message::WireCapsule;
use scene_document::ARM_JOINTS;
use service::{CommonArguments, Failure, exit_code, monotonic_ns};
use std::time::{Duration, Instant};

/// Joint that is turned: the last one, with which nothing but the hand turns.
pub(super) const TURNED: usize = ARM_JOINTS - 1;
/// Pause between two looks at the states: a quarter of their period.
const POLL_PERIOD: Duration = Duration::from_millis(2);
/// Time limit of a motion of these checks.
pub(super) const MOTION_LIMIT: Duration = Duration::from_secs(20);
/// Number of attempts at a motion on a machine that is too busy to renew a lease. Chosen.
pub(super) const N_ATTEMPTS: usize = 4;
/// Sentence about such a machine.
pub(super) const TOO_BUSY: &str = "nothing can be said, since this machine is too busy to renew a \
                                   lease every half second; try again";
/// Time limit of an answer.
const ANSWER_LIMIT: Duration = Duration::from_secs(5);

/// New lease of this process.
pub(super) fn new_lease() -> Result<ArmLease, String> {
    arm::lease().map_err(|failure| failure.to_string())
}

/// Arm of a daemon.
pub(super) struct ArmUnderTest {
    pub(super) common: CommonArguments,
    pub(super) domain: Domain,
    states: Subscriber<ArmStates>,
    /// States since the record was begun.
    pub(super) record: Vec<RecordedState>,
    /// Joint angles before all checks, radians.
    pub(super) home_rad: [f64; ARM_JOINTS],
    /// Opening of the fingers before all checks, metres.
    pub(super) home_opening_m: f64,
}

impl ArmUnderTest {
    /// Arm of the daemon, whose domain this process joins.
    ///
    /// # Errors
    /// When the daemon has no arm, or it is commanded, moves, or holds something.
    pub(super) fn new(common: &CommonArguments) -> Result<Self, Failure> {
        let report = ask_once(common, &request::arm())?;
        let obstacle = match &report {
            ArmReport {
                commander: Some(commander),
                ..
            } => Some(format!("{commander} commands it; wait for its end")),
            report if arm::is_busy(report) => {
                Some("it moves; wait for its end, or stop it".to_owned())
            }
            report if report.is_holding => {
                Some("its fingers hold something; take it away: tabula arm open".to_owned())
            }
            _ => None,
        };
        if let Some(obstacle) = obstacle {
            let sentence = format!("the arm is not checked, since {obstacle}");
            return Err(Failure::new(exit_code::REFUSED, sentence));
        }
        let folder = RunFolder::of_user();
        if DomainState::inspect(&common.domain, &folder)
            .running
            .is_empty()
        {
            let sentence = "the daemon belongs to another user, whose shared memory is closed; \
                            check the arm as that user";
            return Err(Failure::new(exit_code::REFUSED, sentence));
        }
        let domain = Domain::join(&common.domain, &folder, Role::Guest)?;
        Ok(Self {
            common: common.clone(),
            states: Subscriber::polled(&domain)?,
            domain,
            record: Vec::new(),
            home_rad: report.joint_angles_rad,
            home_opening_m: report.opening_m,
        })
    }

    /// Answer to a request.
    pub(super) fn ask(&self, asked: &TypedRequest<ArmReport>) -> Result<ArmReport, CallError> {
        let folders = [RunFolder::of_user()];
        DaemonClient::ask_once(&self.common.domain, &folders, ANSWER_LIMIT, asked)
    }

    /// Answer to a request that must be answered; otherwise a sentence.
    pub(super) fn answer(&self, asked: &TypedRequest<ArmReport>) -> Result<ArmReport, String> {
        self.ask(asked)
            .map_err(|error| format!("a request was not answered: {error}"))
    }

    /// Refusal of a request that must be refused; otherwise a sentence, which begins with `what`.
    pub(super) fn refusal(
        &self,
        what: &str,
        asked: &TypedRequest<ArmReport>,
        kind: RefusalKind,
    ) -> Result<Refusal, String> {
        match self.ask(asked) {
            Ok(_) => Err(format!("{what} was accepted; it must be refused")),
            Err(CallError::Refusal(refusal)) if refusal.kind != kind => Err(format!(
                "{what} was refused as {:?} ({}), and not as {kind:?}",
                refusal.kind, refusal.sentence
            )),
            Err(CallError::Refusal(refusal)) if refusal.sentence.split_whitespace().count() < 3 => {
                Err(format!(
                    "{what} was refused without a sentence: {:?}",
                    refusal.sentence
                ))
            }
            Err(CallError::Refusal(refusal)) => Ok(refusal),
            Err(error) => Err(format!("{what} was not answered: {error}")),
        }
    }

    /// Takes all waiting states into the record.
    pub(super) fn receive(&mut self) -> Result<(), String> {
        let record = &mut self.record;
        let taken = self.states.take_all(|message| {
            let capsules = message.items().iter().map(WireCapsule::checked);
            record.push(RecordedState {
                // Copied out of shared memory first.
                state: *message.header(),
                n_capsules: capsules
                    .map(|capsule| capsule.map(drop))
                    .collect::<Option<Vec<()>>>()
                    .map(|sound| sound.len()),
                received_ns: monotonic_ns(),
            });
        });
        taken.map_err(|error| format!("arm/state could not be received: {error}"))
    }

    /// Begins the record anew.
    pub(super) fn begin_record(&mut self) -> Result<(), String> {
        self.receive()?;
        self.record.clear();
        Ok(())
    }

    /// Records states until a condition holds for the record; `false` when it does not in time.
    pub(super) fn record_until(
        &mut self,
        limit: Duration,
        is_so: impl Fn(&[RecordedState]) -> bool,
    ) -> Result<bool, String> {
        let begun = Instant::now();
        loop {
            self.receive()?;
            if is_so(&self.record) {
                return Ok(true);
            }
            if begun.elapsed() >= limit {
                return Ok(false);
            }
            std::thread::sleep(POLL_PERIOD);
        }
    }

    /// Records states for a time.
    pub(super) fn record_for(&mut self, time: Duration) -> Result<(), String> {
        self.record_until(time, |_| false).map(drop)
    }

    /// Carries a motion out with a lease that is renewed, and released at its end; the final report.
    /// Tries again while this machine is too busy to renew the lease in time.
    pub(super) fn carry_out(&mut self, motion: &ArmMotion) -> Result<ArmReport, String> {
        for _ in 0..N_ATTEMPTS {
            if let Some(report) = self.try_to_carry_out(motion.clone())? {
                return Ok(report);
            }
        }
        Err(TOO_BUSY.to_owned())
    }

    /// Final report of a motion; `None` when its lease was renewed too late.
    fn try_to_carry_out(&mut self, motion: ArmMotion) -> Result<Option<ArmReport>, String> {
        let lease = new_lease()?;
        let begun = self.answer(&request::move_arm(lease.clone(), motion))?;
        let keeper = LeaseKeeper::start(&self.common, lease.clone());
        let deadline = Instant::now() + MOTION_LIMIT;
        let mut report = begun.clone();
        while arm::is_busy(&report) {
            if Instant::now() > deadline {
                return Err("a motion has not ended within 20 s".to_owned());
            }
            self.record_for(Duration::from_millis(20))?;
            report = self.answer(&request::arm())?;
        }
        if keeper.end().is_late {
            return Ok(None);
        }
        self.answer(&request::release_arm(lease.id))?;
        if report.command_id == begun.command_id {
            Ok(Some(report))
        } else {
            Err(format!(
                "command {} was not carried out to its end: the arm reports command {}",
                begun.command_id, report.command_id
            ))
        }
    }

    /// Waits until the arm stands, whatever it does, and turns its joints back to where they were.
    pub(super) fn go_back(&mut self) -> Result<(), String> {
        self.begin_record()?;
        let stands = |record: &[RecordedState]| {
            record.len() > 10
                && record[record.len() - 10..]
                    .iter()
                    .all(|one| is_at_rest(&one.state))
        };
        if !self.record_until(MOTION_LIMIT, stands)? {
            return Err("the arm does not come to rest".to_owned());
        }
        let angles_rad = self.home_rad;
        let report = self.carry_out(&ArmMotion::MoveJoints { angles_rad })?;
        if report.activity == "failed" {
            return Err(format!("the arm could not turn back: {}", report.note));
        }
        Ok(())
    }

    /// Turn of the last joint, towards the middle of its range.
    pub(super) fn turn(&self, turn_rad: f64) -> ArmMotion {
        let mut angles_rad = self.home_rad;
        angles_rad[TURNED] -= turn_rad.copysign(self.home_rad[TURNED]);
        ArmMotion::MoveJoints { angles_rad }
    }
}
