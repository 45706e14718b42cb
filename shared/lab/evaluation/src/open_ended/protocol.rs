//! Teaching, asking and correcting.

use super::curriculum::{Curriculum, LeftOut, left_out};
use super::record::{Question, Run, Stage, StopReason};
use super::stage::{StageState, Verdict};
use crate::recogniser::{LabelledView, Recogniser, by_category};
use random::Random;
use std::fmt;

/// Purpose of chance.
const OPEN_SET: u64 = 4;

/// Which views are taught and which are asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Split {
    /// Any view of a category; one that was asked is taught when the answer was wrong.
    ByView,
    /// Lessons show half of the objects of a category, rounded down, and questions the
    /// others; a correction teaches the next view of the first half.
    InstanceDisjoint,
}

/// The rules of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Protocol {
    /// A stage ends when the protocol accuracy is not below, 0 to 1.
    pub tau: f64,
    /// Views that a category is introduced with.
    pub n_views_at_start: usize,
    /// The accuracy is that of the last questions, this many for each category.
    pub window: usize,
    /// So many questions beyond the window may find the accuracy not above `tau`; the
    /// next one ends the run.
    pub stall_limit: u32,
    /// Share of the questions that show a category which was not introduced, 0 to 0.9.
    pub open_set_share: f64,
    /// Which views are taught and which are asked.
    pub split: Split,
}

impl Default for Protocol {
    /// As published: accuracy at least twice the error, three views, a window of three
    /// passes, 100 questions.
    fn default() -> Self {
        Self {
            tau: 0.67,
            n_views_at_start: 3,
            window: 3,
            stall_limit: 100,
            open_set_share: 0.0,
            split: Split::ByView,
        }
    }
}

/// Why no run can begin.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// The threshold is not from 0 to 1.
    Tau(f64),
    /// The share of open-set questions is not from 0 to 0.9.
    OpenSetShare(f64),
    /// A category needs a view, and the window questions.
    Counts,
    /// Fewer than two categories have what the rules need.
    TooFewCategories {
        /// How many have it.
        n_usable: usize,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tau(tau) => write!(
                f,
                "the accuracy at which a category is learned can not be {tau}: choose from 0 to 1, \
                 0.67 usually"
            ),
            Self::OpenSetShare(share) => write!(
                f,
                "the share of open-set questions can not be {share}: choose from 0 to 0.9"
            ),
            Self::Counts => f.write_str(
                "a category must be introduced with at least one view, and the window must have \
                 at least one pass: raise them",
            ),
            Self::TooFewCategories { n_usable } => write!(
                f,
                "{n_usable} of the categories have enough views and objects for this protocol, and \
                 it needs two: give more data, or choose another protocol"
            ),
        }
    }
}

impl std::error::Error for Error {}

impl Protocol {
    fn check(&self) -> Result<(), Error> {
        if !(0.0..=1.0).contains(&self.tau) {
            return Err(Error::Tau(self.tau));
        }
        if !(0.0..=0.9).contains(&self.open_set_share) {
            return Err(Error::OpenSetShare(self.open_set_share));
        }
        if self.n_views_at_start == 0 || self.window == 0 {
            return Err(Error::Counts);
        }
        Ok(())
    }
}

/// Which categories take part, and why the others do not: by number, all of them.
///
/// # Errors
/// When the rules can not be used, or fewer than two categories take part.
pub fn usable_categories(
    protocol: &Protocol,
    views: &[LabelledView],
) -> Result<Vec<(u32, Option<LeftOut>)>, Error> {
    protocol.check()?;
    let categories = by_category(views);
    let found: Vec<_> = categories
        .iter()
        .map(|(category, of_category)| (*category, left_out(protocol, views, of_category)))
        .collect();
    let n_usable = found.iter().filter(|(_, reason)| reason.is_none()).count();
    if n_usable < 2 {
        return Err(Error::TooFewCategories { n_usable });
    }
    Ok(found)
}

/// Lets a teacher play with a recogniser that was taught nothing yet, until all
/// categories are learned or it goes no further.
///
/// Categories that can not take part are left out. A view is shown once at most: as
/// a lesson, or as a question after which it may be taught. The same seed gives the
/// same views in the same order, as long as the same answers are right.
///
/// # Errors
/// As for [`usable_categories`].
pub fn run(
    recogniser: &mut dyn Recogniser,
    views: &[LabelledView],
    protocol: &Protocol,
    seed: u64,
) -> Result<Run, Error> {
    usable_categories(protocol, views)?;
    let mut teacher = Teacher::new(recogniser, views, protocol, seed);
    let stop = teacher.play();
    Ok(teacher.finish(stop))
}

struct Teacher<'a> {
    recogniser: &'a mut dyn Recogniser,
    protocol: &'a Protocol,
    seed: u64,
    curriculum: Curriculum,
    open_set: Random,
    n_right: u32,
    n_counted: u32,
    questions: Vec<Question>,
    stages: Vec<Stage>,
    stage_accuracies: Vec<f64>,
    taught: Vec<(u32, u32)>,
}

impl<'a> Teacher<'a> {
    fn new(
        recogniser: &'a mut dyn Recogniser,
        views: &[LabelledView],
        protocol: &'a Protocol,
        seed: u64,
    ) -> Self {
        Self {
            recogniser,
            protocol,
            seed,
            curriculum: Curriculum::new(protocol, views, seed),
            open_set: Random::for_purpose(seed, OPEN_SET),
            n_right: 0,
            n_counted: 0,
            questions: Vec::new(),
            stages: Vec::new(),
            stage_accuracies: Vec::new(),
            taught: Vec::new(),
        }
    }

    fn finish(self, stop: StopReason) -> Run {
        Run {
            seed: self.seed,
            stop,
            questions: self.questions,
            stages: self.stages,
            stage_accuracies: self.stage_accuracies,
            taught: self.taught,
            n_views_at_start: self.protocol.n_views_at_start as u32,
        }
    }

    fn play(&mut self) -> StopReason {
        for place in 0..self.curriculum.n_categories() {
            if !self.introduce(place) {
                return StopReason::LackOfData;
            }
            // One category alone can not be mistaken.
            if place > 0
                && let Some(stop) = self.stage(place + 1)
            {
                return stop;
            }
        }
        StopReason::AllLearned
    }

    /// Teaches the first views of a category, or says that there are not as many.
    fn introduce(&mut self, place: usize) -> bool {
        let n_views = self.protocol.n_views_at_start;
        let Some(lessons) = self.curriculum.next_lessons(place, n_views) else {
            return false;
        };
        let category = self.curriculum.category(place);
        for view in lessons {
            self.recogniser.teach(category, view);
        }
        self.taught.push((category, n_views as u32));
        true
    }

    /// Asks the introduced categories in turn until the newest is learned; else says
    /// why the run is over.
    fn stage(&mut self, n_categories: usize) -> Option<StopReason> {
        let mut stage = StageState::new(n_categories);
        let mut place = 0;
        loop {
            self.ask_open_set(n_categories);
            let Some(view) = self.fresh_question(place) else {
                return Some(StopReason::LackOfData);
            };
            let category = self.curriculum.category(place);
            let mut question = self.ask(n_categories, view, category, false);
            let (accuracy, verdict) = stage.count(&question, self.protocol);
            question.accuracy = accuracy;
            self.count(question);
            if !question.is_right() {
                self.correct(place, view);
            }
            place = (place + 1) % n_categories;
            match verdict {
                Verdict::GoOn => {}
                Verdict::Passed(accuracy) => {
                    self.end_stage(n_categories, accuracy);
                    return None;
                }
                Verdict::Stalled(accuracy) => {
                    self.end_stage(n_categories, Some(accuracy));
                    return Some(StopReason::Stalled);
                }
            }
        }
    }

    /// A fresh view, if a wrong answer to it could be corrected.
    fn fresh_question(&mut self, place: usize) -> Option<usize> {
        let can_correct = self.curriculum.has_correction(place);
        self.curriculum.next_question(place).filter(|_| can_correct)
    }

    fn ask(&mut self, n_categories: usize, view: usize, truth: u32, is_open_set: bool) -> Question {
        Question {
            iteration: self.questions.len() as u32 + 1,
            n_categories: n_categories as u32,
            view,
            truth,
            is_open_set,
            answer: self.recogniser.ask(view),
            accuracy: None,
        }
    }

    fn count(&mut self, question: Question) {
        self.n_counted += 1;
        self.n_right += u32::from(question.is_right());
        self.questions.push(question);
    }

    /// Teaches at once, so that the next question is asked of who knows better.
    fn correct(&mut self, place: usize, asked: usize) {
        let view = match self.protocol.split {
            Split::ByView => Some(asked),
            Split::InstanceDisjoint => self.curriculum.next_lesson(place),
        };
        if let Some(view) = view {
            let (category, n_views) = &mut self.taught[place];
            *n_views += 1;
            self.recogniser.teach(*category, view);
        }
    }

    /// Asks as many open-set questions as chance wants before the next of the others.
    /// They are not corrected.
    fn ask_open_set(&mut self, n_categories: usize) {
        let n_all = self.curriculum.n_categories();
        while self.open_set.unit() < self.protocol.open_set_share && n_categories < n_all {
            let place = n_categories + self.open_set.below(n_all - n_categories);
            // Its lessons and one question stay.
            let n_to_leave = self.protocol.n_views_at_start + 1;
            if let Some(view) = self.curriculum.take_for_open_set(place, n_to_leave) {
                let truth = self.curriculum.category(place);
                let question = self.ask(n_categories, view, truth, true);
                self.questions.push(question);
            }
        }
    }

    fn end_stage(&mut self, n_categories: usize, accuracy: Option<f64>) {
        self.stage_accuracies.extend(accuracy);
        self.stages.push(Stage {
            n_categories: n_categories as u32,
            n_questions: self.n_counted,
            accuracy: f64::from(self.n_right) / f64::from(self.n_counted.max(1)),
        });
    }
}
