//! Answer of a query: objects with their doubts, and the use of every word.

/// Answer of a query.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Objects that fit, best first. More than one in spite of `wants_one` means: ambiguous.
    pub matches: Vec<Match>,
    /// True if the expression refers to one object.
    pub wants_one: bool,
    /// Words that were understood, in the order of the query.
    pub understood: Vec<WordUse>,
    /// Words that were not understood, in the order of the query. A word of the query is either
    /// here or in `understood`.
    pub not_understood: Vec<String>,
    /// Remarks that concern no single object, for example that synonyms are off.
    pub remarks: Vec<String>,
    /// Answer in plain words, with tracks and doubts.
    pub sentence: String,
}

/// Object that fits an expression.
#[derive(Debug, Clone, PartialEq)]
pub struct Match {
    /// Number of the track.
    pub track_id: u64,
    /// Degree of fit, 0 to 1.
    pub score: f64,
    /// Reasons why this may be the wrong object, as plain sentences.
    pub doubts: Vec<String>,
}

/// Words of a query with their meaning.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WordUse {
    /// Words as they were written, joined by spaces.
    pub words: String,
    /// Meaning that they were given.
    pub meaning: String,
}
