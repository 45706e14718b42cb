//! Tests of the whole crate under power cuts and write errors.

mod fuzz_records;
mod power_loss;
mod read_only;
