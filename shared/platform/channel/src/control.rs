//! Control protocol over two transports: shared memory between the daemon's
//! processes, a Unix socket for people and tools of any user in the group.
//!
//! Both carry the same CBOR bytes. Every request is answered, or its sender gets an
//! error; none is dropped silently.

mod access_policy;
mod call_error;
mod client;
mod codec;
mod connection;
mod connection_table;
mod message_stream;
mod peer;
mod peer_groups;
mod printable_request;
mod request_response;
mod server;
mod socket_client;
mod socket_server;

pub use access_policy::{AccessControl, RoleGroups};
pub use call_error::CallError;
pub use client::Client;
pub use connection::serve_stream;
pub use peer::Peer;
pub use server::Server;
pub use socket_client::SocketClient;
pub use socket_server::{SocketServer, UrgentHandler};

use message::control::{Command, Reply};
use std::future::Future;
use std::pin::Pin;
use std::sync::Arc;

/// Request handler, with the user who asks; runs as a tokio task for each request.
pub type Handler = Arc<dyn Fn(Command, Peer) -> AnswerFuture + Send + Sync>;

/// Future that resolves to the reply of a request handler.
pub type AnswerFuture = Pin<Box<dyn Future<Output = Reply> + Send>>;
