//! The two ends of a system.

use crate::log::Log;
use crate::payload::Fill;
use crate::place::Place;
use crate::plan::{System, Task};
use crate::{by_zenoh, iceoryx2_raw, ours, ros_like, unix_socket};
use iceoryx2::prelude::{ipc, ipc_threadsafe};

/// The end that sends.
pub trait Sender {
    /// Waits until the receiver is connected, where there is something to wait for.
    fn connect(&mut self) {}

    /// Makes a message: gets memory for it, fills it, stamps it, sends it.
    fn send(&mut self, number: u64, fill: &mut Fill);
}

/// The end that receives.
pub trait Receiver {
    /// Notes every message, up to the last.
    fn receive(self: Box<Self>, log: Log) -> Log;
}

pub fn sender(task: &Task, place: &Place) -> Box<dyn Sender> {
    match task.system {
        System::Iceoryx2 | System::Iceoryx2Thread => {
            Box::new(iceoryx2_raw::Sending::<ipc::Service>::new(task, place))
        }
        System::Iceoryx2Threadsafe => Box::new(
            iceoryx2_raw::Sending::<ipc_threadsafe::Service>::new(task, place),
        ),
        System::Channel => Box::new(ours::Sending::new(task, place)),
        System::UnixSocket => Box::new(unix_socket::Sending::new(task, place)),
        System::Zenoh => Box::new(by_zenoh::Sending::new(task, place)),
        System::RosLike => Box::new(ros_like::Sending::new(task, place)),
    }
}

pub fn receiver(task: &Task, place: &Place) -> Box<dyn Receiver> {
    match task.system {
        System::Iceoryx2 | System::Iceoryx2Thread => {
            Box::new(iceoryx2_raw::Receiving::<ipc::Service>::new(task, place))
        }
        System::Iceoryx2Threadsafe => Box::new(
            iceoryx2_raw::Receiving::<ipc_threadsafe::Service>::new(task, place),
        ),
        System::Channel => Box::new(ours::Receiving::new(task, place)),
        System::UnixSocket => Box::new(unix_socket::Receiving::new(task, place)),
        System::Zenoh => Box::new(by_zenoh::Receiving::new(place)),
        System::RosLike => Box::new(ros_like::Receiving::new(place)),
    }
}
