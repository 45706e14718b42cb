//! Duties of a driver in each cycle of its loop: stop word, lease of the commander, answers.

use crate::arm_requests::STOPPED_BEFORE;
use crate::{Arm, ArmLog, ArmRequest, ArmRequests, BrakingCause};
use arm_interface::{CommandLease, LEASE_TIME_NS, StopWord, StopWordError};
use control_protocol::{ArmCommand, ArmLease, Refusal, RefusalKind};
use service::monotonic_ns;
use tracing::Level;

/// Longest name of a commander, bytes. Chosen.
const MAX_HOLDER_BYTES: usize = 64;

/// State of the duties between two cycles.
///
/// In each cycle a loop calls [`guard`](Self::guard), answers requests, each followed by another
/// `guard`, and tells of each state that it has published.
pub struct ArmDuties {
    requests: ArmRequests,
    /// Stop word; `None` without an arm.
    word: Option<StopWord>,
    log: ArmLog,
    lease: CommandLease,
    /// Time at which the commander was heard last, monotonic, nanoseconds.
    heard_ns: u64,
    /// True from a stop until all joints are at rest.
    is_braking: bool,
    /// True if the stop word could not be read in the last cycle.
    is_word_lost: bool,
}

impl ArmDuties {
    /// Duties of a driver; without a stop word there is no arm.
    pub fn new(requests: ArmRequests, word: Option<StopWord>, log: ArmLog) -> Self {
        Self {
            requests,
            word,
            log,
            lease: CommandLease::default(),
            heard_ns: 0,
            is_braking: false,
            is_word_lost: false,
        }
    }

    /// Prepares the calling thread, which is that of the loop: requests wake it, and it gets
    /// real-time priority if it is to have it.
    pub fn take_this_thread(&self, is_real_time: bool) {
        self.requests.wake_this_thread();
        if !is_real_time {
            return;
        }
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

    /// Log of the driver.
    pub fn log(&self) -> &ArmLog {
        &self.log
    }

    /// True from a stop until all joints are at rest.
    pub fn is_braking(&self) -> bool {
        self.is_braking
    }

    /// Stops the arm when its stop word was pressed, or its commander is silent.
    pub fn guard(&mut self, arm: &mut impl Arm) {
        if self.is_stop_pressed() {
            self.stop(arm);
        }
        // A clock of the arm's own, fast or slow, makes no commander silent that was just heard.
        let is_heard = monotonic_ns() < self.heard_ns + LEASE_TIME_NS;
        if !is_heard && let Some(holder) = self.lease.expire(arm.lease_clock_ns()) {
            self.log.warn(format!(
                "{holder} commands the arm and was silent for 0.5 s: the arm brakes"
            ));
            arm.brake(BrakingCause::Silence);
        }
    }

    /// True if the stop word was pressed since the last cycle, or is lost.
    fn is_stop_pressed(&mut self) -> bool {
        let Some(word) = &mut self.word else {
            return false;
        };
        let polled = word.poll(monotonic_ns());
        let was_lost = std::mem::replace(&mut self.is_word_lost, polled.is_err());
        if let Err(error) = &polled
            && !was_lost
        {
            let sentence = format!("the arm is stopped, since its stop word is lost: {error}");
            self.log.write(Level::ERROR, sentence);
        }
        polled.unwrap_or(true)
    }

    /// Brakes the arm, ends the lease of its commander, and refuses what waits.
    pub fn stop(&mut self, arm: &mut impl Arm) {
        let commander = self.lease.stop();
        self.requests.refuse_commands();
        arm.brake(BrakingCause::Stop);
        if let Some(commander) = commander {
            let sentence = format!("the arm is stopped; {commander} commanded it");
            self.log.info(sentence);
        }
        self.is_braking = true;
        self.acknowledge(|word| word.record_braking(monotonic_ns()));
    }

    /// Takes note of a published state: after a stop the first one at rest is the end of braking.
    pub fn note_published(&mut self, is_at_rest: bool) {
        if self.is_braking && is_at_rest {
            self.is_braking = false;
            self.acknowledge(|word| word.record_rest(monotonic_ns()));
        }
    }

    /// Writes into the file of the stop word.
    fn acknowledge(&self, write: impl FnOnce(&StopWord) -> Result<(), StopWordError>) {
        if let Some(Err(error)) = self.word.as_ref().map(write) {
            let sentence = format!("a stop of the arm could not be acknowledged: {error}");
            self.log.warn(sentence);
        }
    }

    /// Next request to answer.
    pub fn next_request(&mut self) -> Option<ArmRequest> {
        self.requests.next_request()
    }

    /// Carries out a request, and answers it with the state of the arm or a refusal.
    ///
    /// A stop that was pressed before the request came is carried out before its answer, also when
    /// the loop has not read the word since.
    pub fn answer(&mut self, request: ArmRequest, arm: &mut impl Arm) {
        if self.is_stop_pressed() {
            self.stop(arm);
            if request.command != ArmCommand::State {
                return request.refuse(RefusalKind::Conflict, STOPPED_BEFORE);
            }
        }
        let executed = self.carry_out(&request.command, request.arrived_ns, arm);
        let report = executed.and_then(|()| {
            let reading = arm.reading();
            reading
                .map(|reading| reading.report(self.lease.holder()))
                .map_err(|sentence| Refusal::new(RefusalKind::Invalid, sentence))
        });
        request.reply(report);
    }

    fn carry_out(
        &mut self,
        command: &ArmCommand,
        arrived_ns: u64,
        arm: &mut impl Arm,
    ) -> Result<(), Refusal> {
        match command {
            ArmCommand::State => Ok(()),
            ArmCommand::Hold(lease) => self.renew(lease, arm),
            ArmCommand::Release { lease } => {
                self.lease.release(*lease);
                let is_busy = arm.reading().is_ok_and(|reading| reading.is_busy());
                if self.lease.holder().is_none() && is_busy {
                    arm.brake(BrakingCause::Release);
                }
                Ok(())
            }
            ArmCommand::Move { lease, motion } => {
                self.renew(lease, arm)?;
                let sentence = format!("arm: {motion:?}, commanded by {}", lease.holder);
                self.log.info(sentence);
                let begun = arm.begin(motion, arrived_ns);
                begun.map_err(|sentence| Refusal::new(RefusalKind::Invalid, sentence))
            }
            ArmCommand::Stop => {
                let sentence = "a stop is a word in shared memory, and no request to the loop";
                Err(Refusal::new(RefusalKind::Internal, sentence))
            }
        }
    }

    /// Begins or renews the lease of a commander.
    fn renew(&mut self, lease: &ArmLease, arm: &impl Arm) -> Result<(), Refusal> {
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
        let renewed = self.lease.renew(lease.id, holder, arm.lease_clock_ns());
        if renewed.is_ok() {
            self.heard_ns = monotonic_ns();
        }
        renewed
            .map(drop)
            .map_err(|refusal| Refusal::new(RefusalKind::Conflict, refusal.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm_requests::queues;
    use crate::{ArmReading, ArmRequests};
    use arm_interface::StopButton;
    use control_protocol::{ArmMotion, ArmReport};
    use message::{ArmActivity, WirePose};
    use tokio::sync::oneshot;

    /// Arm that notes what it is asked to do; its clock is set by the test.
    #[derive(Default)]
    struct NotedArm {
        n_begun: u64,
        braked: Vec<BrakingCause>,
        now_ns: u64,
    }

    impl Arm for NotedArm {
        fn begin(&mut self, motion: &ArmMotion, _arrived_ns: u64) -> Result<(), String> {
            if *motion == ArmMotion::Home {
                return Err("it has no home".to_owned());
            }
            self.n_begun += 1;
            Ok(())
        }

        fn brake(&mut self, cause: BrakingCause) {
            self.braked.push(cause);
        }

        fn reading(&self) -> Result<ArmReading, String> {
            Ok(ArmReading {
                activity: ArmActivity::Moving,
                note: String::new(),
                command_id: self.n_begun,
                joint_angles_rad: [0.0; 6],
                joint_velocities_rad_s: [0.0; 6],
                opening_m: 0.1,
                world_from_gripper: WirePose::default(),
                is_holding: false,
            })
        }

        fn lease_clock_ns(&self) -> u64 {
            self.now_ns
        }
    }

    fn duties(folder: &std::path::Path) -> ArmDuties {
        let requests: ArmRequests = queues().1;
        let word = StopWord::create(folder).unwrap();
        ArmDuties::new(requests, Some(word), ArmLog::start().unwrap())
    }

    fn asked(
        duties: &mut ArmDuties,
        arm: &mut NotedArm,
        command: ArmCommand,
    ) -> Result<ArmReport, Refusal> {
        let (answer, mut answered) = oneshot::channel();
        duties.answer(ArmRequest::new(command, answer), arm);
        answered.try_recv().unwrap()
    }

    fn lease(id: u64) -> ArmLease {
        let holder = format!("commander {id}");
        ArmLease { id, holder }
    }

    fn close(id: u64) -> ArmCommand {
        let (lease, motion) = (lease(id), ArmMotion::Close);
        ArmCommand::Move { lease, motion }
    }

    #[test]
    fn word_that_was_pressed_before_a_request_stops_the_arm_before_its_answer() {
        let folder = tempfile::tempdir().unwrap();
        let (mut duties, mut arm) = (duties(folder.path()), NotedArm::default());
        asked(&mut duties, &mut arm, close(1)).unwrap();
        let button = StopButton::open(folder.path()).unwrap();
        button.press().unwrap();
        let report = asked(&mut duties, &mut arm, ArmCommand::State).unwrap();
        assert_eq!(arm.braked, [BrakingCause::Stop]);
        assert_eq!(report.commander, None);
        button.press().unwrap();
        let refusal = asked(&mut duties, &mut arm, close(2)).unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::Conflict);
        assert_eq!(arm.n_begun, 1);
        // Rest is noted when a state tells it.
        assert!(duties.is_braking());
        duties.note_published(false);
        assert_eq!(button.record().unwrap().rest_ns, 0);
        duties.note_published(true);
        assert!(button.record().unwrap().rest_ns > 0);
        asked(&mut duties, &mut arm, close(3)).unwrap();
        assert_eq!(arm.n_begun, 2);
    }

    #[test]
    fn silence_by_the_clock_of_the_arm_alone_ends_no_lease_that_was_just_heard() {
        let folder = tempfile::tempdir().unwrap();
        let (mut duties, mut arm) = (duties(folder.path()), NotedArm::default());
        asked(&mut duties, &mut arm, ArmCommand::Hold(lease(1))).unwrap();
        arm.now_ns += 10 * LEASE_TIME_NS;
        duties.guard(&mut arm);
        assert_eq!(arm.braked, []);
        duties.heard_ns = 0;
        duties.guard(&mut arm);
        assert_eq!(arm.braked, [BrakingCause::Silence]);
        let refusal = asked(&mut duties, &mut arm, close(1)).unwrap_err();
        assert!(refusal.sentence.contains("silent"), "{refusal}");
    }

    #[test]
    fn release_brakes_and_what_the_arm_refuses_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let (mut duties, mut arm) = (duties(folder.path()), NotedArm::default());
        let report = asked(&mut duties, &mut arm, close(1)).unwrap();
        assert_eq!(report.commander.as_deref(), Some("commander 1"));
        let (own, motion) = (lease(1), ArmMotion::Home);
        let home = ArmCommand::Move { lease: own, motion };
        let refusal = asked(&mut duties, &mut arm, home).unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::Invalid);
        assert_eq!(refusal.sentence, "it has no home");
        asked(&mut duties, &mut arm, ArmCommand::Release { lease: 2 }).unwrap();
        assert_eq!(arm.braked, []);
        asked(&mut duties, &mut arm, ArmCommand::Release { lease: 1 }).unwrap();
        assert_eq!(arm.braked, [BrakingCause::Release]);
    }
}
