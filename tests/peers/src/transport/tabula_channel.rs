//! `shared/platform/channel`, the topic of the camera's clouds.

use crate::log::Log;
use crate::place::Place;
use crate::plan::Task;
use crate::{clock, payload::Fill, ports, reactor};
use channel::topic::CameraCloud;
use channel::{Domain, Publisher, Received, Role, SharedMessage, Subscriber};
use tokio::runtime::Runtime;

fn join(place: &Place) -> Domain {
    Domain::join(&place.domain, &place.run_folder(), Role::Guest).expect("a domain")
}

pub struct Sending {
    publisher: Publisher<CameraCloud>,
    n_points: usize,
}

impl Sending {
    pub fn new(task: &Task, place: &Place) -> Self {
        let publisher = Publisher::new(&join(place)).expect("a publisher");
        Self {
            publisher,
            n_points: task.n_points(),
        }
    }
}

impl ports::Sender for Sending {
    fn send(&mut self, number: u64, fill: &mut Fill) {
        let mut loan = self.publisher.loan(self.n_points).expect("a loan");
        fill.write(number, bytemuck::cast_slice_mut(loan.items_mut()));
        loan.header_mut().sequence = number;
        loan.header_mut().published_stamp_ns = clock::now_ns();
        self.publisher.send(loan).expect("sent");
    }
}

pub struct Receiving {
    // Before the runtime, in which it is registered.
    subscriber: Subscriber<CameraCloud>,
    /// None of who polls.
    runtime: Option<Runtime>,
}

impl Receiving {
    pub fn new(task: &Task, place: &Place) -> Self {
        let domain = join(place);
        let runtime = (!task.is_polled()).then(reactor::runtime);
        let subscriber = match &runtime {
            None => Subscriber::polled(&domain),
            Some(runtime) => {
                let _guard = runtime.enter();
                Subscriber::waiting(&domain)
            }
        };
        Self {
            subscriber: subscriber.expect("a subscriber"),
            runtime,
        }
    }
}

fn note(log: &mut Log, frame: &SharedMessage<CameraCloud>) -> bool {
    let header = frame.header();
    let payload = bytemuck::cast_slice(frame.items());
    log.note(header.sequence, header.published_stamp_ns, payload)
}

impl ports::Receiver for Receiving {
    fn receive(mut self: Box<Self>, mut log: Log) -> Log {
        if let Some(runtime) = &self.runtime {
            runtime.block_on(async {
                while !note(&mut log, &self.subscriber.next().await.expect("a message")) {}
            });
            return log;
        }
        loop {
            match self.subscriber.receive().expect("an answer") {
                Received::Message(frame) if note(&mut log, &frame) => return log,
                Received::Message(_) => {}
                _ => std::hint::spin_loop(),
            }
        }
    }
}
