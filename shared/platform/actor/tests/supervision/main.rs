//! Supervision through the public interface: restarts, stops, escalation.

mod adder_fixture;
mod escalation;
mod life_cycle;
mod pooled_actors;
mod supervisor_model;
