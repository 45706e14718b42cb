//! Cross-validation: each part of a data set is asked of who was taught the rest.

mod confusion_picture;
mod folds;
mod scores;
mod withheld;

pub use confusion_picture::svg as confusion_svg;
pub use folds::{Dealing, Error, Folds};
pub use scores::{Confusion, Scores};
pub use withheld::withheld;
