//! Servers and clients of the control protocol over Unix sockets: one socket of the gateway for
//! people and tools of any user in the group, and a private one of each process that owns requests.
//!
//! Every request is answered, or its sender gets an error; none is dropped silently.

mod access_policy;
mod client;
mod connection;
mod connection_table;
mod message_stream;
mod peer_groups;
mod server;
mod socket_server;

pub use access_policy::{AccessControl, RoleGroups};
pub use client::Client;
pub use connection::serve_process;
pub use server::Server;
pub use socket_server::SocketServer;

use crate::Error;
use crate::trusted_folder::TrustedFolder;
use control_protocol::{Command, Peer, Reply, UserRole};
use std::future::Future;
use std::io;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixListener;
use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::sync::Arc;

/// Request handler, with the user who asks; runs as a tokio task for each request.
pub type Handler = Arc<dyn Fn(Command, Peer) -> AnswerFuture + Send + Sync>;

/// Request handler that calls a function for each request.
pub fn handler<A>(answer: impl Fn(Command, Peer) -> A + Send + Sync + 'static) -> Handler
where
    A: Future<Output = Reply> + Send + 'static,
{
    Arc::new(move |command, user| -> AnswerFuture { Box::pin(answer(command, user)) })
}

/// Future that resolves to the reply of a request handler.
type AnswerFuture = Pin<Box<dyn Future<Output = Reply> + Send>>;

/// This process's own user, who runs the daemon.
pub fn own_peer() -> Peer {
    Peer {
        uid: rustix::process::geteuid().as_raw(),
        role: UserRole::Administrator,
    }
}

/// Socket in the file system, removed on drop.
#[derive(Debug)]
struct SocketFile(PathBuf);

impl Drop for SocketFile {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Binds a socket with a mode, in place of one that a dead process has left.
fn bind_socket(path: &Path, mode: u32) -> Result<(UnixListener, SocketFile), Error> {
    let failed = |source| socket_failure(path, source);
    let folder = path
        .parent()
        .ok_or_else(|| failed(io::ErrorKind::InvalidInput.into()))?;
    TrustedFolder::open(folder)?;
    let _ = std::fs::remove_file(path);
    let listener = UnixListener::bind(path).map_err(failed)?;
    let file = SocketFile(path.to_owned());
    listener.set_nonblocking(true).map_err(failed)?;
    std::fs::set_permissions(path, PermissionsExt::from_mode(mode)).map_err(failed)?;
    Ok((listener, file))
}

fn socket_failure(path: &Path, source: io::Error) -> Error {
    Error::RunFolder {
        attempt: "open the socket",
        path: path.to_owned(),
        source,
    }
}
