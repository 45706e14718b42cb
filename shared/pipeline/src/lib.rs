//! One frame's step as pure functions over explicit state.
