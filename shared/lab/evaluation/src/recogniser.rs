//! Interface of a recogniser under evaluation.

/// Ground truth of a view of a data set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LabelledView {
    /// Category number; the categories of a data set count from 0.
    pub category: u32,
    /// Object number within the category, if known.
    pub instance: Option<u32>,
}

/// Recogniser under evaluation. Views are identified by their index in the data set.
pub trait Recogniser {
    /// Trains on a view of the given category.
    fn teach(&mut self, category: u32, view: usize);

    /// Classifies an object by one or more of its views. Never learns from them.
    fn ask_sides(&mut self, views: &[usize]) -> Answer;

    /// Classifies a view. Never learns from it.
    fn ask(&mut self, view: usize) -> Answer {
        self.ask_sides(&[view])
    }
}

/// Answer of a recogniser to a view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Recognised category; `None` for the answer "unknown".
    pub category: Option<u32>,
    /// Distance to the nearest taught view, in the recogniser's unit.
    pub distance: f32,
    /// Novelty: larger means less similar to anything taught. Equal to the distance if the
    /// recogniser has no better measure.
    pub novelty: f32,
    /// Probability that the best category is right, 0 to 1, if the recogniser tells one.
    pub probability: Option<f32>,
    /// Probability that the category is any of those taught, 0 to 1, if the recogniser tells one.
    pub known_probability: Option<f32>,
    /// Three best categories, best first, before rejection.
    pub best: [Option<u32>; 3],
}

impl Answer {
    /// True if there is no category, or the best one is less probable than
    /// `known_probability_min`.
    pub fn is_unknown(&self, known_probability_min: f32) -> bool {
        let is_improbable = self.probability.is_some_and(|p| p < known_probability_min);
        self.category.is_none() || is_improbable
    }

    /// True if the category is among the three best.
    pub fn is_among_best(&self, category: u32) -> bool {
        self.best.contains(&Some(category))
    }
}

/// View indices grouped by category number.
pub(crate) fn by_category(views: &[LabelledView]) -> Vec<(u32, Vec<usize>)> {
    let mut sorted: Vec<usize> = (0..views.len()).collect();
    sorted.sort_by_key(|&view| views[view].category);
    let chunks = sorted.chunk_by(|&a, &b| views[a].category == views[b].category);
    chunks
        .map(|chunk| (views[chunk[0]].category, chunk.to_vec()))
        .collect()
}
