//! Server of the control socket (Unix domain socket), on a thread of its own.

use super::access_policy::{AccessControl, AccessPolicy};
use super::connection::{Handlers, serve};
use super::connection_table::{ConnectionTable, Limits};
use super::{Handler, RoleGroups};
use crate::Error;
use crate::trusted_folder::TrustedFolder;
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use std::io;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixListener as BlockingListener;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tokio::net::{UnixListener, UnixStream};
use tokio::sync::oneshot;

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
/// Pause after a connection could not be accepted. Chosen.
const ACCEPT_PAUSE: Duration = Duration::from_millis(5);

/// Makes the handler of the urgent commands, within the runtime that it is used in.
pub type UrgentHandler = Box<dyn FnOnce() -> Result<Handler, Error> + Send>;

/// Control-socket server. A message is a length (4 bytes, little-endian) and that many bytes of
/// CBOR, in both directions, any number of times.
///
/// Stop beats everything: urgent commands ([`Command::is_urgent`]) take no place and are
/// answered on the thread of the socket, however many clients connect, ask and wait. All other
/// requests take a place of their user, so that a user slows down nobody else.
///
/// [`Command::is_urgent`]: message::control::Command::is_urgent
pub struct SocketServer {
    listener: BlockingListener,
    path: PathBuf,
    access: AccessControl,
    ordinary: Handler,
    /// Taken when serving begins.
    urgent: Option<UrgentHandler>,
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
        urgent: UrgentHandler,
    ) -> Result<Self, Error> {
        let failed = |source| failure(path, source);
        let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else {
            return Err(failed(io::ErrorKind::InvalidInput.into()));
        };
        let folder = TrustedFolder::open(folder)?;
        let _ = std::fs::remove_file(path);
        let listener = BlockingListener::bind(path).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        std::fs::set_permissions(path, PermissionsExt::from_mode(0o660)).map_err(failed)?;
        folder.share_entry_with_group(&name.to_string_lossy());
        Ok(Self {
            listener,
            path: path.to_owned(),
            access: AccessControl::new(groups),
            ordinary,
            urgent: Some(urgent),
        })
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
        mut self,
        stopped: oneshot::Receiver<()>,
        runtime: tokio::runtime::Handle,
    ) -> Result<(), Error> {
        let failed = |source| failure(&self.path, source);
        let own_runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(failed)?;
        own_runtime.block_on(async {
            let listener = self.listener.try_clone().and_then(UnixListener::from_std);
            let listener = listener.map_err(failed)?;
            let Some(urgent) = self.urgent.take() else {
                return Ok(());
            };
            let handlers = Handlers {
                urgent: urgent()?,
                ordinary: self.ordinary.clone(),
                runtime,
            };
            tokio::select! {
                () = accept(&listener, &self.access, &handlers) => {}
                _ = stopped => {}
            }
            Ok(())
        })
    }
}

impl Drop for SocketServer {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
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

fn failure(path: &Path, source: io::Error) -> Error {
    Error::RunFolder {
        attempt: "open the control socket",
        path: path.to_owned(),
        source,
    }
}
