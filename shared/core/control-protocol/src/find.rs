//! Queries in words, and their answers.

use scene_document::CategoryAnswer;
use serde::{Deserialize, Serialize};

/// Query in words for objects.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FindQuery {
    /// Words of the query, English: "the red mug left of the box".
    pub words: String,
    /// Author name of the person who asks, whom "I" means; `None` when it is not known.
    #[serde(default)]
    pub speaker: Option<String>,
    /// Offset of the person's local time to UTC, seconds, for words such as "yesterday".
    #[serde(default)]
    pub utc_offset_s: i32,
}

/// Answer to a query in words.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FindReport {
    /// Words of the query.
    pub query: String,
    /// Answer as a sentence, with the doubts.
    pub sentence: String,
    /// Objects that fit, best first; more than one in spite of `wants_one` is ambiguous.
    pub matches: Vec<FoundObjectReport>,
    /// True if the words mean one object.
    pub wants_one: bool,
    /// Words that were understood, in the order of the query.
    pub understood: Vec<WordUseReport>,
    /// Words that were not understood, in the order of the query.
    pub not_understood: Vec<String>,
    /// Remarks that concern no single object, one sentence each.
    pub remarks: Vec<String>,
    /// Age of the scene, as in [`SceneDocument::scene_age_s`](scene_document::SceneDocument::scene_age_s).
    pub scene_age_s: Option<f64>,
    /// True if the scene does not show the present.
    pub is_stale: bool,
}

/// Object that fits a query in words.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FoundObjectReport {
    /// Track-id of the object.
    pub track_id: u64,
    /// Degree to which the object fits, 0 to 1.
    pub score: f64,
    /// Reasons why it may be the wrong object, one sentence each.
    pub doubts: Vec<String>,
    /// Category name of the object, certain or probable; null when unknown.
    pub label: Option<String>,
    /// Answer about the category: `is`, `probably` or `unknown`.
    #[serde(default)]
    pub answer: CategoryAnswer,
    /// State of its track, as in [`ObjectDocument::state`](scene_document::ObjectDocument::state), or `gone`.
    pub state: String,
    /// Centre of its box in the world, metres; the last known one of an object that is gone.
    pub position_m: Option<[f64; 3]>,
}

/// Words of a query with their meaning.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct WordUseReport {
    /// Words as they were written.
    pub words: String,
    /// Meaning that they were given.
    pub meaning: String,
}
