//! Categories and instance-based recognition with unknowns.
//!
//! A category is the set of views a person has taught under its name; an object
//! belongs to the category of the most similar taught view, or to none when even
//! that one is too different. [`CategoryIndex`] holds the taught views and
//! answers; [`teach`], [`correct`] and [`forget`] are the rules by which views
//! change their category; [`least_telling`] says which views of a category can be
//! spared.
//!
//! This crate never does I/O, depends on no other crate, and knows nothing about
//! where descriptors come from or where views are stored.

mod category_name;
mod error;
mod view_id;

mod metric;

mod calibration;
mod category_index;
mod nearest_categories;
mod recognition;

mod conceptualizer;
mod economy;

#[cfg(test)]
mod noise;

pub use calibration::Calibration;
pub use category_index::{CategoryIndex, Vicinity};
pub use category_name::{CategoryName, InvalidCategoryName};
pub use conceptualizer::{Refusal, ViewChange, ViewRecord, correct, forget, teach};
pub use economy::least_telling;
pub use error::Error;
pub use metric::{Metric, UnknownMetric};
pub use recognition::{N_NEAREST, Neighbour, Recognition, UnknownRule};
pub use view_id::ViewId;
