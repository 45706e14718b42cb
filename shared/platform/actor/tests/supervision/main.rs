//! Supervised actors, seen from outside.

mod escalation;
mod life_cycle;
mod model;
mod on_the_pool;
mod support;
mod tree;
mod tree_model;
