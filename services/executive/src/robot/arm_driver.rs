//! Driver of the arm's motions: one after another, under a lease that is renewed with each look.

use control_protocol::{ArmLease, ArmMotion, ArmReport, MutationId, RefusalKind, request};
use daemon_client::{DaemonLink, Unanswered};
use std::collections::VecDeque;

/// Name under which the executive commands the arm.
const HOLDER: &str = "tabula-executive";

/// Progress of the motions that were begun last.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum MotionProgress {
    /// The arm moves.
    Moving,
    /// All motions have ended well.
    Done,
    /// A motion has failed; the reason.
    Failed(String),
    /// The arm was stopped, or another commander has it; a sentence.
    Stopped(String),
    /// The arm does not answer at the moment; a sentence.
    Silent(String),
}

/// Motions of the arm, with the lease.
#[derive(Debug, Default)]
pub(crate) struct ArmDriver {
    /// Number of the lease; `None` before the first motion and after its end.
    lease: Option<u64>,
    /// Motion under way, then those that follow it.
    motions: VecDeque<ArmMotion>,
    /// Number of the command that carries out the first motion; `None` when it was not accepted yet.
    command: Option<u64>,
    /// Newest report of the arm.
    report: Option<ArmReport>,
    is_halted: bool,
}

impl ArmDriver {
    /// Begins motions in place of those under way.
    pub(crate) fn begin(&mut self, motions: impl IntoIterator<Item = ArmMotion>) {
        self.motions = motions.into_iter().collect();
        self.command = None;
        self.is_halted = false;
    }

    /// Newest report of the arm.
    pub(crate) fn report(&self) -> Option<&ArmReport> {
        self.report.as_ref()
    }

    /// True if the newest report says that the fingers hold something.
    pub(crate) fn is_holding(&self) -> bool {
        self.report.as_ref().is_some_and(|report| report.is_holding)
    }

    /// True if the arm was told to rest where it is.
    pub(crate) fn is_halted(&self) -> bool {
        self.is_halted
    }

    /// Lets the arm rest where it is; the motions wait.
    pub(crate) fn halt(&mut self, link: &mut DaemonLink) {
        let Some(report) = &self.report else { return };
        let here = ArmMotion::MoveJoints {
            angles_rad: report.joint_angles_rad,
        };
        self.is_halted = self.command_arm(link, &here).is_ok();
        self.command = None;
    }

    /// Lets the motions go on after a halt, the one that was under way from where the arm is.
    pub(crate) fn go_on(&mut self) {
        self.is_halted = false;
    }

    /// Looks at the arm, renews the lease, and begins the next motion when one has ended.
    pub(crate) fn poll(&mut self, link: &mut DaemonLink) -> MotionProgress {
        let progress = self.advance(link);
        progress.unwrap_or_else(|unanswered| self.unanswered(unanswered))
    }

    /// Renews the lease, if one is held, and begins nothing.
    pub(crate) fn keep(&mut self, link: &mut DaemonLink) {
        if self.lease.is_some() {
            // The next poll tells of an arm that does not answer.
            let _ = self.hold(link);
        }
    }

    /// Ends the lease; the arm rests.
    pub(crate) fn release(&mut self, link: &mut DaemonLink) {
        if let Some(lease) = self.lease.take() {
            // It ends by itself, too.
            let _ = link.ask(&request::release_arm(lease));
        }
        self.motions.clear();
        self.command = None;
        self.is_halted = false;
    }

    /// Reads the state of the arm without commanding it.
    ///
    /// # Errors
    /// When the arm does not answer.
    pub(crate) fn look(&mut self, link: &mut DaemonLink) -> Result<&ArmReport, Unanswered> {
        let report = link.ask(&request::arm())?;
        Ok(self.report.insert(report))
    }

    fn advance(&mut self, link: &mut DaemonLink) -> Result<MotionProgress, Unanswered> {
        let Some(command) = self.command else {
            return self.begin_next(link);
        };
        let report = self.hold(link)?;
        if report.command_id != command {
            let sentence = "the arm has forgotten its motion, since its driver began anew";
            self.command = None;
            return Ok(MotionProgress::Failed(sentence.to_owned()));
        }
        match report.activity.as_str() {
            "moving" | "opening" | "closing" => Ok(MotionProgress::Moving),
            "failed" => Ok(MotionProgress::Failed(report.note.clone())),
            "stopped" => Ok(MotionProgress::Stopped("the arm was stopped".to_owned())),
            _ => {
                self.motions.pop_front();
                self.command = None;
                self.advance(link)
            }
        }
    }

    /// Begins the first motion that waits; without one the lease is renewed.
    fn begin_next(&mut self, link: &mut DaemonLink) -> Result<MotionProgress, Unanswered> {
        let next = self.motions.front().filter(|_| !self.is_halted).cloned();
        if let Some(motion) = next {
            self.command = Some(self.command_arm(link, &motion)?);
            return Ok(MotionProgress::Moving);
        }
        self.hold(link)?;
        Ok(if self.motions.is_empty() {
            MotionProgress::Done
        } else {
            MotionProgress::Moving
        })
    }

    fn hold(&mut self, link: &mut DaemonLink) -> Result<ArmReport, Unanswered> {
        let lease = self.lease()?;
        let report = link.ask(&request::hold_arm(lease))?;
        self.report = Some(report.clone());
        Ok(report)
    }

    /// Number of the accepted command.
    fn command_arm(
        &mut self,
        link: &mut DaemonLink,
        motion: &ArmMotion,
    ) -> Result<u64, Unanswered> {
        let lease = self.lease()?;
        let report = link.ask(&request::move_arm(lease, motion.clone()))?;
        let id = report.command_id;
        self.report = Some(report);
        Ok(id)
    }

    /// The lease, a new one where none is held.
    fn lease(&mut self) -> Result<ArmLease, Unanswered> {
        let id = if let Some(id) = self.lease {
            id
        } else {
            let random = MutationId::random();
            let random = random.map_err(|error| Unanswered::NoAnswer(error.to_string()))?;
            *self.lease.insert(random.0 as u64)
        };
        Ok(ArmLease {
            id,
            holder: HOLDER.to_owned(),
        })
    }

    /// Progress without an answer. A lease that has ended by silence is replaced, and its motion begun
    /// again from where the arm rests. Another commander may soon be done: one that has died holds its
    /// lease for half a second.
    fn unanswered(&mut self, unanswered: Unanswered) -> MotionProgress {
        match unanswered {
            Unanswered::NoAnswer(sentence) => MotionProgress::Silent(sentence),
            Unanswered::Refused(refusal) if refusal.kind == RefusalKind::Conflict => {
                self.lease = None;
                self.command = None;
                if refusal.sentence.contains("was silent") {
                    MotionProgress::Moving
                } else if refusal.sentence.contains("is commanded by") {
                    MotionProgress::Silent(refusal.sentence)
                } else {
                    MotionProgress::Stopped(refusal.sentence)
                }
            }
            Unanswered::Refused(refusal) if refusal.kind == RefusalKind::Invalid => {
                MotionProgress::Failed(refusal.sentence)
            }
            Unanswered::Refused(refusal) => MotionProgress::Silent(refusal.sentence),
        }
    }
}
