//! Instance-based category learning and open-set recognition.
//!
//! A category is the set of views that a person taught under its name. An object belongs
//! to the category of its nearest taught view, or is unknown when even that one is too
//! different. [`CategoryIndex`] is the nearest-neighbour index; [`teach`], [`correct`]
//! and [`forget`] compute the label changes of views; [`redundant_views`] selects the
//! views that a category can lose.
//!
//! Invariants: this crate never does I/O, depends on no other crate of the workspace,
//! and is independent of the origin of descriptors and of the storage of views.
//!
//! # Example
//!
//! ```
//! use learning::{CategoryIndex, CategoryName, Metric, UnknownRule, ViewId};
//!
//! let mut index = CategoryIndex::new(2, Metric::Euclidean);
//! let mug = CategoryName::new("mug")?;
//! let view = ViewId { track_id: 1, view_id: 0 };
//! index.insert(view, &mug, &[0.9, 0.1])?;
//!
//! let rule = UnknownRule::FartherThan(0.5);
//! assert_eq!(index.recognise(&[0.8, 0.1], rule)?.label, Some(mug));
//! assert_eq!(index.recognise(&[0.0, 0.9], rule)?.label, None);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod category_name;
mod descriptor_kind;
mod error;
mod view_id;

mod metric;

mod calibration;
mod category_index;
mod nearest_categories;
mod nearest_neighbours;
mod novelty_prior;
mod recognition;

mod instance_pruning;
mod labelling;

#[cfg(test)]
mod test_noise;

pub use calibration::{Calibration, DescriptorMap, DescriptorSymmetries, MemoryTerm};
pub use category_index::{CategoryIndex, IndexBatch, TrackEvidence, ViewUse};
pub use category_name::{CategoryName, InvalidCategoryName};
pub use descriptor_kind::DESCRIPTOR_KIND;
pub use error::Error;
pub use instance_pruning::redundant_views;
pub use labelling::{LabelChange, TeachingError, ViewLabel, correct, forget, teach};
pub use metric::{Metric, UnknownMetric};
pub use novelty_prior::{Feedback, NoveltyPrior, under_prior};
pub use recognition::{N_NEAREST, Neighbour, Recognition, UnknownRule};
pub use view_id::ViewId;
