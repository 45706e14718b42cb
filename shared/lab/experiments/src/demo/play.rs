//! Demonstration at one table: teaching, the instruction, and the task until its end.

use super::contact_sheet::ContactSheet;
use super::demo_stage::DemoStage;
use super::demo_table::DemoTable;
use super::instructor::{AUTHOR, Instructor, ObjectLesson, is_tracked, n_seen};
use super::judge::Judge;
use super::recognition_score::RecognitionScore;
use super::run_record::{EventKind, RunEvent, RunRecord, RunSettings};
use crate::arguments::DemoArguments;
use command_line::{Output, StopSignal};
use control_protocol::{MutationId, TaskKind, TaskOrder, TaskReport, request};
use service::Failure;
use std::collections::BTreeSet;

/// Number of frames after which the person begins, even if not everything is seen.
const LOOK_FRAMES: u64 = 150;
/// Number of frames after which the person begins at the earliest.
const FIRST_FRAMES: u64 = 45;
/// Number of frames between two sentences of the person.
const LESSON_FRAMES: u64 = 45;
/// Number of frames between two recognition results of an object.
const RESULT_FRAMES: u64 = 30;
/// Number of frames after the task until the judge looks.
const LAST_FRAMES: u64 = 30;
/// Number of frames of a run at most: thirteen minutes.
const MOST_FRAMES: u64 = 24_000;
/// Phases in which the robot handles no object.
const IDLE_PHASES: [&str; 8] = [
    "look",
    "choose",
    "ask",
    "plan",
    "return",
    "succeeded",
    "failed",
    "cancelled",
];

/// Part of a demonstration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum DemoPart {
    /// The objects come into view.
    Looking,
    /// The person teaches one object after another.
    Teaching,
    /// The robot carries out the task.
    Working,
    /// The task has ended.
    Over,
}

/// Demonstration under way at one table.
pub(super) struct Play<'t> {
    table: &'t DemoTable,
    /// Output of what happens, while it happens.
    live: Option<Output>,
    stage: DemoStage,
    instructor: Instructor,
    judge: Judge,
    score: RecognitionScore,
    pub(super) sheet: ContactSheet,
    part: DemoPart,
    /// Number of frames so far, and that of the newest sentence of the person.
    n_frames: u64,
    last_lesson: u64,
    first_ns: Option<u64>,
    time_s: f64,
    instructed_s: f64,
    ended_s: f64,
    ended_frame: u64,
    task: TaskReport,
    /// Sentence with which the robot has refused the order.
    refusal: Option<String>,
    /// Tracks of the newest scene.
    tracks: BTreeSet<u64>,
    n_taught: usize,
    n_corrected: usize,
    events: Vec<RunEvent>,
}

impl<'t> Play<'t> {
    /// Starts the daemon of a table.
    ///
    /// # Errors
    /// When it cannot be started.
    pub(super) fn new(
        table: &'t DemoTable,
        arguments: &DemoArguments,
        (stop, output): (&StopSignal, &Output),
    ) -> Result<Self, Failure> {
        let stage = DemoStage::start(table, &arguments.models, stop)?;
        Ok(Self {
            judge: Judge::new(stage.domain())?,
            instructor: Instructor::default(),
            table,
            live: arguments.live.then(|| output.clone()),
            stage,
            score: RecognitionScore::default(),
            sheet: ContactSheet::default(),
            part: DemoPart::Looking,
            n_frames: 0,
            last_lesson: 0,
            first_ns: None,
            time_s: 0.0,
            instructed_s: 0.0,
            ended_s: 0.0,
            ended_frame: 0,
            task: TaskReport::default(),
            refusal: None,
            tracks: BTreeSet::new(),
            n_taught: 0,
            n_corrected: 0,
            events: Vec::new(),
        })
    }

    /// Follows one frame; true at the end.
    ///
    /// # Errors
    /// When the daemon does not answer, or the demonstration is stopped.
    pub(super) fn frame(&mut self) -> Result<bool, Failure> {
        let frame = self.stage.next_frame()?;
        let captured_ns = self.stage.captured_ns;
        let first_ns = *self.first_ns.get_or_insert(captured_ns);
        let elapsed_ns = captured_ns.saturating_sub(first_ns);
        self.time_s = (elapsed_ns / 1_000_000) as f64 / 1000.0;
        self.n_frames += 1;
        self.judge
            .look(self.time_s, handled(&self.task), &self.stage.objects)?;
        self.count_recognition();
        self.follow_tracks();
        let is_over = self.act()?;
        self.stage.finish(frame)?;
        Ok(is_over)
    }

    /// Counts the answer about each object that is seen, once a second.
    fn count_recognition(&mut self) {
        if !self.n_frames.is_multiple_of(RESULT_FRAMES) {
            return;
        }
        for object in self
            .stage
            .objects
            .iter()
            .filter(|object| is_tracked(object))
        {
            if let Some(truth) = self.judge.category_of(object) {
                self.score.count(self.time_s, truth, object.label());
            }
        }
    }

    /// Tells of tracks that have ended.
    fn follow_tracks(&mut self) {
        let now: BTreeSet<u64> = self.stage.objects.iter().map(|one| one.track_id).collect();
        let before = std::mem::replace(&mut self.tracks, now);
        let ended: Vec<u64> = before.difference(&self.tracks).copied().collect();
        for track in ended {
            self.tell(EventKind::TrackEnded, format!("track {track} has ended"));
        }
    }

    /// Lets the person act; true at the end.
    fn act(&mut self) -> Result<bool, Failure> {
        match self.part {
            DemoPart::Looking => {
                let is_complete =
                    n_seen(self.table, &self.stage.objects) >= self.table.objects.len();
                let is_time = is_complete && self.n_frames >= FIRST_FRAMES;
                if is_time || self.n_frames >= LOOK_FRAMES {
                    self.sheet
                        .add(&self.stage, "before the first lesson".to_owned());
                    self.part = DemoPart::Teaching;
                }
            }
            DemoPart::Teaching if self.is_person_ready() => {
                if !self.teach_next()? {
                    self.instruct()?;
                }
            }
            DemoPart::Teaching => {}
            DemoPart::Working => self.follow_task()?,
            DemoPart::Over => return Ok(self.n_frames >= self.ended_frame + LAST_FRAMES),
        }
        Ok(self.n_frames >= MOST_FRAMES)
    }

    fn is_person_ready(&self) -> bool {
        self.n_frames >= self.last_lesson + LESSON_FRAMES
    }

    /// Teaches the next name; false when the robot knows all that it sees where it was put.
    fn teach_next(&mut self) -> Result<bool, Failure> {
        let lesson = self.instructor.next_lesson(self.table, &self.stage.objects);
        let Some(lesson) = lesson else {
            return Ok(false);
        };
        self.last_lesson = self.n_frames;
        let request = lesson.request().map_err(Failure::general)?;
        if let Err(refusal) = self.stage.ask(&request)? {
            self.tell(EventKind::Failed, refusal);
            return Ok(true);
        }
        self.instructor.remember(&lesson);
        self.score.teach(&lesson.category);
        let ObjectLesson {
            track,
            category,
            is_correction,
        } = lesson;
        let verb = if is_correction {
            self.n_corrected += 1;
            "corrected to"
        } else {
            self.n_taught += 1;
            "taught as"
        };
        let sentence = format!("track {track} was {verb} {category}");
        self.tell(EventKind::Taught, sentence);
        Ok(true)
    }

    fn instruct(&mut self) -> Result<(), Failure> {
        self.sheet
            .add(&self.stage, "before the instruction".to_owned());
        let wanted = self.table.wanted.clone();
        let (kind, sentence) = match &wanted {
            None => (TaskKind::ClearTable, "clear the table".to_owned()),
            Some(category) => (TaskKind::Fetch, format!("fetch the {category}")),
        };
        let order = TaskOrder {
            kind,
            category: wanted,
            ..TaskOrder::default()
        };
        let id = MutationId::random().map_err(Failure::general)?;
        let order = request::order_task(id, AUTHOR.to_owned(), order);
        self.instructed_s = self.time_s;
        self.tell(EventKind::Instructed, sentence);
        match self.stage.ask(&order)? {
            Ok(report) => {
                self.task = report;
                self.part = DemoPart::Working;
            }
            Err(refusal) => {
                self.end(refusal.clone());
                self.refusal = Some(refusal);
            }
        }
        Ok(())
    }

    /// Follows the task, and teaches what comes into view or is named wrongly.
    fn follow_task(&mut self) -> Result<(), Failure> {
        let report = self.stage.ask(&request::task_state())?;
        let report = report.map_err(Failure::general)?;
        let before = std::mem::replace(&mut self.task, report);
        self.tell_of_task(&before);
        if ["succeeded", "failed", "cancelled"].contains(&self.task.phase.as_str()) {
            self.end(self.task.sentence.clone());
        } else if handled(&self.task).is_none() && self.is_person_ready() {
            self.teach_next()?;
        }
        Ok(())
    }

    /// Ends the work with the robot's sentence about it.
    fn end(&mut self, sentence: String) {
        self.ended_s = self.time_s;
        self.ended_frame = self.n_frames;
        self.part = DemoPart::Over;
        self.sheet.add(&self.stage, "at the end".to_owned());
        self.tell(EventKind::Ended, sentence);
    }

    /// Notes what has changed in the task.
    fn tell_of_task(&mut self, before: &TaskReport) {
        if before.phase == self.task.phase {
            return;
        }
        let track = self.task.track_id.or(before.track_id).unwrap_or_default();
        let name = self.task.label.clone().or_else(|| before.label.clone());
        let name = name.unwrap_or_else(|| "object".to_owned());
        if self.task.phase == "check_lift" {
            self.tell(EventKind::Grasped, format!("{name} {track} was grasped"));
            self.sheet
                .add(&self.stage, format!("{name} {track} is lifted"));
        } else if self.task.n_done > before.n_done {
            self.tell(
                EventKind::Placed,
                format!("{name} {track} stands at its place"),
            );
            self.sheet
                .add(&self.stage, format!("{name} {track} is at its place"));
        } else if before.track_id.is_some() && self.task.track_id.is_none() {
            let phase = &before.phase;
            let sentence = format!("{name} {track}: the attempt has failed in {phase}");
            self.tell(EventKind::Failed, sentence);
        }
    }

    fn tell(&mut self, kind: EventKind, sentence: String) {
        if let Some(output) = &self.live {
            output.print_status(&format!("{:7.2} s  {sentence}", self.time_s));
        }
        self.events.push(RunEvent {
            time_s: self.time_s,
            kind,
            sentence,
        });
    }

    /// Record of the run.
    pub(super) fn record(self, settings: RunSettings) -> RunRecord {
        let objects = self.judge.outcomes(self.table);
        let carried = objects.iter().filter(|object| object.is_wanted);
        let is_standard = |category: &str| {
            let mut items = self
                .table
                .objects
                .iter()
                .filter(|object| object.is_standard);
            items.any(|item| item.category == category)
        };
        let collisions = &self.judge.collisions;
        let moved = collisions.iter().filter(|one| is_standard(&one.category));
        let [precision, recall] = self.score.overall();
        RunRecord {
            seed: self.table.seed,
            wanted: self.table.wanted.clone(),
            refusal: self.refusal,
            n_objects: carried.clone().count(),
            n_in_place: carried.filter(|object| object.is_in_place).count(),
            n_standard_moved: moved.count(),
            collisions: collisions.clone(),
            stops: self.stage.arm_failures.clone(),
            seconds: self.ended_s - self.instructed_s,
            n_taught: self.n_taught,
            n_corrected: self.n_corrected,
            phase: self.task.phase.clone(),
            sentence: self.task.sentence.clone(),
            precision,
            recall,
            objects,
            events: self.events,
            scores: self.score.points,
            settings,
        }
    }
}

/// Track of the object that the robot handles.
fn handled(task: &TaskReport) -> Option<u64> {
    let is_idle = IDLE_PHASES.contains(&task.phase.as_str());
    task.track_id.filter(|_| !is_idle)
}
