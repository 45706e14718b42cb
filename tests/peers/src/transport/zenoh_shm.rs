//! zenoh, with the messages in shared memory and their descriptors over a Unix
//! socket: no scouting, nothing but the two sessions.

use crate::log::Log;
use crate::payload::{Fill, Header};
use crate::place::Place;
use crate::plan::Task;
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

const KEY: &str = "cloud";
/// As many messages as a topic of ours holds for one subscriber, and two loans.
const N_MESSAGES: usize = 10;
/// The largest chunk is a little larger than what is asked for.
const EXTRA_BYTES: usize = 1 << 20;
const HEADER_BYTES: usize = size_of::<Header>();
/// How often is asked whether the receiver has come.
const LOOK: Duration = Duration::from_millis(2);

fn session(endpoint_key: &str, place: &Place) -> Session {
    let endpoint = format!("[\"unixsock-stream/{}\"]", place.socket().display());
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

pub struct Sending {
    publisher: Publisher<'static>,
    memory: ShmProvider<PosixShmProviderBackend>,
    layout: MemoryLayout,
    _session: Session,
}

impl Sending {
    pub fn new(task: &Task, place: &Place) -> Self {
        let session = session("listen/endpoints", place);
        let publisher = session
            .declare_publisher(KEY)
            .congestion_control(CongestionControl::Block)
            .express(true)
            .wait();
        let message_bytes = HEADER_BYTES + task.payload_bytes;
        let layout = |n_bytes| MemoryLayout::new(n_bytes, AllocAlignment::for_type::<Header>());
        let all = layout(N_MESSAGES * message_bytes + EXTRA_BYTES).expect("a layout");
        let memory = ShmProviderBuilder::default_backend(all);
        Self {
            publisher: publisher.expect("a publisher"),
            memory: memory.wait().expect("shared memory"),
            layout: layout(message_bytes).expect("a layout"),
            _session: session,
        }
    }

    fn loan(&self) -> ZShmMut {
        let loan = self.memory.alloc(self.layout);
        let loan = loan.with_policy::<BlockOn<GarbageCollect>>();
        loan.wait().expect("a loan")
    }
}

impl ports::Sender for Sending {
    fn connect(&mut self) {
        let is_there = || self.publisher.matching_status().wait().expect("a status");
        while !is_there().matching() {
            std::thread::sleep(LOOK);
        }
    }

    fn send(&mut self, number: u64, fill: &mut Fill) {
        let mut loan = self.loan();
        let (header, payload) = loan.split_at_mut(HEADER_BYTES);
        fill.write(number, payload);
        let filled: &mut Header = bytemuck::from_bytes_mut(header);
        *filled = Header::new(number, payload.len());
        filled.sent_ns = clock::now_ns();
        self.publisher.put(ZBytes::from(loan)).wait().expect("sent");
    }
}

pub struct Receiving {
    /// To the thread of zenoh that calls back.
    begin: mpsc::Sender<Log>,
    /// From it.
    end: mpsc::Receiver<Log>,
    _subscriber: Subscriber<()>,
    _session: Session,
}

impl Receiving {
    pub fn new(place: &Place) -> Self {
        let session = session("connect/endpoints", place);
        let (begin, begun) = mpsc::channel::<Log>();
        let (ended, end) = mpsc::channel();
        // The thread that calls back must be able to share it, and never does.
        let mut begun = Mutex::new(begun);
        let mut log = None;
        let receive = move |sample: Sample| {
            let mut current = log.take().unwrap_or_else(|| next(&mut begun));
            if note(&mut current, sample.payload()) {
                ended.send(current).expect("who waits");
            } else {
                log = Some(current);
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

fn next(begun: &mut Mutex<mpsc::Receiver<Log>>) -> Log {
    let begun = begun.get_mut().expect("nobody has panicked");
    begun.recv().expect("a log")
}

/// Panics when the message is not where it was written.
fn note(log: &mut Log, message: &ZBytes) -> bool {
    let message = message.as_shm().expect("a message in shared memory");
    let (header, payload) = message.split_at(HEADER_BYTES);
    let header: &Header = bytemuck::from_bytes(header);
    log.note(header.number, header.sent_ns, payload)
}

impl ports::Receiver for Receiving {
    fn receive(self: Box<Self>, log: Log) -> Log {
        self.begin.send(log).expect("a subscriber");
        self.end.recv().expect("a log")
    }
}
