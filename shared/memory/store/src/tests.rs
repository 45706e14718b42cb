//! Tests of the whole crate: power cuts, and interoperability with C++ LevelDB.

mod cpp_leveldb;
mod power_loss;
