//! Server of the control socket (Unix domain socket).

use super::{Handler, codec};
use crate::Error;
use crate::trusted_folder::TrustedFolder;
use message::control::{MAX_MESSAGE_BYTES, Refusal, RefusalKind, Reply};
use std::io;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{UnixListener, UnixStream};
use tokio::sync::Semaphore;

/// Largest number of connections; more wait in the kernel's queue.
const MAX_CONNECTIONS: usize = 32;
/// Idle time after which a connection is closed.
const IDLE: Duration = Duration::from_secs(60);
/// Time limit for the transfer of one message.
const TRANSFER: Duration = Duration::from_secs(5);

/// Control-socket server. A message is a length (4 bytes, little-endian) and that
/// many bytes of CBOR, in both directions, any number of times.
pub struct SocketServer {
    listener: UnixListener,
    path: PathBuf,
    handler: Handler,
}

impl SocketServer {
    /// Binds the socket, mode 0660, group tabula where that group exists. A socket
    /// left by a dead process is replaced: the caller holds the role's lock.
    ///
    /// # Errors
    /// When the path cannot be bound, or its folder is under another user's control.
    pub fn bind(path: &Path, handler: Handler) -> Result<Self, Error> {
        let failed = |source| Error::RunFolder {
            attempt: "open the control socket",
            path: path.to_owned(),
            source,
        };
        let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else {
            return Err(failed(io::ErrorKind::InvalidInput.into()));
        };
        let folder = TrustedFolder::open(folder)?;
        let _ = std::fs::remove_file(path);
        let listener = UnixListener::bind(path).map_err(failed)?;
        std::fs::set_permissions(path, PermissionsExt::from_mode(0o660)).map_err(failed)?;
        folder.share_entry_with_group(&name.to_string_lossy());
        Ok(Self {
            listener,
            path: path.to_owned(),
            handler,
        })
    }

    /// Serves connections until the future is dropped.
    pub async fn run(self) {
        let places = Arc::new(Semaphore::new(MAX_CONNECTIONS));
        loop {
            let Ok(place) = places.clone().acquire_owned().await else {
                return;
            };
            match self.listener.accept().await {
                Ok((stream, _)) => {
                    let handler = self.handler.clone();
                    tokio::spawn(async move {
                        if let Err(error) = serve_stream(stream, &handler, IDLE).await {
                            tracing::debug!("a control connection ended: {error}");
                        }
                        drop(place);
                    });
                }
                Err(error) => {
                    tracing::warn!("the control socket could not accept a connection: {error}");
                    tokio::time::sleep(Duration::from_millis(100)).await;
                }
            }
        }
    }
}

impl Drop for SocketServer {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

/// Answers the requests of one connection until the other side closes it or says
/// nothing for `idle_limit`.
///
/// # Errors
/// When the stream fails, or a message does not arrive or leave in time.
pub async fn serve_stream(
    mut stream: UnixStream,
    handler: &Handler,
    idle_limit: Duration,
) -> io::Result<()> {
    loop {
        let mut length = [0; 4];
        match tokio::time::timeout(idle_limit, stream.read_exact(&mut length)).await {
            Ok(Ok(_)) => {}
            Ok(Err(error)) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(()),
            Ok(Err(error)) => return Err(error),
            Err(_) => return Ok(()),
        }
        let length = u32::from_le_bytes(length) as usize;
        if length > MAX_MESSAGE_BYTES {
            let sentence = format!("a request may have at most {MAX_MESSAGE_BYTES} bytes");
            let refusal = Reply::Refused(Refusal::new(RefusalKind::Invalid, sentence));
            // The rest of the stream cannot be trusted.
            return write(&mut stream, &refusal).await;
        }
        let mut bytes = vec![0; length];
        tokio::time::timeout(TRANSFER, stream.read_exact(&mut bytes)).await??;
        let reply = answer(&bytes, handler).await;
        write(&mut stream, &reply).await?;
    }
}

async fn answer(bytes: &[u8], handler: &Handler) -> Reply {
    match codec::decode_request(bytes) {
        Ok(command) if command.is_internal() => Reply::Refused(Refusal::new(
            RefusalKind::Invalid,
            "only the daemon's own processes may send this command",
        )),
        Ok(command) => handler(command).await,
        Err(refusal) => Reply::Refused(refusal),
    }
}

async fn write(stream: &mut UnixStream, reply: &Reply) -> io::Result<()> {
    let bytes = codec::encode_reply(reply);
    let mut message = (bytes.len() as u32).to_le_bytes().to_vec();
    message.extend(bytes);
    tokio::time::timeout(TRANSFER, stream.write_all(&message)).await??;
    Ok(())
}
