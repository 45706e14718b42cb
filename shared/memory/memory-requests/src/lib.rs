//! Request handler of the perceptual memory: answers control commands from the store.
//!
//! The memory service uses it for the daemon and, with `--offline`, for a client
//! without a daemon. The crate converts between `message` and `perceptual_memory`; it
//! has no transport of its own.
//!
//! ```no_run
//! use memory_requests::{MemoryRequestHandler, MemoryRequestHandlerConfig, UploadLimits};
//! use control_protocol::{Command, MemoryQuery};
//! use perceptual_memory::Requester;
//!
//! async fn print_stats(store: perceptual_memory::StoreHandle) {
//!     let (handler, _position) = MemoryRequestHandler::new(MemoryRequestHandlerConfig {
//!         store,
//!         scratch: "/tmp/uploads".into(),
//!         uploads: UploadLimits {
//!             max_bytes: 1 << 30,
//!             free_disk_min_bytes: 1 << 28,
//!         },
//!         descriptor_kind: "appearance",
//!     });
//!     let user = Requester::administrator(1000);
//!     let reply = handler.answer(Command::Memory(MemoryQuery::Stats), user).await;
//!     println!("{reply:?}");
//! }
//! ```

mod ahead_decisions;
mod change_text;
mod document_pages;
mod document_storing;
mod history_page;
mod job_context;
mod jobs;
mod memory_request_handler;
mod queries;
mod revision;
mod store_client;
mod translate;

mod compaction;
mod export;
mod import;
mod upload;
mod verification;

pub use memory_request_handler::{MemoryRequestHandler, MemoryRequestHandlerConfig};
pub use upload::UploadLimits;
pub use verification::verification_report;
