//! Curriculum: random order of categories and views for the simulated teacher.

use super::protocol::{LessonSplit, Protocol};
use crate::recogniser::{LabelledView, by_category};
use random::Random;

/// Random streams that shuffle categories and views.
const CATEGORY_ORDER_STREAM: u64 = 1;
const VIEW_ORDER_STREAM: u64 = 2;
const INSTANCE_ORDER_STREAM: u64 = 3;

/// Reason for excluding a category from a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exclusion {
    /// Too few views for the lessons at the start and one question.
    TooFewViews {
        /// Number of views of the excluded category.
        n_views: usize,
    },
    /// Fewer than two known objects, but the split requires different objects for lessons and
    /// questions.
    TooFewInstances,
}

/// Unused views of each category, in the order of introduction.
#[derive(Debug)]
pub(super) struct Curriculum {
    categories: Vec<UnusedViews>,
}

/// Unused views of a category; the next one is last.
#[derive(Debug)]
struct UnusedViews {
    category: u32,
    for_questions: Vec<usize>,
    /// Lesson views; `None` when lessons and questions share their views.
    for_lessons: Option<Vec<usize>>,
}

impl Curriculum {
    /// Shuffles the categories and the views of each.
    pub(super) fn new(protocol: &Protocol, views: &[LabelledView], seed: u64) -> Self {
        let mut categories = Vec::new();
        for (category, of_category) in by_category(views) {
            if exclusion(protocol, views, &of_category).is_none() {
                categories.push(UnusedViews::new(
                    protocol,
                    views,
                    category,
                    of_category,
                    seed,
                ));
            }
        }
        Random::substream(seed, CATEGORY_ORDER_STREAM).shuffle(&mut categories);
        Self { categories }
    }

    /// Number of categories that can be introduced.
    pub(super) fn n_categories(&self) -> usize {
        self.categories.len()
    }

    /// Category at a position of the order of introduction.
    pub(super) fn category(&self, place: usize) -> u32 {
        self.categories[place].category
    }

    /// Next view to teach in a lesson.
    pub(super) fn next_lesson(&mut self, place: usize) -> Option<usize> {
        self.categories[place].lessons().pop()
    }

    /// Next `n` views for lessons, or `None` if fewer remain.
    pub(super) fn next_lessons(&mut self, place: usize, n: usize) -> Option<Vec<usize>> {
        let lessons = self.categories[place].lessons();
        let first = lessons.len().checked_sub(n)?;
        Some(lessons.drain(first..).rev().collect())
    }

    /// `true` if a wrong answer can be corrected: with the question's view, or with an unused
    /// view for lessons.
    pub(super) fn has_correction(&self, place: usize) -> bool {
        let lessons = self.categories[place].for_lessons.as_ref();
        lessons.is_none_or(|lessons| !lessons.is_empty())
    }

    /// Next view to ask in a question.
    pub(super) fn next_question(&mut self, place: usize) -> Option<usize> {
        self.categories[place].for_questions.pop()
    }

    /// Takes a question view of a category not yet introduced, from the end of its order so that
    /// its lessons stay the same. `None` if only `n_to_leave` views remain.
    pub(super) fn take_for_open_set(&mut self, place: usize, n_to_leave: usize) -> Option<usize> {
        let questions = &mut self.categories[place].for_questions;
        (questions.len() > n_to_leave).then(|| questions.remove(0))
    }
}

impl UnusedViews {
    fn new(
        protocol: &Protocol,
        views: &[LabelledView],
        category: u32,
        mut of_category: Vec<usize>,
        seed: u64,
    ) -> Self {
        let for_lessons = match protocol.split {
            LessonSplit::ByView => None,
            LessonSplit::InstanceDisjoint => {
                Some(take_instances(views, category, &mut of_category, seed))
            }
        };
        let shuffled = |mut indices: Vec<usize>, part: u64| {
            let stream = VIEW_ORDER_STREAM | part << 8 | u64::from(category) << 16;
            Random::substream(seed, stream).shuffle(&mut indices);
            indices
        };
        Self {
            category,
            for_questions: shuffled(of_category, 0),
            for_lessons: for_lessons.map(|indices| shuffled(indices, 1)),
        }
    }

    fn lessons(&mut self) -> &mut Vec<usize> {
        self.for_lessons.as_mut().unwrap_or(&mut self.for_questions)
    }
}

/// Moves the views of half of the objects, rounded down, out of a category.
fn take_instances(
    views: &[LabelledView],
    category: u32,
    of_category: &mut Vec<usize>,
    seed: u64,
) -> Vec<usize> {
    let mut instances = instances(views, of_category);
    let stream = INSTANCE_ORDER_STREAM | u64::from(category) << 16;
    Random::substream(seed, stream).shuffle(&mut instances);
    instances.truncate(instances.len() / 2);
    let is_taken = |view: &mut usize| instances.contains(&views[*view].instance);
    of_category.extract_if(.., is_taken).collect()
}

/// Distinct objects of some views, by number.
fn instances(views: &[LabelledView], of_category: &[usize]) -> Vec<Option<u32>> {
    let mut instances: Vec<_> = of_category.iter().map(|&v| views[v].instance).collect();
    instances.sort_unstable();
    instances.dedup();
    instances
}

/// Reason for excluding a category, judged by its views.
pub(super) fn exclusion(
    protocol: &Protocol,
    views: &[LabelledView],
    of_category: &[usize],
) -> Option<Exclusion> {
    let n_views = of_category.len();
    if n_views <= protocol.n_views_at_start {
        return Some(Exclusion::TooFewViews { n_views });
    }
    let is_split = protocol.split == LessonSplit::InstanceDisjoint;
    let instances = instances(views, of_category);
    let is_known = !instances.contains(&None);
    (is_split && !(is_known && instances.len() >= 2)).then_some(Exclusion::TooFewInstances)
}
