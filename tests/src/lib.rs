//! Integration tests of the whole daemon; all of them are in `main.rs` and its
//! modules, one test binary.
