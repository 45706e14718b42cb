//! Source file of trained trees for the detection crate.

use statistics::gradient_boosting::BoostedTrees;
use std::fmt::Write;

/// Rust source of the trees, with the command that made them.
pub(super) fn source(model: &BoostedTrees, datasets: &str) -> String {
    let mut source = format!(
        "//! Trained trees of region merging. Generated, do not edit:\n//! `tabula-lab train \
         region-merging {} --out <this file>`; `scripts/train-segmentation` simulates the data \
         sets.\n\nuse super::decision_tree::DecisionTree;\n\n/// Log odds without any \
         tree.\npub(super) const CONSTANT: f32 = {:.4e};\n\n/// Trees in the order of their \
         training.\n#[rustfmt::skip]\npub(super) static TREES: [DecisionTree; {}] = [\n",
        datasets,
        model.constant,
        model.trees.len()
    );
    for tree in &model.trees {
        let splits = tree.splits.iter();
        let splits = splits.map(|(feature, threshold)| format!("({feature}, {threshold:.4e})"));
        let leaves = tree.leaves.iter().map(|value| format!("{value:.4e}"));
        let splits = splits.collect::<Vec<_>>().join(", ");
        let leaves = leaves.collect::<Vec<_>>().join(", ");
        let line = format!("    DecisionTree {{ splits: [{splits}], leaves: [{leaves}] }},");
        // Writing to a string cannot fail.
        let _ = writeln!(source, "{line}");
    }
    source.push_str("];\n");
    source
}
