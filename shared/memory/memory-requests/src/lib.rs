//! What the memory answers to control commands.
//!
//! The same answers are given by the daemon's memory process, and by a tool that
//! opens the store itself because no daemon runs. This crate translates between
//! `message` and `store`; it carries nothing and owns no socket.

mod desk;
mod jobs;
mod queries;
mod revision;
mod translate;
mod words;

mod compacting;
mod exporting;
mod importing;
mod verifying;

pub use desk::{MemoryDesk, MemoryDeskConfig};
pub use verifying::verification_report;
