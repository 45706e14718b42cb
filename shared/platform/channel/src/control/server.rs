//! Request server, for processes of the daemon.

use super::connection::serve_process;
use super::{Handler, SocketFile, bind_socket, own_peer, socket_failure};
use crate::{Domain, Error};
use message::ProcessKind;
use std::time::Duration;
use tokio::net::{UnixListener, UnixStream};

/// Mode of the socket: for this user only.
const PRIVATE: u32 = 0o600;
/// Idle time after which a connection is closed. Chosen: above the longest wait for an event.
const IDLE: Duration = Duration::from_secs(60);
/// Pause after a connection could not be accepted. Chosen.
const ACCEPT_PAUSE: Duration = Duration::from_millis(5);

/// Server of the requests that this process owns: a Unix socket for the daemon's own processes.
///
/// The socket is private to the user of the daemon, and whoever connects is asked for his user by
/// the kernel: no one else sends a command, or says on whose behalf it is.
pub struct Server {
    listener: UnixListener,
    socket: SocketFile,
    handler: Handler,
}

impl Server {
    /// Binds the socket of a process; within a tokio runtime. A socket left by a dead process is
    /// replaced: the caller holds the role's lock.
    ///
    /// # Errors
    /// When the socket cannot be bound, or its folder is under another user's control.
    pub fn bind(domain: &Domain, process: ProcessKind, handler: Handler) -> Result<Self, Error> {
        let (listener, socket) = bind_socket(&domain.request_socket(process), PRIVATE)?;
        let listener =
            UnixListener::from_std(listener).map_err(|source| socket_failure(&socket.0, source))?;
        Ok(Self {
            listener,
            socket,
            handler,
        })
    }

    /// Serves until the future is dropped; each connection in a task of its own.
    pub async fn run(self) {
        loop {
            match self.listener.accept().await {
                Ok((stream, _)) => begin(stream, self.handler.clone()),
                Err(error) => {
                    let path = self.socket.0.display();
                    tracing::warn!("{path} could not accept a connection: {error}");
                    tokio::time::sleep(ACCEPT_PAUSE).await;
                }
            }
        }
    }
}

fn begin(stream: UnixStream, handler: Handler) {
    let own = own_peer();
    match stream.peer_cred() {
        Ok(peer) if [0, own.uid].contains(&peer.uid()) => {
            tokio::spawn(async move {
                if let Err(error) = serve_process(stream, &handler, IDLE).await {
                    tracing::debug!("a connection of a process ended: {error}");
                }
            });
        }
        Ok(peer) => tracing::warn!("a connection of user {} was closed", peer.uid()),
        Err(error) => tracing::debug!("a connection of a process ended: {error}"),
    }
}
