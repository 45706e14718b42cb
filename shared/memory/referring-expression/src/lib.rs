//! Referring expressions.
mod answer;
mod box_geometry;
mod color_term;
mod error;
mod expression;
mod lexicon;
mod names;
mod parser;
mod relation;
mod size;
mod time_phrase;
mod tokens;
mod vocabulary;
mod wordnet;
mod world;

pub use answer::{Answer, Match, WordUse};
pub use color_term::ColorTerm;
pub use error::Error;
pub use lexicon::{Kinship, Lexicon};
pub use wordnet::WordNet;
pub use world::{Lesson, QueryWorld, Viewpoint, WorldObject};
