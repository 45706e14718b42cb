//! Supervised actors, seen from outside.

mod escalation;
mod life_cycle;
mod on_the_pool;
mod support;
