//! Tests of the whole crate under power cuts and write errors.

mod power_loss;
