//! Camera-cloud topic of `shared/platform/channel` under test.

use crate::benchmark_case::BenchmarkCase;
use crate::ipc_namespace::IpcNamespace;
use crate::latency_recorder::LatencyRecorder;
use crate::{clock, payload::PayloadWriter, ports, tokio_runtime};
use channel::topic::CameraCloud;
use channel::{Domain, Publisher, Received, Role, SharedMessage, Subscriber};
use tokio::runtime::Runtime;

/// Joins the domain of the namespace as a guest.
fn join(namespace: &IpcNamespace) -> Domain {
    Domain::join(&namespace.domain, &namespace.run_folder(), Role::Guest).expect("a domain")
}

/// Sending port with a topic publisher.
pub struct ChannelSender {
    publisher: Publisher<CameraCloud>,
    n_points: usize,
}

impl ChannelSender {
    pub fn new(case: &BenchmarkCase, namespace: &IpcNamespace) -> Self {
        let publisher = Publisher::new(&join(namespace)).expect("a publisher");
        Self {
            publisher,
            n_points: case.n_points(),
        }
    }
}

impl ports::Sender for ChannelSender {
    fn send(&mut self, number: u64, writer: &mut PayloadWriter) {
        let mut loan = self.publisher.loan(self.n_points).expect("a loan");
        writer.write(number, bytemuck::cast_slice_mut(loan.items_mut()));
        loan.header_mut().sequence = number;
        loan.header_mut().published_stamp_ns = clock::now_ns();
        self.publisher.send(loan).expect("sent");
    }
}

/// Receiving port with a topic subscriber.
pub struct ChannelReceiver {
    // Dropped before the runtime in which it is registered.
    subscriber: Subscriber<CameraCloud>,
    /// Runtime of a blocking receiver; `None` if it polls.
    runtime: Option<Runtime>,
}

impl ChannelReceiver {
    pub fn new(case: &BenchmarkCase, namespace: &IpcNamespace) -> Self {
        let domain = join(namespace);
        let runtime = (!case.is_polled()).then(tokio_runtime::runtime);
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

/// Records a message; `true` if it was the last.
fn record(recorder: &mut LatencyRecorder, frame: &SharedMessage<CameraCloud>) -> bool {
    let header = frame.header();
    let payload = bytemuck::cast_slice(frame.items());
    recorder.record(header.sequence, header.published_stamp_ns, payload)
}

impl ports::Receiver for ChannelReceiver {
    fn receive(mut self: Box<Self>, mut recorder: LatencyRecorder) -> LatencyRecorder {
        if let Some(runtime) = &self.runtime {
            runtime.block_on(async {
                while !record(
                    &mut recorder,
                    &self.subscriber.next().await.expect("a message"),
                ) {}
            });
            return recorder;
        }
        loop {
            match self.subscriber.receive().expect("an answer") {
                Received::Message(frame) if record(&mut recorder, &frame) => return recorder,
                Received::Message(_) => {}
                _ => std::hint::spin_loop(),
            }
        }
    }
}
