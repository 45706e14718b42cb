//! The control protocol's two carriers: shared memory between the daemon's own
//! processes, a Unix socket for people and tools of any user in the group.
//!
//! Both carry the same CBOR bytes. A request is answered or its sender is told
//! that it was not; nothing is dropped silently.

mod codec;
mod error;
pub(crate) mod shared_memory;
mod shared_memory_client;
mod shared_memory_server;
mod socket_client;
mod socket_server;

pub use error::CallError;
pub use shared_memory_client::Client;
pub use shared_memory_server::Server;
pub use socket_client::SocketClient;
pub use socket_server::{SocketServer, serve_stream};

use message::control::{Command, Reply};
use std::future::Future;
use std::pin::Pin;
use std::sync::Arc;

/// Answers commands; runs as a tokio task for each request.
pub type Handler = Arc<dyn Fn(Command) -> AnswerFuture + Send + Sync>;

/// The answer to come.
pub type AnswerFuture = Pin<Box<dyn Future<Output = Reply> + Send>>;
