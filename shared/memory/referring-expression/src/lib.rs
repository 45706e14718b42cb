//! Referring expression comprehension: from "the red mug left of the box" to an object.
//!
//! [`find`] reads an English noun phrase with colours, sizes, spatial relations, ranks and times,
//! and grounds it in a [`QueryWorld`]. It does no I/O and reads no clock; only [`WordNet`], which
//! may be passed as a [`Lexicon`] of synonyms, reads files. It never guesses in silence: each
//! [`Match`] carries its doubts, and each word of the query is listed with its meaning or as not
//! understood.
//!
//! ```
//! use referring_expression::{Presence, QueryWorld, Viewpoint, WorldObject, find};
//!
//! let object = |track_id, name: &str, x_m| WorldObject {
//!     track_id,
//!     names: vec![(name.to_owned(), 1.0)],
//!     is_labelled: true,
//!     color_shares: [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
//!     centre_in_world_m: [x_m, 0.0, 0.75],
//!     orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
//!     size_m: [0.1; 3],
//!     presence: Presence::InView,
//!     first_seen_ns: 0,
//!     last_seen_ns: 0,
//! };
//! let world = QueryWorld {
//!     objects: &[object(7, "mug", -0.3), object(8, "box", 0.0), object(9, "mug", 0.3)],
//!     viewpoint: Some(Viewpoint {
//!         position_in_world_m: [0.0, -1.0, 1.2],
//!         right_in_world: [1.0, 0.0, 0.0],
//!         forward_in_world: [0.0, 1.0, 0.0],
//!     }),
//!     lessons: &[],
//!     taught_names: &[],
//!     now_ns: 0,
//!     utc_offset_s: 0,
//!     speaker: None,
//! };
//! let answer = find("Where is the red mug left of the box?", &world, None)?;
//! assert_eq!(answer.matches[0].track_id, 7);
//! assert!(answer.matches[0].doubts.is_empty());
//! # Ok::<(), referring_expression::Error>(())
//! ```

mod answer;
mod answer_text;
mod box_geometry;
mod compound;
mod comprehension;
mod empty_answer;
mod error;
mod expression;
mod grounding;
mod lexicon;
mod names;
mod parser;
mod relation;
mod shade;
mod size;
mod spelling;
mod time_phrase;
mod tokens;
mod vocabulary;
mod word_account;
mod wordnet;
mod world;

#[cfg(test)]
mod tests;

pub use answer::{Answer, Match, WordUse};
pub use comprehension::{QUERY_CHARACTERS_MAX, find};
pub use error::Error;
pub use lexicon::{Kinship, Lexicon};
pub use point_cloud::ColorTerm;
pub use wordnet::WordNet;
pub use world::{Lesson, Presence, QueryWorld, Viewpoint, WorldObject};
