//! Server of the control socket (Unix domain socket), on a thread of its own.

use super::access_policy::{AccessControl, AccessPolicy};
use super::connection::{Handlers, serve};
use super::connection_table::{ConnectionTable, Limits};
use super::{Handler, RoleGroups, SocketFile, bind_socket, socket_failure};
use crate::Error;
use crate::trusted_folder::TrustedFolder;
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use std::io;
use std::os::unix::net::UnixListener as BlockingListener;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::{UnixListener, UnixStream};
use tokio::sync::{mpsc, oneshot};

/// Mode of the socket: for this user and the group.
const FOR_THE_GROUP: u32 = 0o660;
/// Limits of the control socket. Chosen; those of connections are high, since a client whose
/// connection is closed for newer ones connects again: among a thousand hostile clients, half as
/// many connections were made and a stop took half the time with 2048 as with 128.
const LIMITS: Limits = Limits {
    connections: 4096,
    connections_of_user: 2048,
    requests_of_user: 8,
    waits_of_user: 16,
    patience: Duration::from_secs(4),
};
/// Idle time after which a connection is closed. Chosen.
const IDLE: Duration = Duration::from_secs(10);
/// Connections that are accepted before those that are open get their turn. Chosen.
const ACCEPTED_AT_ONCE: u32 = 8;
/// Period of the heartbeat. Chosen.
const BEAT_PERIOD: Duration = Duration::from_millis(500);
/// Pause after a connection could not be accepted. Chosen.
const ACCEPT_PAUSE: Duration = Duration::from_millis(5);

/// Control-socket server. A message is a length (4 bytes, little-endian) and that many bytes of
/// CBOR, in both directions, any number of times.
///
/// Stop beats everything: urgent commands ([`Command::is_urgent`]) take no place and are
/// answered on the thread of the socket, however many clients connect, ask and wait. All other
/// requests take a place of their user, so that a user slows down nobody else.
///
/// [`Command::is_urgent`]: control_protocol::Command::is_urgent
pub struct SocketServer {
    listener: BlockingListener,
    file: SocketFile,
    access: AccessControl,
    ordinary: Handler,
    /// Handler of urgent commands, on the thread of the socket.
    urgent: Handler,
    /// Beats while the thread of the socket works; nobody listens at first.
    heart: Option<mpsc::Sender<()>>,
}

impl SocketServer {
    /// Binds the socket, mode 0660, group tabula where that group exists. A socket
    /// left by a dead process is replaced: the caller holds the role's lock. Group names are
    /// looked up now.
    ///
    /// # Errors
    /// When the path cannot be bound, or its folder is under another user's control.
    pub fn bind(
        path: &Path,
        groups: &RoleGroups,
        ordinary: Handler,
        urgent: Handler,
    ) -> Result<Self, Error> {
        let (listener, file) = bind_socket(path, FOR_THE_GROUP)?;
        if let (Some(folder), Some(name)) = (path.parent(), path.file_name()) {
            TrustedFolder::open(folder)?.share_entry_with_group(&name.to_string_lossy());
        }
        Ok(Self {
            listener,
            file,
            access: AccessControl::new(groups),
            ordinary,
            urgent,
            heart: None,
        })
    }

    /// Heartbeat of the thread of the socket, for the time when the server runs.
    pub fn heartbeat(&mut self) -> mpsc::Receiver<()> {
        let (heart, beats) = mpsc::channel(1);
        self.heart = Some(heart);
        beats
    }

    /// Control of the groups, for the time when the server runs.
    pub fn access_control(&self) -> AccessControl {
        self.access.clone()
    }

    /// Serves connections until the future is dropped. Ordinary requests are carried out on the
    /// runtime of the caller.
    pub async fn run(self) {
        let runtime = tokio::runtime::Handle::current();
        // Dropped with this future, which ends the thread.
        let (_keeps_running, stopped) = oneshot::channel::<()>();
        let (ended, end) = oneshot::channel::<()>();
        let serve = move || {
            if let Err(error) = self.serve_until(stopped, runtime) {
                tracing::error!("{error}");
            }
            drop(ended);
        };
        let thread = std::thread::Builder::new().name("control-socket".into());
        if let Err(error) = thread.spawn(serve) {
            tracing::error!("the thread of the control socket could not be started: {error}");
            return;
        }
        let _ = end.await;
    }

    fn serve_until(
        self,
        stopped: oneshot::Receiver<()>,
        runtime: tokio::runtime::Handle,
    ) -> Result<(), Error> {
        let failed = |source| socket_failure(&self.file.0, source);
        let own_runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(failed)?;
        own_runtime.block_on(async {
            let listener = self.listener.try_clone().and_then(UnixListener::from_std);
            let listener = listener.map_err(failed)?;
            let handlers = Handlers {
                urgent: self.urgent.clone(),
                ordinary: self.ordinary.clone(),
                runtime,
            };
            tokio::select! {
                () = accept(&listener, &self.access, &handlers) => {}
                () = beat(self.heart.as_ref()) => {}
                _ = stopped => {}
            }
            Ok(())
        })
    }
}

/// Beats for ever. A beat that nobody has taken yet is enough.
async fn beat(heart: Option<&mpsc::Sender<()>>) {
    loop {
        if let Some(heart) = heart {
            let _ = heart.try_send(());
        }
        tokio::time::sleep(BEAT_PERIOD).await;
    }
}

/// Accepts connections for ever; each is served by a task.
async fn accept(listener: &UnixListener, access: &AccessControl, handlers: &Handlers) {
    let table = ConnectionTable::new(limits());
    let mut n_accepted: u32 = 0;
    loop {
        match listener.accept().await {
            Ok((stream, _)) => begin(stream, access.policy(), &table, handlers),
            Err(error) => {
                tracing::warn!("the control socket could not accept a connection: {error}");
                tokio::time::sleep(ACCEPT_PAUSE).await;
            }
        }
        n_accepted = n_accepted.wrapping_add(1);
        if n_accepted.is_multiple_of(ACCEPTED_AT_ONCE) {
            tokio::task::yield_now().await;
        }
    }
}

/// Begins to serve a connection.
fn begin(
    stream: UnixStream,
    access: AccessPolicy,
    table: &Arc<ConnectionTable>,
    handlers: &Handlers,
) {
    let peer = match access.peer(&stream) {
        Ok(peer) => peer,
        Err(error) => {
            tracing::warn!("a control connection has no user and is closed: {error}");
            return;
        }
    };
    let (connection, evicted) = table.enter(peer);
    let handlers = handlers.clone();
    tokio::spawn(async move {
        let served = tokio::select! {
            served = serve(stream, &connection, &handlers, IDLE) => served,
            _ = evicted => Err(io::Error::other("newer connections of its user took its place")),
        };
        if let Err(error) = served {
            tracing::debug!("a control connection of user {} ended: {error}", peer.uid);
        }
    });
}

/// Limits that leave half of the process's file descriptors free.
fn limits() -> Limits {
    let half = n_descriptors() / 2;
    let half = usize::try_from(half).unwrap_or(usize::MAX).max(1);
    Limits {
        connections: LIMITS.connections.min(half),
        connections_of_user: LIMITS.connections_of_user.min(half),
        ..LIMITS
    }
}

/// Raises the soft limit of file descriptors to what the connections need, as far as the hard
/// limit permits; returns the limit.
fn n_descriptors() -> u64 {
    let wanted = 2 * LIMITS.connections as u64;
    let limit = getrlimit(Resource::Nofile);
    let present = limit.current.unwrap_or(u64::MAX);
    let possible = wanted.min(limit.maximum.unwrap_or(u64::MAX));
    let raised = Rlimit {
        current: Some(possible),
        ..limit
    };
    if present < possible && setrlimit(Resource::Nofile, raised).is_ok() {
        possible
    } else {
        present
    }
}
