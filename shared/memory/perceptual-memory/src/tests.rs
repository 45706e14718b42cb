//! Tests of the whole crate: power cuts, write errors, stored bytes.

mod fuzz_records;
mod golden;
mod power_loss;
mod read_only;
