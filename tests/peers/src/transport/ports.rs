//! Sender and receiver ports: common interface of the transports under test.

use crate::benchmark_case::{BenchmarkCase, System};
use crate::ipc_namespace::IpcNamespace;
use crate::latency_recorder::LatencyRecorder;
use crate::payload::PayloadWriter;
use crate::{iceoryx2_raw, ros_like, tabula_channel, unix_socket, zenoh_shm};
use iceoryx2::prelude::{ipc, ipc_threadsafe};

/// Sending port.
pub trait Sender {
    /// Waits until the receiver is connected, for systems with connections.
    fn connect(&mut self) {}

    /// Sends a message: gets its memory, writes the payload, stamps and sends it.
    fn send(&mut self, number: u64, writer: &mut PayloadWriter);
}

/// Receiving port.
pub trait Receiver {
    /// Receives and records all messages, up to the last.
    fn receive(self: Box<Self>, recorder: LatencyRecorder) -> LatencyRecorder;
}

/// Sending port of a case.
pub fn sender(case: &BenchmarkCase, namespace: &IpcNamespace) -> Box<dyn Sender> {
    match case.system {
        System::Iceoryx2 | System::Iceoryx2Thread => Box::new(iceoryx2_raw::Iceoryx2Sender::<
            ipc::Service,
        >::new(case, namespace)),
        System::Iceoryx2Threadsafe => {
            Box::new(iceoryx2_raw::Iceoryx2Sender::<ipc_threadsafe::Service>::new(case, namespace))
        }
        System::Channel => Box::new(tabula_channel::ChannelSender::new(case, namespace)),
        System::UnixSocket => Box::new(unix_socket::SocketSender::new(case, namespace)),
        System::Zenoh => Box::new(zenoh_shm::ZenohSender::new(case, namespace)),
        System::RosLike => Box::new(ros_like::RosLikeSender::new(case, namespace)),
    }
}

/// Receiving port of a case.
pub fn receiver(case: &BenchmarkCase, namespace: &IpcNamespace) -> Box<dyn Receiver> {
    match case.system {
        System::Iceoryx2 | System::Iceoryx2Thread => Box::new(iceoryx2_raw::Iceoryx2Receiver::<
            ipc::Service,
        >::new(case, namespace)),
        System::Iceoryx2Threadsafe => Box::new(iceoryx2_raw::Iceoryx2Receiver::<
            ipc_threadsafe::Service,
        >::new(case, namespace)),
        System::Channel => Box::new(tabula_channel::ChannelReceiver::new(case, namespace)),
        System::UnixSocket => Box::new(unix_socket::SocketReceiver::new(case, namespace)),
        System::Zenoh => Box::new(zenoh_shm::ZenohReceiver::new(namespace)),
        System::RosLike => Box::new(ros_like::RosLikeReceiver::new(namespace)),
    }
}
