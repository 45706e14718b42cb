//! Simulated teacher: teach, ask, correct.

use super::curriculum::{Curriculum, Exclusion, exclusion};
use super::protocol::{Error, LessonSplit, Protocol};
use super::protocol_stage::{ProtocolStage, StageDecision};
use super::record::{OpenEndedRun, Question, StageRecord, StopReason};
use crate::recogniser::{LabelledView, Recogniser, by_category};
use random::Random;

/// Random stream of open-set questions.
const OPEN_SET_STREAM: u64 = 4;

/// All categories by number, with the reason if a category is excluded.
///
/// # Errors
/// If the parameters are invalid, or fewer than two categories are usable.
pub fn usable_categories(
    protocol: &Protocol,
    views: &[LabelledView],
) -> Result<Vec<(u32, Option<Exclusion>)>, Error> {
    protocol.check()?;
    let categories = by_category(views);
    let found: Vec<_> = categories
        .iter()
        .map(|(category, of_category)| (*category, exclusion(protocol, views, of_category)))
        .collect();
    let n_usable = found.iter().filter(|(_, reason)| reason.is_none()).count();
    if n_usable < 2 {
        return Err(Error::TooFewCategories { n_usable });
    }
    Ok(found)
}

/// Runs the protocol on an untrained recogniser until all categories are learned, accuracy
/// stalls, or views run out.
///
/// Excluded categories take no part. Each view is used at most once: as a lesson, or as a
/// question after which it may be taught. The same seed gives the same views in the same order,
/// as long as the same answers are right.
///
/// # Errors
/// As for [`usable_categories`].
pub fn run(
    recogniser: &mut dyn Recogniser,
    views: &[LabelledView],
    protocol: &Protocol,
    seed: u64,
) -> Result<OpenEndedRun, Error> {
    usable_categories(protocol, views)?;
    let mut teacher = Teacher::new(recogniser, views, protocol, seed);
    teacher.run.stop = teacher.play();
    Ok(teacher.run)
}

struct Teacher<'a> {
    recogniser: &'a mut dyn Recogniser,
    protocol: &'a Protocol,
    curriculum: Curriculum,
    open_set: Random,
    n_right: u32,
    n_counted: u32,
    run: OpenEndedRun,
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
            curriculum: Curriculum::new(protocol, views, seed),
            open_set: Random::substream(seed, OPEN_SET_STREAM),
            n_right: 0,
            n_counted: 0,
            run: OpenEndedRun {
                seed,
                stop: StopReason::AllLearned,
                questions: Vec::new(),
                stages: Vec::new(),
                stage_accuracies: Vec::new(),
                taught: Vec::new(),
                n_views_at_start: protocol.n_views_at_start as u32,
            },
        }
    }

    fn play(&mut self) -> StopReason {
        for place in 0..self.curriculum.n_categories() {
            if !self.introduce(place) {
                return StopReason::LackOfData;
            }
            // A single category cannot be confused.
            if place > 0
                && let Some(stop) = self.stage(place + 1)
            {
                return stop;
            }
        }
        StopReason::AllLearned
    }

    /// Teaches the first views of a category; `false` if there are too few.
    fn introduce(&mut self, place: usize) -> bool {
        let n_views = self.protocol.n_views_at_start;
        let Some(lessons) = self.curriculum.next_lessons(place, n_views) else {
            return false;
        };
        let category = self.curriculum.category(place);
        for view in lessons {
            self.recogniser.teach(category, view);
        }
        self.run.taught.push((category, n_views as u32));
        true
    }

    /// Asks the introduced categories in turn until the newest is learned; otherwise returns the
    /// reason for the end of the run.
    fn stage(&mut self, n_categories: usize) -> Option<StopReason> {
        let mut stage = ProtocolStage::new(n_categories);
        let mut place = 0;
        loop {
            self.ask_open_set(n_categories);
            let Some(view) = self.unused_question(place) else {
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
                StageDecision::Continue => {}
                StageDecision::Passed(accuracy) => {
                    self.end_stage(n_categories, accuracy);
                    return None;
                }
                StageDecision::Stalled(accuracy) => {
                    self.end_stage(n_categories, Some(accuracy));
                    return Some(StopReason::Stalled);
                }
            }
        }
    }

    /// Unused question view, if a wrong answer could be corrected.
    fn unused_question(&mut self, place: usize) -> Option<usize> {
        let can_correct = self.curriculum.has_correction(place);
        self.curriculum.next_question(place).filter(|_| can_correct)
    }

    fn ask(&mut self, n_categories: usize, view: usize, truth: u32, is_open_set: bool) -> Question {
        Question {
            iteration: self.run.questions.len() as u32 + 1,
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
        self.run.questions.push(question);
    }

    /// Corrects a wrong answer at once, before the next question.
    fn correct(&mut self, place: usize, asked: usize) {
        let view = match self.protocol.split {
            LessonSplit::ByView => Some(asked),
            LessonSplit::InstanceDisjoint => self.curriculum.next_lesson(place),
        };
        if let Some(view) = view {
            let (category, n_views) = &mut self.run.taught[place];
            *n_views += 1;
            self.recogniser.teach(*category, view);
        }
    }

    /// Asks a random number of open-set questions before the next question. They are never
    /// corrected.
    fn ask_open_set(&mut self, n_categories: usize) {
        let n_all = self.curriculum.n_categories();
        while self.open_set.unit() < self.protocol.open_set_share && n_categories < n_all {
            let place = n_categories + self.open_set.below(n_all - n_categories);
            // Its lessons and one question remain.
            let n_to_leave = self.protocol.n_views_at_start + 1;
            if let Some(view) = self.curriculum.take_for_open_set(place, n_to_leave) {
                let truth = self.curriculum.category(place);
                let question = self.ask(n_categories, view, truth, true);
                self.run.questions.push(question);
            }
        }
    }

    fn end_stage(&mut self, n_categories: usize, accuracy: Option<f64>) {
        self.run.stage_accuracies.extend(accuracy);
        self.run.stages.push(StageRecord {
            n_categories: n_categories as u32,
            n_questions: self.n_counted,
            accuracy: f64::from(self.n_right) / f64::from(self.n_counted.max(1)),
        });
    }
}
