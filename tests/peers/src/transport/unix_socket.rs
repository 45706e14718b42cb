//! A stream over a Unix socket: header and payload are copied into the kernel and
//! out of it.

use crate::log::Log;
use crate::payload::{Fill, Header};
use crate::place::Place;
use crate::plan::Task;
use crate::{clock, ports};
use std::io::{self, ErrorKind, IoSlice, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};

pub struct Sending {
    listener: UnixListener,
    stream: Option<UnixStream>,
    payload: Vec<u8>,
}

impl Sending {
    pub fn new(task: &Task, place: &Place) -> Self {
        Self {
            listener: UnixListener::bind(place.socket()).expect("a socket"),
            stream: None,
            payload: vec![0; task.payload_bytes],
        }
    }
}

impl ports::Sender for Sending {
    fn connect(&mut self) {
        let (stream, _) = self.listener.accept().expect("a receiver");
        self.stream = Some(stream);
    }

    fn send(&mut self, number: u64, fill: &mut Fill) {
        fill.write(number, &mut self.payload);
        let stream = self.stream.as_mut().expect("connected");
        let mut header = Header::new(number, self.payload.len());
        header.sent_ns = clock::now_ns();
        write(stream, bytemuck::bytes_of(&header), &self.payload).expect("sent");
    }
}

/// Writes both in as few calls as it takes.
fn write(stream: &mut UnixStream, header: &[u8], payload: &[u8]) -> io::Result<()> {
    let n_written = stream.write_vectored(&[IoSlice::new(header), IoSlice::new(payload)])?;
    stream.write_all(header.get(n_written..).unwrap_or_default())?;
    stream.write_all(&payload[n_written.saturating_sub(header.len())..])
}

pub struct Receiving {
    stream: UnixStream,
}

impl Receiving {
    pub fn new(task: &Task, place: &Place) -> Self {
        let stream = UnixStream::connect(place.socket()).expect("the sender");
        let spins = stream.set_nonblocking(task.is_polled());
        spins.expect("a socket");
        Self { stream }
    }
}

/// Fills the buffer; asks again when a socket that does not block has nothing.
fn read_whole(stream: &mut impl Read, mut buffer: &mut [u8]) -> io::Result<()> {
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

impl ports::Receiver for Receiving {
    fn receive(mut self: Box<Self>, mut log: Log) -> Log {
        let mut header = Header::new(0, 0);
        let mut payload = Vec::new();
        loop {
            let stream = &mut self.stream;
            read_whole(stream, bytemuck::bytes_of_mut(&mut header)).expect("a header");
            payload.resize(header.payload_bytes as usize, 0);
            read_whole(stream, &mut payload).expect("a payload");
            if log.note(header.number, header.sent_ns, &payload) {
                return log;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_in_pieces_is_read_whole() {
        let (mut sender, mut receiver) = UnixStream::pair().unwrap();
        receiver.set_nonblocking(true).unwrap();
        let payload: Vec<u8> = (0..1_000_000).map(|i| i as u8).collect();
        let expected = payload.clone();
        let writer = std::thread::spawn(move || write(&mut sender, b"header", &payload));
        let mut buffer = vec![0; 6 + expected.len()];
        read_whole(&mut receiver, &mut buffer).unwrap();
        writer.join().unwrap().unwrap();
        assert_eq!(buffer.split_at(6), (&b"header"[..], &expected[..]));
        let ended = read_whole(&mut receiver, &mut buffer).unwrap_err();
        assert_eq!(ended.kind(), ErrorKind::UnexpectedEof);
    }
}
