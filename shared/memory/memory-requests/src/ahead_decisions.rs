//! Decisions of an export file from too far ahead of this clock: left out, or restamped.

use control_protocol::AheadDecision;
use perceptual_memory::{DecisionStamp, ForeignView, PortableBatch};

/// Maximum number of decisions that are named.
const N_NAMED: usize = 10;

/// Views and documents whose decision is from too far ahead.
#[derive(Debug, Default)]
pub(crate) struct AheadDecisions {
    pub(crate) n_left_out: u64,
    pub(crate) n_restamped: u64,
    /// The first of them.
    pub(crate) first: Vec<AheadDecision>,
}

impl AheadDecisions {
    /// Gives such decisions of a batch the present time, or takes their views and documents out of
    /// it.
    pub(crate) fn treat(&mut self, batch: &mut PortableBatch, restamp: bool, wall_ns: u64) {
        batch.views.retain_mut(|view| {
            let what = |view: &ForeignView| match view {
                ForeignView::Forgotten { .. } => "a forgotten view".to_owned(),
                ForeignView::Present { .. } => match view.standing().category() {
                    Some(name) => format!("a view of {name}"),
                    None => "a view without a label".to_owned(),
                },
            };
            let is_ahead = view
                .decided()
                .is_some_and(|decided| self.note(decided, || what(view), restamp, wall_ns));
            if is_ahead {
                view.restamp(wall_ns);
            }
            !is_ahead || restamp
        });
        batch.documents.retain_mut(|document| {
            let what = || document.key.to_string();
            let is_ahead = self.note(&document.decided, what, restamp, wall_ns);
            if is_ahead {
                document.decided.stamp_ns = wall_ns;
            }
            !is_ahead || restamp
        });
    }

    /// Counts and names a decision that is too far ahead; `true` for such a one.
    fn note(
        &mut self,
        decided: &DecisionStamp,
        what: impl FnOnce() -> String,
        restamp: bool,
        wall_ns: u64,
    ) -> bool {
        if !decided.is_too_far_ahead(wall_ns) {
            return false;
        }
        if restamp {
            self.n_restamped += 1;
        } else {
            self.n_left_out += 1;
        }
        if self.first.len() < N_NAMED {
            self.first.push(AheadDecision {
                what: what(),
                author: decided.author.to_string(),
                decided_ns: decided.stamp_ns,
            });
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perceptual_memory::{Digest, DocumentKey, DocumentKind, ForeignDocument};

    const HOUR_NS: u64 = 3_600_000_000_000;
    const NOW_NS: u64 = 1000 * HOUR_NS;

    fn batch(ahead_h: [u64; 3]) -> PortableBatch {
        let decided = |ahead_h: u64| DecisionStamp {
            author: "anna".into(),
            stamp_ns: NOW_NS + ahead_h * HOUR_NS,
        };
        let forgotten = |(number, ahead_h): (u8, u64)| ForeignView::Forgotten {
            identity: Digest::of(&[number]),
            decided: decided(ahead_h),
        };
        PortableBatch {
            views: [(0, ahead_h[0]), (1, ahead_h[1])].map(forgotten).into(),
            documents: vec![ForeignDocument {
                key: DocumentKey {
                    kind: DocumentKind::TaskKnowledge,
                    name: "shelf".into(),
                },
                document: None,
                decided: decided(ahead_h[2]),
            }],
        }
    }

    #[test]
    fn decisions_from_the_future_are_left_out_or_get_the_present_time() {
        let mut ahead = AheadDecisions::default();
        let mut left = batch([23, 25, 25]);
        ahead.treat(&mut left, false, NOW_NS);
        assert_eq!((left.views.len(), left.documents.len()), (1, 0));
        assert_eq!((ahead.n_left_out, ahead.n_restamped), (2, 0));
        let named = |decision: &AheadDecision| decision.what.clone();
        let named: Vec<String> = ahead.first.iter().map(named).collect();
        assert_eq!(named[0], "a forgotten view");
        assert!(named[1].contains("shelf"), "{named:?}");
        assert_eq!(ahead.first[0].decided_ns, NOW_NS + 25 * HOUR_NS);

        let mut ahead = AheadDecisions::default();
        let mut restamped = batch([23, 25, 25]);
        ahead.treat(&mut restamped, true, NOW_NS);
        let stamps = restamped.views.iter().filter_map(ForeignView::decided);
        let stamps: Vec<u64> = stamps.map(|decided| decided.stamp_ns).collect();
        // A day of difference is accepted as it is.
        assert_eq!(stamps, [NOW_NS + 23 * HOUR_NS, NOW_NS]);
        assert_eq!(restamped.documents[0].decided.stamp_ns, NOW_NS);
        assert_eq!((ahead.n_left_out, ahead.n_restamped), (0, 2));
    }
}
