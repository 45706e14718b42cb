//! Emulation of a ROS 2 middleware without shared memory: serialisation, datagrams, copies.
//!
//! A cloud is serialised, fragmented into datagrams, copied through the kernel, reassembled and
//! deserialised. There is no discovery, no acknowledgement and no executor.

use crate::benchmark_case::BenchmarkCase;
use crate::fragmentation::{DATAGRAM_BYTES, Reassembler, fragments};
use crate::ipc_namespace::IpcNamespace;
use crate::latency_recorder::LatencyRecorder;
use crate::payload::PayloadWriter;
use crate::point_cloud2::PointCloud2;
use crate::{clock, ports};
use rustix::net::{SendAncillaryBuffer, SendFlags, sendmsg};
use std::io::IoSlice;
use std::os::unix::net::UnixDatagram;
use std::path::PathBuf;

/// Sending port with a Unix datagram socket.
pub struct RosLikeSender {
    socket: UnixDatagram,
    peer: PathBuf,
    message: PointCloud2,
}

impl RosLikeSender {
    pub fn new(case: &BenchmarkCase, namespace: &IpcNamespace) -> Self {
        Self {
            socket: UnixDatagram::unbound().expect("a socket"),
            peer: namespace.socket(),
            message: PointCloud2::with_data_bytes(case.payload_bytes),
        }
    }
}

impl ports::Sender for RosLikeSender {
    fn connect(&mut self) {
        self.socket.connect(&self.peer).expect("the receiver");
    }

    fn send(&mut self, number: u64, writer: &mut PayloadWriter) {
        writer.write(number, &mut self.message.data);
        self.message.set_stamp(clock::now_ns());
        let bytes = self.message.serialize();
        for (head, body) in fragments(number, &bytes) {
            let parts = [IoSlice::new(bytemuck::bytes_of(&head)), IoSlice::new(body)];
            let mut nothing = SendAncillaryBuffer::default();
            sendmsg(&self.socket, &parts, &mut nothing, SendFlags::empty()).expect("sent");
        }
    }
}

/// Receiving port with a Unix datagram socket.
pub struct RosLikeReceiver {
    socket: UnixDatagram,
}

impl RosLikeReceiver {
    pub fn new(namespace: &IpcNamespace) -> Self {
        Self {
            socket: UnixDatagram::bind(namespace.socket()).expect("a socket"),
        }
    }
}

impl ports::Receiver for RosLikeReceiver {
    fn receive(self: Box<Self>, mut recorder: LatencyRecorder) -> LatencyRecorder {
        let mut reassembler = Reassembler::default();
        let mut datagram = vec![0; DATAGRAM_BYTES];
        loop {
            let n_bytes = self.socket.recv(&mut datagram).expect("a datagram");
            let Some((number, bytes)) = reassembler.take(&datagram[..n_bytes]) else {
                continue;
            };
            let message = PointCloud2::deserialize(bytes).expect("a whole message");
            if recorder.record(number, message.stamp(), &message.data) {
                return recorder;
            }
        }
    }
}
