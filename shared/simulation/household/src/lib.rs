//! Procedural household objects: parametric families with random instances.
//!
//! A family is a function from a [`Variation`] to a solid, in metres, standing or lying as on a
//! table with z up; the table of [`categories`] names it. Instances of a category differ in
//! proportion, detail, colour and texture. The same category and instance give the same bytes.
//!
//! ```
//! use household::{category, generate};
//!
//! let mug = category("mug").ok_or("no such category")?;
//! let object = generate(mug, 3);
//! assert_eq!(object, generate(mug, 3));
//! assert_ne!(object.mesh, generate(mug, 4).mesh);
//! assert!(object.mass_kg > 0.0 && !object.convex_parts.is_empty());
//! # Ok::<(), &str>(())
//! ```
//!
//! Invariants: this crate does no I/O, keeps no state and uses no physics engine.

mod category;
mod families;
mod finish;
mod object;
mod palette;
mod pattern;
mod profile;
mod sweep;
mod variation;

pub use category::{Category, categories, category};
pub use object::{Object, generate};
pub use variation::Variation;
