//! Integration tests of the whole daemon; see the modules in `tests/`.
