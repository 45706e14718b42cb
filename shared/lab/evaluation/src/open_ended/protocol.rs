//! Parameters of the open-ended learning protocol.

/// Split of the views into lessons and questions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LessonSplit {
    /// Lessons and questions share all views of a category; the view of a wrongly answered
    /// question is taught.
    ByView,
    /// Disjoint objects: lessons use half of the objects of a category, rounded down, and
    /// questions the others; a correction teaches the next lesson view.
    InstanceDisjoint,
}

/// Parameters of the open-ended learning protocol.
#[derive(Debug, Clone, PartialEq)]
pub struct Protocol {
    /// Accuracy threshold, 0 to 1: a stage ends when the protocol accuracy reaches it.
    pub tau: f64,
    /// Number of views a category is introduced with.
    pub n_views_at_start: usize,
    /// Sliding window of the protocol accuracy: this many most recent questions per category.
    pub window: usize,
    /// Number of questions beyond the window whose accuracy may stay at or below `tau`; the next
    /// one ends the run.
    pub stall_limit: u32,
    /// Share of open-set questions (categories not yet introduced), 0 to 0.9.
    pub open_set_share: f64,
    /// Split of the views into lessons and questions.
    pub split: LessonSplit,
}

impl Default for Protocol {
    /// Parameters as published: accuracy at least twice the error, three views, a window of three
    /// passes, 100 questions.
    fn default() -> Self {
        Self {
            tau: 0.67,
            n_views_at_start: 3,
            window: 3,
            stall_limit: 100,
            open_set_share: 0.0,
            split: LessonSplit::ByView,
        }
    }
}

/// Error of the protocol's parameters or data.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Accuracy threshold outside of 0 to 1.
    #[error(
        "the accuracy at which a category is learned cannot be {0}: choose from 0 to 1, 0.67 usually"
    )]
    Tau(f64),
    /// Share of open-set questions outside of 0 to 0.9.
    #[error("the share of open-set questions cannot be {0}: choose from 0 to 0.9")]
    OpenSetShare(f64),
    /// Protocol without views at the start, or with an empty window.
    #[error(
        "a category must be introduced with at least one view, and the window must have at least \
         one pass: raise them"
    )]
    Counts,
    /// Fewer than two categories are usable.
    #[error(
        "{n_usable} of the categories have enough views and objects for this protocol, and it needs \
         two: give more data, or choose another protocol"
    )]
    TooFewCategories {
        /// Number of usable categories.
        n_usable: usize,
    },
}

impl Protocol {
    pub(super) fn check(&self) -> Result<(), Error> {
        if !(0.0..=1.0).contains(&self.tau) {
            return Err(Error::Tau(self.tau));
        }
        if !(0.0..=0.9).contains(&self.open_set_share) {
            return Err(Error::OpenSetShare(self.open_set_share));
        }
        if self.n_views_at_start == 0 || self.window == 0 {
            return Err(Error::Counts);
        }
        Ok(())
    }
}
