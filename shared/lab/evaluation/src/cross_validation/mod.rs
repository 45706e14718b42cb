//! Stratified k-fold cross-validation over views, grouped by object if objects are known.

mod confusion_picture;
mod folds;
mod scores;
mod withheld;

pub use confusion_picture::svg as confusion_svg;
pub use folds::{Dealing, Error, Folds};
pub use scores::{Confusion, Scores};
pub use withheld::withheld;
