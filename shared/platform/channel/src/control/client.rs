//! Request client, for processes of the daemon.

use super::message_stream::{read_reply, write_message};
use crate::Domain;
use control_protocol::{Command, MAX_MESSAGE_BYTES, Peer, Reply, Request, TypedRequest, codec};
use daemon_client::CallError;
use message::ProcessKind;
use std::io::{self, ErrorKind};
use std::path::PathBuf;
use std::time::Duration;
use tokio::net::UnixStream;

/// Pause before another attempt to connect to a server whose queue of connections is full. Chosen.
const RETRY_PERIOD: Duration = Duration::from_millis(5);

/// Client of the requests that one process owns.
///
/// Each call has a connection of its own: calls do not wait for each other, and one that is
/// dropped leaves nothing behind.
#[derive(Debug, Clone)]
pub struct Client {
    socket: PathBuf,
    process: ProcessKind,
}

impl Client {
    /// Creates a client of the server in `process`, which may start later.
    pub fn new(domain: &Domain, process: ProcessKind) -> Self {
        Self {
            socket: domain.request_socket(process),
            process,
        }
    }

    /// Sends a command of this process, and waits for the reply at most for the time limit.
    ///
    /// # Errors
    /// When the process does not run, or does not answer in time.
    pub async fn call(&self, command: Command, deadline: Duration) -> Result<Reply, CallError> {
        self.send(Request::from(command), deadline).await
    }

    /// Sends a request of this process, and waits for the value of its reply.
    ///
    /// # Errors
    /// As [`call`](Self::call), and when the process refuses the request.
    pub async fn ask<T>(
        &self,
        request: &TypedRequest<T>,
        deadline: Duration,
    ) -> Result<T, CallError> {
        let reply = self.call(request.command().clone(), deadline).await?;
        request.read(reply).map_err(CallError::Refusal)
    }

    /// Sends a command on behalf of a user, whom the server then takes for its sender.
    ///
    /// # Errors
    /// As [`call`](Self::call).
    pub async fn call_for(
        &self,
        user: Peer,
        command: Command,
        deadline: Duration,
    ) -> Result<Reply, CallError> {
        let request = Request {
            user: Some(user),
            ..Request::from(command)
        };
        self.send(request, deadline).await
    }

    async fn send(&self, request: Request, deadline: Duration) -> Result<Reply, CallError> {
        let bytes = codec::encode(&request).ok_or_else(|| {
            CallError::Refused(format!(
                "a request may have at most {MAX_MESSAGE_BYTES} bytes"
            ))
        })?;
        let exchange = async {
            let connected = self.connect().await;
            let mut stream = connected.map_err(|error| self.not_connected(error))?;
            let reply = async {
                write_message(&mut stream, &bytes).await?;
                read_reply(&mut stream).await
            };
            reply.await.map_err(|error| self.interrupted(error))
        };
        match tokio::time::timeout(deadline, exchange).await {
            Ok(reply) => reply,
            Err(_) => Err(CallError::TimedOut { after: deadline }),
        }
    }

    async fn connect(&self) -> io::Result<UnixStream> {
        loop {
            match UnixStream::connect(&self.socket).await {
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    tokio::time::sleep(RETRY_PERIOD).await;
                }
                connected => return connected,
            }
        }
    }

    fn not_connected(&self, source: io::Error) -> CallError {
        match source.kind() {
            ErrorKind::NotFound | ErrorKind::ConnectionRefused => CallError::NotThere {
                process: self.process.word(),
            },
            _ => carrier(source),
        }
    }

    fn interrupted(&self, source: io::Error) -> CallError {
        match source.kind() {
            ErrorKind::UnexpectedEof | ErrorKind::ConnectionReset | ErrorKind::BrokenPipe => {
                CallError::Interrupted {
                    process: self.process.word(),
                }
            }
            _ => carrier(source),
        }
    }
}

fn carrier(source: io::Error) -> CallError {
    CallError::Carrier {
        attempt: "ask",
        source,
    }
}
