//! Blocking client of the daemon's control socket.

use crate::{CallError, DomainName, RunFolder};
use control_protocol::{Command, MAX_MESSAGE_BYTES, Reply, Request, TypedRequest, codec};
use rustix::net::sockopt::socket_peercred;
use std::io::{self, Read, Write};
use std::os::unix::fs::MetadataExt;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::{Duration, Instant};

/// Shortest time limit of a call.
const SHORTEST_DEADLINE: Duration = Duration::from_millis(1);

/// Connection to a daemon, blocking: for tools.
#[derive(Debug)]
pub struct DaemonClient {
    stream: UnixStream,
    deadline: Duration,
}

impl DaemonClient {
    /// Connects to the daemon of a domain; tries the run folders in order.
    ///
    /// # Errors
    /// When no daemon answers there, or this user may not use its socket.
    pub fn connect(
        domain: &DomainName,
        folders: &[RunFolder],
        deadline: Duration,
    ) -> Result<Self, CallError> {
        let mut denied = None;
        for folder in folders {
            match UnixStream::connect(folder.control_socket(domain)) {
                Ok(stream) => {
                    check_owner(&stream, &folder.domain_folder(domain))?;
                    return Self::from_stream(stream, deadline);
                }
                Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
                    denied = Some(folder.control_socket(domain));
                }
                Err(_) => {}
            }
        }
        Err(match denied {
            Some(path) => CallError::Refused(format!(
                "this user may not use {}; ask for membership in the group tabula",
                path.display()
            )),
            None => CallError::NoDaemon {
                domain: domain.to_string(),
            },
        })
    }

    /// A client over a connected stream, for example one end of a socket pair.
    ///
    /// # Errors
    /// When the stream takes no time limit.
    pub fn from_stream(stream: UnixStream, deadline: Duration) -> Result<Self, CallError> {
        let failed = |source| CallError::Carrier {
            attempt: "set up the connection to",
            source,
        };
        stream.set_read_timeout(Some(deadline)).map_err(failed)?;
        stream.set_write_timeout(Some(deadline)).map_err(failed)?;
        Ok(Self { stream, deadline })
    }

    /// Asks a daemon on a connection of its own. An urgent request is repeated, on a new
    /// connection, when the daemon had to close the first one in favour of newer ones.
    ///
    /// # Errors
    /// As [`connect`](Self::connect) and [`ask`](Self::ask).
    pub fn ask_once<T>(
        domain: &DomainName,
        folders: &[RunFolder],
        deadline: Duration,
        request: &TypedRequest<T>,
    ) -> Result<T, CallError> {
        let begin = Instant::now();
        loop {
            let left = deadline.saturating_sub(begin.elapsed());
            let reply = Self::connect(domain, folders, left.max(SHORTEST_DEADLINE))
                .and_then(|mut client| client.ask(request));
            match reply {
                Err(CallError::Interrupted { .. })
                    if request.command().is_urgent() && !left.is_zero() => {}
                reply => return reply,
            }
        }
    }

    /// Sends a request and waits for the value of its reply.
    ///
    /// # Errors
    /// When the daemon refuses the request, ends, or does not answer in time.
    pub fn ask<T>(&mut self, request: &TypedRequest<T>) -> Result<T, CallError> {
        let reply = self.call(request.command().clone())?;
        request.read(reply).map_err(CallError::Refusal)
    }

    /// Sends a command and waits for the reply.
    ///
    /// # Errors
    /// When the daemon ends, or does not answer in time.
    pub fn call(&mut self, command: Command) -> Result<Reply, CallError> {
        let bytes = codec::encode(&Request::from(command)).ok_or_else(|| {
            CallError::Refused(format!(
                "a request may have at most {MAX_MESSAGE_BYTES} bytes"
            ))
        })?;
        self.stream
            .write_all(&codec::framed(&bytes))
            .map_err(|e| self.lost("ask", e))?;
        let mut length = [0; 4];
        self.stream
            .read_exact(&mut length)
            .map_err(|e| self.lost("hear", e))?;
        let length = u32::from_le_bytes(length) as usize;
        if length > MAX_MESSAGE_BYTES {
            return Err(CallError::Refused(
                "the daemon's answer is not understood".into(),
            ));
        }
        let mut reply = vec![0; length];
        self.stream
            .read_exact(&mut reply)
            .map_err(|e| self.lost("hear", e))?;
        Ok(codec::decode_reply(&reply))
    }

    fn lost(&self, attempt: &'static str, source: io::Error) -> CallError {
        match source.kind() {
            io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => CallError::TimedOut {
                after: self.deadline,
            },
            io::ErrorKind::UnexpectedEof
            | io::ErrorKind::ConnectionReset
            | io::ErrorKind::BrokenPipe => CallError::Interrupted { process: "gateway" },
            _ => CallError::Carrier { attempt, source },
        }
    }
}

/// Checks that a daemon of the folder's owner, or of root, listens at the other end.
fn check_owner(stream: &UnixStream, folder: &Path) -> Result<(), CallError> {
    let failed = |source: io::Error| CallError::Carrier {
        attempt: "find the owner of",
        source,
    };
    let owner = std::fs::symlink_metadata(folder).map_err(failed)?.uid();
    let daemon = socket_peercred(stream).map_err(|error| failed(error.into()))?;
    let daemon = daemon.uid.as_raw();
    if [0, owner].contains(&daemon) {
        return Ok(());
    }
    Err(CallError::Refused(format!(
        "user {daemon} answers in {}, which belongs to user {owner}; that is not the daemon",
        folder.display()
    )))
}
