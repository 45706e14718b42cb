//! Agreement of both judges about the same grasps, those that were planned and spoiled ones: shares
//! and Cohen's kappa (1960).

use super::trial::{GraspOutcome, GraspTrial};
use serde::Serialize;

/// Agreement of our simulator with MuJoCo.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct JudgesAgreement {
    pub(super) n_both_held: usize,
    pub(super) n_both_failed: usize,
    pub(super) n_only_ours_held: usize,
    pub(super) n_only_mujoco_held: usize,
    /// Share of the grasps about which both agree.
    pub(super) agreement: f64,
    /// Share of MuJoCo's successes, and of its failures, about which ours agrees.
    pub(super) of_successes: f64,
    pub(super) of_failures: f64,
    /// Agreement beyond chance, up to 1.
    pub(super) kappa: f64,
}

impl JudgesAgreement {
    /// Agreement over trials; `None` where nothing was judged by both. A spoiled grasp out of the
    /// arm's reach says nothing, since MuJoCo has no arm.
    pub(super) fn of(trials: &[GraspTrial]) -> Option<Self> {
        let planned = trials
            .iter()
            .filter_map(|trial| Some((trial.outcome, trial.mujoco?)));
        let spoiled = trials.iter().filter_map(|trial| {
            let spoiled = trial.spoiled.as_ref()?;
            Some((spoiled.outcome, spoiled.mujoco))
        });
        let reached = spoiled.filter(|(outcome, _)| *outcome != GraspOutcome::OutOfReach);
        let mut counts = [[0_usize; 2]; 2];
        for (outcome, mujoco) in planned.chain(reached) {
            counts[usize::from(outcome == GraspOutcome::Lifted)][usize::from(mujoco)] += 1;
        }
        Self::of_counts(counts)
    }

    /// Agreement by counts, first index ours, second MuJoCo, 1 for held.
    fn of_counts(
        [[both_failed, only_mujoco], [only_ours, both_held]]: [[usize; 2]; 2],
    ) -> Option<Self> {
        let n = both_failed + only_mujoco + only_ours + both_held;
        let share = |part: usize, whole: usize| part as f64 / whole.max(1) as f64;
        let agreement = share(both_failed + both_held, n);
        let (ours, mujoco) = (
            share(both_held + only_ours, n),
            share(both_held + only_mujoco, n),
        );
        let by_chance = ours * mujoco + (1.0 - ours) * (1.0 - mujoco);
        (n > 0).then(|| Self {
            n_both_held: both_held,
            n_both_failed: both_failed,
            n_only_ours_held: only_ours,
            n_only_mujoco_held: only_mujoco,
            agreement,
            of_successes: share(both_held, both_held + only_mujoco),
            of_failures: share(both_failed, both_failed + only_ours),
            kappa: if by_chance < 1.0 {
                (agreement - by_chance) / (1.0 - by_chance)
            } else {
                1.0
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kappa_is_zero_by_chance_and_one_for_equal_verdicts() {
        let chance = JudgesAgreement::of_counts([[25, 25], [25, 25]]).unwrap();
        assert!(chance.kappa.abs() < 1e-12 && (chance.agreement - 0.5).abs() < 1e-12);
        let equal = JudgesAgreement::of_counts([[40, 0], [0, 60]]).unwrap();
        assert!((equal.kappa - 1.0).abs() < 1e-12);
        // A textbook case: 0.7 observed, 0.5 by chance.
        let some = JudgesAgreement::of_counts([[15, 10], [5, 20]]).unwrap();
        assert!((some.kappa - 0.4).abs() < 1e-12, "{some:?}");
        assert!((some.of_failures - 0.75).abs() < 1e-12);
        assert!((some.of_successes - 20.0 / 30.0).abs() < 1e-12);
        assert!(JudgesAgreement::of_counts([[0, 0], [0, 0]]).is_none());
    }
}
