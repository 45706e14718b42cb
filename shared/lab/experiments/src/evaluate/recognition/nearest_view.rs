//! Nearest-neighbour classifier over taught views, as in the live system.

use super::{HypothesisDescriptors, RecogniserFactory};
use evaluation::recogniser::{Answer, Recogniser};
use learning::{CategoryIndex, CategoryName, Error, ViewId};

/// Descriptors of all views with an empty index.
pub(super) struct NearestViewClassifier {
    /// Nearest-view index without views.
    empty: CategoryIndex,
    /// Distance above which an object is unknown; infinite for none.
    threshold: f32,
    names: Vec<CategoryName>,
    descriptors: Vec<HypothesisDescriptors>,
}

/// Nearest-neighbour recogniser over the taught views.
struct NearestViewRecogniser<'a> {
    views: &'a NearestViewClassifier,
    index: CategoryIndex,
}

impl NearestViewClassifier {
    /// Classifier over descriptors in the order of the views; validates their dimension.
    pub(super) fn new(
        empty: CategoryIndex,
        threshold: f32,
        n_categories: usize,
        descriptors: Vec<HypothesisDescriptors>,
    ) -> Result<Self, Error> {
        let views = Self {
            empty,
            threshold,
            names: names(n_categories),
            descriptors,
        };
        for descriptors in &views.descriptors {
            views.empty.recognise_any(descriptors, 0.0)?;
        }
        Ok(views)
    }
}

/// Category names made of numbers: names of a data set need not be valid in the live system.
fn names(n: usize) -> Vec<CategoryName> {
    let number = |i: usize| CategoryName::new(&i.to_string());
    // A number is always a valid name.
    (0..n).filter_map(|i| number(i).ok()).collect()
}

impl RecogniserFactory for NearestViewClassifier {
    fn recogniser(&self) -> Box<dyn Recogniser + '_> {
        Box::new(NearestViewRecogniser {
            views: self,
            index: self.empty.clone(),
        })
    }
}

impl Recogniser for NearestViewRecogniser<'_> {
    fn teach(&mut self, category: u32, view: usize) {
        let views = self.views;
        let id = ViewId {
            track_id: view as u64,
            view_id: category,
        };
        let name = &views.names[category as usize];
        // The constructor has validated the descriptors, so this cannot fail.
        let _ = self.index.insert(id, name, &views.descriptors[view][0]);
    }

    fn ask(&mut self, view: usize) -> Answer {
        let views = self.views;
        let found = self
            .index
            .recognise_any(&views.descriptors[view], views.threshold);
        let nothing = Answer {
            category: None,
            distance: f32::INFINITY,
            novelty: f32::INFINITY,
        };
        found.map_or(nothing, |recognition| {
            let label = recognition.label.as_ref();
            let nearest = recognition.nearest[0].as_ref();
            Answer {
                category: label.and(nearest).map(|nearest| nearest.view.view_id),
                distance: recognition.distance,
                novelty: recognition.novelty.unwrap_or(recognition.distance),
            }
        })
    }
}
