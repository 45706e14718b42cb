//! Generated household objects: parametric families whose instances differ.
//!
//! A family is a function from a [`Variation`] to a solid, in metres, standing
//! or lying as it does on a table with z up; the table of [`categories`] names
//! it. Instances of a category differ in proportion, detail, colour and texture.
//! The same category and instance give the same bytes.
//!
//! This crate does no I/O, keeps no state and knows no physics engine.

mod category;
mod curve;
mod families;
mod finish;
mod object;
mod palette;
mod profile;
mod texture;
mod variation;

pub use category::{Category, categories, category};
pub use object::{Object, generate};
pub use variation::Variation;
