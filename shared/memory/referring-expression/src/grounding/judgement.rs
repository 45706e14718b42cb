//! Judgement of an object by one predicate, and its rating by all.

/// Judgement of an object by one predicate.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Judgement {
    /// Degree to which the predicate holds, 0 to 1.
    pub(crate) score: f64,
    /// Reasons why it may not hold, as sentences that name the track.
    pub(crate) doubts: Vec<String>,
    /// Degree by which objects are compared if none fits, 0 to 1.
    pub(crate) nearness: f64,
    /// Predicate of a sentence if it holds: "is red".
    pub(crate) fit: String,
    /// Predicate of a sentence if it does not hold: "is blue".
    pub(crate) lack: String,
}

/// Least score of a predicate that counts as holding.
const HOLDS_MIN: f64 = 0.3;

impl Judgement {
    pub(crate) fn new(score: f64, fit: impl Into<String>, lack: impl Into<String>) -> Self {
        let score = if score.is_finite() { score } else { 0.0 };
        let score = score.clamp(0.0, 1.0);
        Self {
            score,
            nearness: score,
            doubts: Vec::new(),
            fit: fit.into(),
            lack: lack.into(),
        }
    }

    pub(crate) fn of_fact(holds: bool, fit: &str, lack: &str) -> Self {
        Self::new(f64::from(u8::from(holds)), fit, lack)
    }

    /// Adds a doubt if a condition holds.
    pub(crate) fn doubt_if(mut self, condition: bool, doubt: impl FnOnce() -> String) -> Self {
        if condition {
            self.doubts.push(doubt());
        }
        self
    }

    /// Judgement of the negation. A predicate that holds in part leaves a doubt.
    pub(crate) fn negated(self) -> Self {
        Self {
            score: 1.0 - self.score,
            nearness: 1.0 - self.nearness,
            doubts: if self.score > 0.1 {
                self.doubts
            } else {
                Vec::new()
            },
            fit: self.lack,
            lack: self.fit,
        }
    }
}

/// Rating of an object by all predicates of a phrase.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rating {
    /// Product of the scores.
    pub(crate) score: f64,
    /// True if the object has the category of the noun, or if there is no noun.
    pub(crate) has_category: bool,
    /// Sum of the nearness of all judgements.
    pub(crate) nearness: f64,
    /// Number of missing predicates that are only not known.
    pub(crate) n_unknown: usize,
    pub(crate) doubts: Vec<String>,
    /// Predicates that hold, for a sentence about the object.
    pub(crate) fits: Vec<String>,
    /// Predicates that do not hold.
    pub(crate) lacks: Vec<String>,
}

impl Default for Rating {
    fn default() -> Self {
        Self {
            score: 1.0,
            has_category: true,
            nearness: 0.0,
            n_unknown: 0,
            doubts: Vec::new(),
            fits: Vec::new(),
            lacks: Vec::new(),
        }
    }
}

impl Rating {
    /// True if no predicate is missing so far.
    pub(crate) fn lacks_nothing(&self) -> bool {
        self.lacks.is_empty()
    }

    /// True if the object may fit, but something of it is not known.
    pub(crate) fn may_fit(&self) -> bool {
        self.has_category && self.n_unknown > 0 && self.n_unknown == self.lacks.len()
    }

    pub(crate) fn apply(&mut self, judgement: Judgement) {
        self.score *= judgement.score;
        self.nearness += judgement.nearness;
        let (list, text) = if judgement.score >= HOLDS_MIN {
            (&mut self.fits, judgement.fit)
        } else {
            (&mut self.lacks, judgement.lack)
        };
        if !text.is_empty() {
            list.push(text);
        }
        for doubt in judgement.doubts {
            if !self.doubts.contains(&doubt) {
                self.doubts.push(doubt);
            }
        }
    }
}
