//! Which views of an object are stored.

use crate::config::METRIC;
use geometry::RigidTransform;
use std::sync::Arc;
use tracking::KeyViewRule;

/// A view less different from every key view before it shows nothing new. Two
/// frames of the same standing object differ by about half of it.
const NOVELTY_MIN: f32 = 0.3;

/// Key views with which new ones are compared.
const N_COMPARED: usize = 16;

/// Decides which views of an object are key: those at rest that show it whole and
/// as it was not seen before. A copy is cheap: descriptors are shared.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct KeyViews {
    rule: KeyViewRule,
    kept: Arc<Vec<Vec<f32>>>,
}

impl KeyViews {
    /// Takes the next view, in all its readings; returns whether it is key. The
    /// pose is that of the object's box in the world, filtered.
    pub(crate) fn take(
        &mut self,
        stamp_ns: u64,
        pose: &RigidTransform,
        is_whole: bool,
        readings: &[Vec<f32>],
    ) -> bool {
        let is_due = self.rule.take(stamp_ns, pose, !is_whole);
        let is_key = is_due && self.is_novel(readings);
        if let (true, Some(stored)) = (is_key, readings.first()) {
            let kept = Arc::make_mut(&mut self.kept);
            if kept.len() >= N_COMPARED {
                kept.remove(0);
            }
            kept.push(stored.clone());
        }
        is_key
    }

    fn is_novel(&self, readings: &[Vec<f32>]) -> bool {
        let is_like = |a: &Vec<f32>, b: &Vec<f32>| {
            let distance = METRIC.distance(a, b);
            distance.is_ok_and(|distance| distance < NOVELTY_MIN)
        };
        let mut kept = self.kept.iter();
        !kept.any(|kept| readings.iter().any(|reading| is_like(kept, reading)))
    }
}
