//! Connection of the control socket: reads requests, has them carried out, writes the replies.

use super::connection_table::Connection;
use super::message_stream::{hung_up, next_length, read_bytes, write_reply};
use super::{Handler, own_peer};
use control_protocol::{Command, Peer, Refusal, RefusalKind, Reply, Request, codec};
use std::io;
use std::time::Duration;
use tokio::net::UnixStream;
use tokio::runtime;
use tokio::task::JoinHandle;

/// Largest request that is read before it has a place, bytes. All urgent ones are smaller.
const SMALL_BYTES: usize = 1024;

/// Handlers of the requests of a control socket.
#[derive(Clone)]
pub(super) struct Handlers {
    /// Handler of urgent commands, on the thread of the socket.
    pub(super) urgent: Handler,
    /// Handler of all other commands, on the runtime of the process.
    pub(super) ordinary: Handler,
    /// Runtime of the process.
    pub(super) runtime: runtime::Handle,
}

/// Serves the requests of one connection until its peer closes it or is silent for `idle_limit`.
///
/// # Errors
/// When the stream fails, or a message does not arrive or leave in time.
pub(super) async fn serve(
    mut stream: UnixStream,
    connection: &Connection,
    handlers: &Handlers,
    idle_limit: Duration,
) -> io::Result<()> {
    while let Some(length) = next_length(&mut stream, idle_limit).await? {
        connection.heard();
        let is_open = if length <= SMALL_BYTES {
            serve_small(&mut stream, length, connection, handlers).await?
        } else {
            serve_large(&mut stream, length, connection, handlers).await?
        };
        if !is_open {
            break;
        }
    }
    Ok(())
}

/// Serves a request that is read at once. False when the peer is gone.
async fn serve_small(
    stream: &mut UnixStream,
    length: usize,
    connection: &Connection,
    handlers: &Handlers,
) -> io::Result<bool> {
    let bytes = read_bytes(stream, length).await?;
    let command = match accepted(&bytes, connection.peer()) {
        Ok(command) => command,
        Err(refusal) => {
            return write_reply(stream, &Reply::Refused(refusal))
                .await
                .map(|()| true);
        }
    };
    if command.is_urgent() {
        let reply = (handlers.urgent)(command, connection.peer()).await;
        return write_reply(stream, &reply).await.map(|()| true);
    }
    let place = if command.waiting_time().is_zero() {
        connection.request_place().await
    } else {
        connection.waiting_place()
    };
    // Held until the reply is written: a slow reader takes a place, too.
    let _place = match place {
        Ok(place) => place,
        Err(refusal) => {
            return write_reply(stream, &Reply::Refused(refusal))
                .await
                .map(|()| true);
        }
    };
    let reply = (handlers.ordinary)(command, connection.peer());
    carry_out(stream, handlers.runtime.spawn(reply)).await
}

/// Serves a request that is read only when it has a place. False when the peer is gone.
async fn serve_large(
    stream: &mut UnixStream,
    length: usize,
    connection: &Connection,
    handlers: &Handlers,
) -> io::Result<bool> {
    let _place = match connection.request_place().await {
        Ok(place) => place,
        Err(refusal) => {
            // Its bytes were not read, and what follows them cannot be found.
            write_reply(stream, &Reply::Refused(refusal)).await?;
            return Ok(false);
        }
    };
    let bytes = read_bytes(stream, length).await?;
    let (handler, peer) = (handlers.ordinary.clone(), connection.peer());
    let reply = async move { answer(&bytes, &handler, peer).await };
    carry_out(stream, handlers.runtime.spawn(reply)).await
}

/// Waits for the reply and writes it; gives up when the peer is gone, which is false then.
async fn carry_out(stream: &mut UnixStream, mut task: JoinHandle<Reply>) -> io::Result<bool> {
    let reply = tokio::select! {
        reply = &mut task => reply,
        () = hung_up(stream) => {
            task.abort();
            return Ok(false);
        }
    };
    let reply = reply.unwrap_or_else(|lost| {
        tracing::error!("a control request failed: {lost}");
        let sentence = "the request failed; see the log of the daemon";
        Reply::Refused(Refusal::new(RefusalKind::Internal, sentence))
    });
    write_reply(stream, &reply).await.map(|()| true)
}

/// Serves a process of this user, over a private socket, until it closes the connection or is
/// silent for `idle_limit`. It may send internal commands, and commands on behalf of other users.
///
/// # Errors
/// When the stream fails, or a message does not arrive or leave in time.
pub async fn serve_process(
    mut stream: UnixStream,
    handler: &Handler,
    idle_limit: Duration,
) -> io::Result<()> {
    while let Some(length) = next_length(&mut stream, idle_limit).await? {
        let bytes = read_bytes(&mut stream, length).await?;
        let handler = handler.clone();
        let reply = async move {
            match codec::decode_request(&bytes) {
                Ok(request) => {
                    handler(request.command, request.user.unwrap_or_else(own_peer)).await
                }
                Err(refusal) => Reply::Refused(refusal),
            }
        };
        if !carry_out(&mut stream, tokio::spawn(reply)).await? {
            break;
        }
    }
    Ok(())
}

async fn answer(bytes: &[u8], handler: &Handler, peer: Peer) -> Reply {
    match accepted(bytes, peer) {
        Ok(command) => handler(command, peer).await,
        Err(refusal) => Reply::Refused(refusal),
    }
}

/// Command of a request that the peer may send.
fn accepted(bytes: &[u8], peer: Peer) -> Result<Command, Refusal> {
    let Request { command, user, .. } = codec::decode_request(bytes)?;
    if command.is_internal() || user.is_some() {
        let sentence = "only the daemon's own processes may send this command";
        return Err(Refusal::new(RefusalKind::Invalid, sentence));
    }
    let required = command.required_role();
    if peer.role < required {
        let sentence = format!(
            "user {} has the role of a {} here, and this command needs the one of a {}; ask for \
             membership in its group, see [gateway] {}_group in the configuration",
            peer.uid,
            peer.role.name(),
            required.name(),
            required.name()
        );
        return Err(Refusal::new(RefusalKind::Forbidden, sentence));
    }
    Ok(command)
}
