//! Unix stream socket: header and payload are copied into the kernel and out of it.

use crate::benchmark_case::BenchmarkCase;
use crate::ipc_namespace::IpcNamespace;
use crate::latency_recorder::LatencyRecorder;
use crate::payload::{MessageHeader, PayloadWriter};
use crate::{clock, ports};
use std::io::{self, ErrorKind, IoSlice, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};

/// Sending port: the listening end of the socket.
pub struct SocketSender {
    listener: UnixListener,
    stream: Option<UnixStream>,
    payload: Vec<u8>,
}

impl SocketSender {
    pub fn new(case: &BenchmarkCase, namespace: &IpcNamespace) -> Self {
        Self {
            listener: UnixListener::bind(namespace.socket()).expect("a socket"),
            stream: None,
            payload: vec![0; case.payload_bytes],
        }
    }
}

impl ports::Sender for SocketSender {
    fn connect(&mut self) {
        let (stream, _) = self.listener.accept().expect("a receiver");
        self.stream = Some(stream);
    }

    fn send(&mut self, number: u64, writer: &mut PayloadWriter) {
        writer.write(number, &mut self.payload);
        let stream = self.stream.as_mut().expect("connected");
        let mut header = MessageHeader::new(number, self.payload.len());
        header.sent_ns = clock::now_ns();
        write(stream, bytemuck::bytes_of(&header), &self.payload).expect("sent");
    }
}

/// Vectored write of header and payload, in one call if the socket accepts all.
fn write(stream: &mut UnixStream, header: &[u8], payload: &[u8]) -> io::Result<()> {
    let n_written = stream.write_vectored(&[IoSlice::new(header), IoSlice::new(payload)])?;
    stream.write_all(header.get(n_written..).unwrap_or_default())?;
    stream.write_all(&payload[n_written.saturating_sub(header.len())..])
}

/// Receiving port: the connecting end of the socket.
pub struct SocketReceiver {
    stream: UnixStream,
}

impl SocketReceiver {
    pub fn new(case: &BenchmarkCase, namespace: &IpcNamespace) -> Self {
        let stream = UnixStream::connect(namespace.socket()).expect("the sender");
        let spins = stream.set_nonblocking(case.is_polled());
        spins.expect("a socket");
        Self { stream }
    }
}

/// Fills the buffer; spins while a non-blocking socket has no data.
///
/// # Errors
/// If the stream ends early or fails.
fn read_exact_spinning(stream: &mut impl Read, mut buffer: &mut [u8]) -> io::Result<()> {
    while !buffer.is_empty() {
        match stream.read(buffer) {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Ok(n_read) => buffer = &mut buffer[n_read..],
            Err(error) if error.kind() == ErrorKind::WouldBlock => std::hint::spin_loop(),
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

impl ports::Receiver for SocketReceiver {
    fn receive(mut self: Box<Self>, mut recorder: LatencyRecorder) -> LatencyRecorder {
        let mut header = MessageHeader::new(0, 0);
        let mut payload = Vec::new();
        loop {
            let stream = &mut self.stream;
            read_exact_spinning(stream, bytemuck::bytes_of_mut(&mut header)).expect("a header");
            payload.resize(header.payload_bytes as usize, 0);
            read_exact_spinning(stream, &mut payload).expect("a payload");
            if recorder.record(header.number, header.sent_ns, &payload) {
                return recorder;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn partial_reads_fill_the_whole_buffer() {
        let (mut sender, mut receiver) = UnixStream::pair().unwrap();
        receiver.set_nonblocking(true).unwrap();
        let payload: Vec<u8> = (0..1_000_000).map(|i| i as u8).collect();
        let expected = payload.clone();
        let writer = std::thread::spawn(move || write(&mut sender, b"header", &payload));
        let mut buffer = vec![0; 6 + expected.len()];
        read_exact_spinning(&mut receiver, &mut buffer).unwrap();
        writer.join().unwrap().unwrap();
        assert_eq!(buffer.split_at(6), (&b"header"[..], &expected[..]));
        let ended = read_exact_spinning(&mut receiver, &mut buffer).unwrap_err();
        assert_eq!(ended.kind(), ErrorKind::UnexpectedEof);
    }
}
