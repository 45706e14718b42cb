//! zenoh peers: messages in shared memory, their descriptors over a Unix socket, no scouting.

use crate::benchmark_case::BenchmarkCase;
use crate::ipc_namespace::IpcNamespace;
use crate::latency_recorder::LatencyRecorder;
use crate::payload::{MessageHeader, PayloadWriter};
use crate::{clock, ports};
use std::sync::{Mutex, mpsc};
use std::time::Duration;
use zenoh::bytes::ZBytes;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::CongestionControl;
use zenoh::sample::Sample;
use zenoh::shm::{
    AllocAlignment, BlockOn, GarbageCollect, MemoryLayout, PosixShmProviderBackend, ShmProvider,
    ShmProviderBuilder, ZShmMut,
};
use zenoh::{Config, Session, Wait};

/// Key expression of the topic.
const KEY: &str = "cloud";
/// Capacity of the shared memory, in messages: the buffer of one subscriber of our topic, and two
/// loans.
const N_MESSAGES: usize = 10;
/// Margin for the allocator, bytes: the largest chunk is a little larger than requested.
const ALLOCATOR_SLACK_BYTES: usize = 1 << 20;
/// Size of the message header, bytes.
const HEADER_BYTES: usize = size_of::<MessageHeader>();
/// Polling period while waiting for a matching subscriber.
const MATCHING_POLL_INTERVAL: Duration = Duration::from_millis(2);

/// Opens a peer session whose only endpoint is the Unix socket.
fn session(endpoint_key: &str, namespace: &IpcNamespace) -> Session {
    let endpoint = format!("[\"unixsock-stream/{}\"]", namespace.socket().display());
    let settings = [
        ("mode", "\"peer\""),
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
        ("listen/endpoints", "[]"),
        ("transport/shared_memory/mode", "\"init\""),
        (endpoint_key, &endpoint),
    ];
    let mut config = Config::default();
    for (key, value) in settings {
        config.insert_json5(key, value).expect("a setting");
    }
    zenoh::open(config).wait().expect("a session")
}

/// Publisher with its shared-memory provider.
pub struct ZenohSender {
    publisher: Publisher<'static>,
    memory: ShmProvider<PosixShmProviderBackend>,
    layout: MemoryLayout,
    _session: Session,
}

impl ZenohSender {
    pub fn new(case: &BenchmarkCase, namespace: &IpcNamespace) -> Self {
        let session = session("listen/endpoints", namespace);
        let publisher = session
            .declare_publisher(KEY)
            .congestion_control(CongestionControl::Block)
            .express(true)
            .wait();
        let message_bytes = HEADER_BYTES + case.payload_bytes;
        let layout =
            |n_bytes| MemoryLayout::new(n_bytes, AllocAlignment::for_type::<MessageHeader>());
        let all = layout(N_MESSAGES * message_bytes + ALLOCATOR_SLACK_BYTES).expect("a layout");
        let memory = ShmProviderBuilder::default_backend(all);
        Self {
            publisher: publisher.expect("a publisher"),
            memory: memory.wait().expect("shared memory"),
            layout: layout(message_bytes).expect("a layout"),
            _session: session,
        }
    }

    /// Allocates a shared-memory buffer; blocks until one is free.
    fn loan(&self) -> ZShmMut {
        let loan = self.memory.alloc(self.layout);
        let loan = loan.with_policy::<BlockOn<GarbageCollect>>();
        loan.wait().expect("a loan")
    }
}

impl ports::Sender for ZenohSender {
    fn connect(&mut self) {
        let status = || self.publisher.matching_status().wait().expect("a status");
        while !status().matching() {
            std::thread::sleep(MATCHING_POLL_INTERVAL);
        }
    }

    fn send(&mut self, number: u64, writer: &mut PayloadWriter) {
        let mut loan = self.loan();
        let (header, payload) = loan.split_at_mut(HEADER_BYTES);
        writer.write(number, payload);
        let filled: &mut MessageHeader = bytemuck::from_bytes_mut(header);
        *filled = MessageHeader::new(number, payload.len());
        filled.sent_ns = clock::now_ns();
        self.publisher.put(ZBytes::from(loan)).wait().expect("sent");
    }
}

/// Subscriber with a callback on zenoh's own thread.
pub struct ZenohReceiver {
    /// Channel of empty recorders to the callback.
    begin: mpsc::Sender<LatencyRecorder>,
    /// Channel of full recorders from the callback.
    end: mpsc::Receiver<LatencyRecorder>,
    _subscriber: Subscriber<()>,
    _session: Session,
}

impl ZenohReceiver {
    pub fn new(namespace: &IpcNamespace) -> Self {
        let session = session("connect/endpoints", namespace);
        let (begin, begun) = mpsc::channel::<LatencyRecorder>();
        let (ended, end) = mpsc::channel();
        // The callback must be `Sync`; only one thread ever uses the channel.
        let mut begun = Mutex::new(begun);
        let mut recorder = None;
        let receive = move |sample: Sample| {
            let mut current = recorder.take().unwrap_or_else(|| next(&mut begun));
            if record(&mut current, sample.payload()) {
                ended.send(current).expect("a waiting receiver");
            } else {
                recorder = Some(current);
            }
        };
        let subscriber = session.declare_subscriber(KEY).callback_mut(receive).wait();
        Self {
            begin,
            end,
            _subscriber: subscriber.expect("a subscriber"),
            _session: session,
        }
    }
}

/// Waits for the next empty recorder.
fn next(begun: &mut Mutex<mpsc::Receiver<LatencyRecorder>>) -> LatencyRecorder {
    let begun = begun.get_mut().expect("a mutex without poison");
    begun.recv().expect("a recorder")
}

/// Records a message; `true` if it was the last.
///
/// # Panics
/// If the message is not in shared memory.
fn record(recorder: &mut LatencyRecorder, message: &ZBytes) -> bool {
    let message = message.as_shm().expect("a message in shared memory");
    let (header, payload) = message.split_at(HEADER_BYTES);
    let header: &MessageHeader = bytemuck::from_bytes(header);
    recorder.record(header.number, header.sent_ns, payload)
}

impl ports::Receiver for ZenohReceiver {
    fn receive(self: Box<Self>, recorder: LatencyRecorder) -> LatencyRecorder {
        self.begin.send(recorder).expect("a subscriber");
        self.end.recv().expect("a recorder")
    }
}
