//! Source file of a trained edge network for the detection crate.

use statistics::multilayer_perceptron::Perceptron;
use std::fmt::Write;

/// Rust source of the weights, with the command that made them.
pub(super) fn source(model: &Perceptron, datasets: &str) -> String {
    let mut source = format!(
        "//! Trained weights of the edge network. Generated, do not edit:\n//! `tabula-lab train \
         edge-network {datasets} --out <this file>`; `scripts/train-segmentation` simulates the \
         data sets.\n\nuse super::edge_network::EdgeNetwork;\n\n/// Weights of the edge \
         network.\n#[rustfmt::skip]\npub(super) static NETWORK: EdgeNetwork = EdgeNetwork {{\n    \
         hidden: [\n"
    );
    for unit in &model.hidden {
        // Writing to a string cannot fail.
        let _ = writeln!(
            source,
            "        ({:.4e}, [{}]),",
            unit.bias,
            numbers(&unit.weights)
        );
    }
    let output = &model.output;
    let _ = writeln!(
        source,
        "    ],\n    output: ({:.4e}, [{}]),\n}};",
        output.bias,
        numbers(&output.weights)
    );
    source
}

fn numbers(weights: &[f32]) -> String {
    let numbers = weights.iter().map(|weight| format!("{weight:.4e}"));
    numbers.collect::<Vec<_>>().join(", ")
}
