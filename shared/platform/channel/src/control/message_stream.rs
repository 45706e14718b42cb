//! Messages over a stream socket: a length (4 bytes, little-endian) and that many bytes of CBOR.

use control_protocol::{MAX_MESSAGE_BYTES, Refusal, RefusalKind, Reply, codec};
use rustix::io::Errno;
use rustix::net::{SendFlags, send};
use std::io;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt, Interest};
use tokio::net::UnixStream;

/// Time limit for the transfer of one message.
const TRANSFER: Duration = Duration::from_secs(5);
/// Period of the look for a hang-up after something has arrived. Chosen.
const HANG_UP_PERIOD: Duration = Duration::from_millis(100);

/// Waits for the next request and returns its length, bytes; `None` at the end of the connection,
/// also when its peer says nothing for too long. A request that is too long is refused, and ends
/// the connection: the rest of the stream cannot be trusted.
pub(super) async fn next_length(
    stream: &mut UnixStream,
    idle_limit: Duration,
) -> io::Result<Option<usize>> {
    let mut length = [0; 4];
    match tokio::time::timeout(idle_limit, stream.read_exact(&mut length)).await {
        Ok(Ok(_)) => {}
        Ok(Err(error)) if error.kind() == io::ErrorKind::UnexpectedEof => {
            return Ok(None);
        }
        Ok(Err(error)) => return Err(error),
        Err(_) => return Ok(None),
    }
    let length = u32::from_le_bytes(length) as usize;
    if length <= MAX_MESSAGE_BYTES {
        return Ok(Some(length));
    }
    let sentence = format!("a request may have at most {MAX_MESSAGE_BYTES} bytes");
    let refusal = Refusal::new(RefusalKind::Invalid, sentence);
    write_reply(stream, &Reply::Refused(refusal)).await?;
    Ok(None)
}

/// Reads the bytes of a request.
pub(super) async fn read_bytes(stream: &mut UnixStream, length: usize) -> io::Result<Vec<u8>> {
    let mut bytes = vec![0; length];
    tokio::time::timeout(TRANSFER, stream.read_exact(&mut bytes)).await??;
    Ok(bytes)
}

/// Writes a reply.
pub(super) async fn write_reply(stream: &mut UnixStream, reply: &Reply) -> io::Result<()> {
    let bytes = codec::encode_reply(reply);
    tokio::time::timeout(TRANSFER, write_message(stream, &bytes)).await?
}

/// Writes a message.
pub(super) async fn write_message(stream: &mut UnixStream, bytes: &[u8]) -> io::Result<()> {
    stream.write_all(&codec::framed(bytes)).await
}

/// Reads the reply to a request.
pub(super) async fn read_reply(stream: &mut UnixStream) -> io::Result<Reply> {
    let mut length = [0; 4];
    stream.read_exact(&mut length).await?;
    let length = u32::from_le_bytes(length) as usize;
    if length > MAX_MESSAGE_BYTES {
        let sentence = format!("the reply has {length} bytes, more than a message may have");
        return Err(io::Error::other(sentence));
    }
    let mut bytes = vec![0; length];
    stream.read_exact(&mut bytes).await?;
    Ok(codec::decode_reply(&bytes))
}

/// Waits until the peer has closed the connection. A peer that only ended its own writing still
/// waits for a reply.
pub(super) async fn hung_up(stream: &UnixStream) {
    loop {
        if stream.ready(Interest::READABLE).await.is_err() || is_hung_up(stream) {
            return;
        }
        // Readable for another reason: the next request, or the end of the peer's writing.
        tokio::time::sleep(HANG_UP_PERIOD).await;
    }
}

fn is_hung_up(stream: &UnixStream) -> bool {
    let sent = send(stream, &[], SendFlags::NOSIGNAL | SendFlags::DONTWAIT);
    matches!(sent, Err(Errno::PIPE | Errno::CONNRESET))
}
