//! Classifier over taught views, as in the live system.

use super::{HypothesisDescriptors, RecogniserFactory};
use evaluation::recogniser::{Answer, Recogniser};
use learning::{CategoryIndex, CategoryName, Error, Neighbour, ViewId};

/// Descriptors of all views with an empty index.
pub(super) struct NearestViewClassifier {
    /// Nearest-view index without views.
    empty: CategoryIndex,
    /// Distance above which an object is unknown; infinite for none.
    threshold: f32,
    names: Vec<CategoryName>,
    descriptors: Vec<HypothesisDescriptors>,
}

/// Recogniser over the taught views.
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

    fn ask_sides(&mut self, views: &[usize]) -> Answer {
        let NearestViewClassifier {
            descriptors,
            threshold,
            ..
        } = self.views;
        let sides: Vec<&HypothesisDescriptors> =
            views.iter().map(|&view| &descriptors[view]).collect();
        let nothing = Answer {
            category: None,
            distance: f32::INFINITY,
            novelty: f32::INFINITY,
            probability: None,
            known_probability: None,
            best: [None; 3],
        };
        let found = self.index.recognise_sides(&sides, *threshold);
        found.map_or(nothing, |recognition| {
            let category = |neighbour: &Option<Neighbour>| Some(neighbour.as_ref()?.view.view_id);
            let [first, second, third, ..] = recognition.nearest.each_ref().map(category);
            Answer {
                category: first.filter(|_| recognition.label.is_some()),
                distance: recognition.distance,
                novelty: recognition.novelty.unwrap_or(recognition.distance),
                probability: recognition.probability,
                known_probability: recognition.known_probability,
                best: [first, second, third],
            }
        })
    }
}
