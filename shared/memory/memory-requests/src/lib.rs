//! Request handler of the perceptual memory: answers control commands from the store.
//!
//! It is used by the memory service, and by the command-line tool, which opens the store itself
//! when no daemon runs. The crate converts between `message` and `store`; it has no transport of
//! its own.

mod change_text;
mod history_page;
mod jobs;
mod memory_request_handler;
mod queries;
mod revision;
mod translate;

mod compaction;
mod export;
mod import;
mod verification;

pub use history_page::{PAGE_ENTRIES, read_history};
pub use memory_request_handler::{MemoryDesk, MemoryDeskConfig};
pub use verification::verification_report;
