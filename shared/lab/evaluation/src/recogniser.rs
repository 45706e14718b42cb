//! What learns and recognises in an experiment.

/// A view of a data set, with what is known of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LabelledView {
    /// Number of its category; the categories of a data set count from 0.
    pub category: u32,
    /// Number of the object among those of its category, if known.
    pub instance: Option<u32>,
}

/// Says what a view shows, by the views that it was taught. Views are known by
/// their index in the data set.
pub trait Recogniser {
    /// Learns that a view shows this category.
    fn teach(&mut self, category: u32, view: usize);

    /// Says what a view shows. Never learns from it.
    fn ask(&mut self, view: usize) -> Answer;
}

/// What a recogniser says of a view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// The category; `None` is "unknown".
    pub category: Option<u32>,
    /// How far the view is from the nearest that was taught, in the unit of the
    /// recogniser.
    pub distance: f32,
    /// The greater, the less the view is like anything that was taught; the distance
    /// where nothing better is known.
    pub novelty: f32,
}

/// The indices of the views of each category, by its number.
pub(crate) fn by_category(views: &[LabelledView]) -> Vec<(u32, Vec<usize>)> {
    let mut sorted: Vec<usize> = (0..views.len()).collect();
    sorted.sort_by_key(|&view| views[view].category);
    let chunks = sorted.chunk_by(|&a, &b| views[a].category == views[b].category);
    chunks
        .map(|chunk| (views[chunk[0]].category, chunk.to_vec()))
        .collect()
}
