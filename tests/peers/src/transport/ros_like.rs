//! What a ROS 2 middleware does with a cloud when it does not share memory:
//! serialise, cut into datagrams, copy through the kernel, put together,
//! deserialise. It is no ROS: no discovery, no acknowledgements, no executor.

use crate::fragments::{Assembly, DATAGRAM_BYTES, fragments};
use crate::log::Log;
use crate::payload::Fill;
use crate::place::Place;
use crate::plan::Task;
use crate::point_cloud2::PointCloud2;
use crate::{clock, ports};
use rustix::net::{SendAncillaryBuffer, SendFlags, sendmsg};
use std::io::IoSlice;
use std::os::unix::net::UnixDatagram;
use std::path::PathBuf;

pub struct Sending {
    socket: UnixDatagram,
    peer: PathBuf,
    message: PointCloud2,
}

impl Sending {
    pub fn new(task: &Task, place: &Place) -> Self {
        Self {
            socket: UnixDatagram::unbound().expect("a socket"),
            peer: place.socket(),
            message: PointCloud2::of_bytes(task.payload_bytes),
        }
    }
}

impl ports::Sender for Sending {
    fn connect(&mut self) {
        self.socket.connect(&self.peer).expect("the receiver");
    }

    fn send(&mut self, number: u64, fill: &mut Fill) {
        fill.write(number, &mut self.message.data);
        self.message.set_stamp(clock::now_ns());
        let bytes = self.message.serialised();
        for (head, body) in fragments(number, &bytes) {
            let parts = [IoSlice::new(bytemuck::bytes_of(&head)), IoSlice::new(body)];
            let mut nothing = SendAncillaryBuffer::default();
            sendmsg(&self.socket, &parts, &mut nothing, SendFlags::empty()).expect("sent");
        }
    }
}

pub struct Receiving {
    socket: UnixDatagram,
}

impl Receiving {
    pub fn new(place: &Place) -> Self {
        Self {
            socket: UnixDatagram::bind(place.socket()).expect("a socket"),
        }
    }
}

impl ports::Receiver for Receiving {
    fn receive(self: Box<Self>, mut log: Log) -> Log {
        let mut assembly = Assembly::default();
        let mut datagram = vec![0; DATAGRAM_BYTES];
        loop {
            let n_bytes = self.socket.recv(&mut datagram).expect("a datagram");
            let Some((number, bytes)) = assembly.take(&datagram[..n_bytes]) else {
                continue;
            };
            let message = PointCloud2::deserialised(bytes).expect("a whole message");
            if log.note(number, message.stamp(), &message.data) {
                return log;
            }
        }
    }
}
