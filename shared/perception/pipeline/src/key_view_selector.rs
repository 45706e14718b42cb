//! Key-view selection by rest and novelty.

use crate::config::METRIC;
use geometry::RigidTransform;
use std::sync::Arc;
use tracking::KeyViewRule;

/// Descriptor distance to every earlier key view above which a view is novel. Two frames
/// of the same standing object differ by about half of it. Chosen.
const NOVELTY_MIN: f32 = 0.45;

/// Number of most recent key views with which a new view is compared. Chosen.
const N_COMPARED_MAX: usize = 16;

/// Key-view selector: accepts views of the whole object at rest that differ from earlier
/// key views. Clones share the descriptors.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct KeyViewSelector {
    rule: KeyViewRule,
    kept: Arc<Vec<Vec<f32>>>,
}

impl KeyViewSelector {
    /// Next view with all axis hypotheses of its descriptor; returns `true` for a key
    /// view. `pose` is the filtered pose of the object's box in the world.
    pub(crate) fn accept(
        &mut self,
        stamp_ns: u64,
        pose: &RigidTransform,
        is_whole: bool,
        hypotheses: &[Vec<f32>],
    ) -> bool {
        let is_due = self.rule.update(stamp_ns, pose, !is_whole);
        let is_key = is_due && self.is_novel(hypotheses);
        if let (true, Some(stored)) = (is_key, hypotheses.first()) {
            let kept = Arc::make_mut(&mut self.kept);
            if kept.len() >= N_COMPARED_MAX {
                kept.remove(0);
            }
            kept.push(stored.clone());
        }
        is_key
    }

    fn is_novel(&self, hypotheses: &[Vec<f32>]) -> bool {
        let is_like = |a: &Vec<f32>, b: &Vec<f32>| {
            let distance = METRIC.distance(a, b);
            distance.is_ok_and(|distance| distance < NOVELTY_MIN)
        };
        let mut kept = self.kept.iter();
        !kept.any(|kept| hypotheses.iter().any(|reading| is_like(kept, reading)))
    }
}
