//! Stratified k-fold cross-validation over views, grouped by object if objects are known.

mod confusion_matrix;
mod confusion_matrix_figure;
mod k_fold_split;
mod view_groups;
mod withheld_categories;

pub use confusion_matrix::{ClassificationScores, ConfusionMatrix};
pub use confusion_matrix_figure::svg as confusion_matrix_svg;
pub use k_fold_split::{Error, FoldAssignment, Folds};
pub use view_groups::view_groups;
pub use withheld_categories::withheld_categories;
