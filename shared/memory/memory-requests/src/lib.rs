//! Request handler of the perceptual memory: answers control commands from the store.
//!
//! It is used by the memory service, and by the command-line tool, which opens the store itself
//! when no daemon runs. The crate converts between `message` and `perceptual_memory`; it has no transport of
//! its own.
//!
//! ```
//! use memory_requests::{PAGE_ENTRIES, read_history};
//!
//! // A client reads the history page by page; here the memory has no entries.
//! let ask = |_from: Option<u64>, max: u32| {
//!     assert!(max <= PAGE_ENTRIES);
//!     Ok::<_, std::convert::Infallible>((Vec::new(), 0))
//! };
//! let (entries, last_sequence) = read_history(None, 5000, ask).unwrap();
//! assert!(entries.is_empty() && last_sequence == 0);
//! ```

mod change_text;
mod history_page;
mod job_context;
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
pub use memory_request_handler::{MemoryRequestHandler, MemoryRequestHandlerConfig};
pub use verification::verification_report;
