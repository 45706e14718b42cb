//! Execution of a detection: parallelism and stage observer.

use crate::{DetectionStage, Parallelism, Sequential};

/// Execution of a detection; by default sequential and without an observer.
pub struct Execution<'a> {
    /// Parallelism: threads on which the stages run.
    pub parallelism: &'a dyn Parallelism,
    /// Stage observer, called at the end of each stage, so that a caller with a clock
    /// can time it. An unorganised cloud has no stages, a frame without a table only
    /// the first ones.
    pub observer: Option<&'a mut dyn FnMut(DetectionStage)>,
}

impl Execution<'_> {
    /// Report the end of a stage to the observer.
    pub(crate) fn end_stage(&mut self, stage: DetectionStage) {
        if let Some(observer) = &mut self.observer {
            observer(stage);
        }
    }
}

impl Default for Execution<'_> {
    fn default() -> Self {
        Self {
            parallelism: &Sequential,
            observer: None,
        }
    }
}
