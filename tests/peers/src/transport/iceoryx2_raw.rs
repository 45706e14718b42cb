//! iceoryx2 without anything of ours: the same types, limits and configuration.

use crate::log::Log;
use crate::place::Place;
use crate::plan::{System, Task};
use crate::{clock, payload::Fill, ports, reactor};
use channel::topic::{CameraCloud, Topic};
use iceoryx2::port::listener::Listener;
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::prelude::*;
use iceoryx2::service::Service;
use iceoryx2::service::port_factory::{event, publish_subscribe};
use message::{CloudPoint, FrameHeader};
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, RawFd};
use tokio::io::unix::AsyncFd;

fn node<S: Service>(place: &Place) -> Node<S> {
    set_log_level(LogLevel::Error);
    let root = Path::new(place.root_of_iceoryx2().as_os_str().as_encoded_bytes());
    let prefix = FileName::new(place.prefix_of_iceoryx2().as_bytes());
    let mut config = Config::default();
    config.global.set_root_path(&root.expect("a path"));
    config.global.prefix = prefix.expect("a file name");
    config.global.node.cleanup_dead_nodes_on_destruction = false;
    let publish_subscribe = &mut config.defaults.publish_subscribe;
    publish_subscribe.subscriber_expired_connection_buffer = 4;
    NodeBuilder::new()
        .config(&config)
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create()
        .expect("a node")
}

fn name() -> ServiceName {
    "cloud".try_into().expect("a name")
}

type Clouds<S> = publish_subscribe::PortFactory<S, [CloudPoint], FrameHeader>;

fn clouds<S: Service>(node: &Node<S>) -> Clouds<S> {
    let limits = CameraCloud::LIMITS;
    node.service_builder(&name())
        .publish_subscribe::<[CloudPoint]>()
        .user_header::<FrameHeader>()
        .max_publishers(limits.publishers)
        .max_subscribers(limits.subscribers)
        .max_nodes(limits.publishers + limits.subscribers)
        .subscriber_max_buffer_size(limits.buffer)
        .subscriber_max_borrowed_samples(limits.borrowed)
        .history_size(limits.history)
        .enable_safe_overflow(true)
        .open_or_create()
        .expect("a service")
}

fn wake_ups<S: Service>(node: &Node<S>) -> event::PortFactory<S> {
    let events = node.service_builder(&name()).event();
    events.open_or_create().expect("an event")
}

pub struct Sending<S: Service> {
    publisher: Publisher<S, [CloudPoint], FrameHeader>,
    /// None when the receiver polls.
    notifier: Option<Notifier<S>>,
    n_points: usize,
    _node: Node<S>,
}

impl<S: Service> Sending<S> {
    pub fn new(task: &Task, place: &Place) -> Self {
        let node = node(place);
        let publisher = clouds(&node)
            .publisher_builder()
            .initial_max_slice_len(CameraCloud::MAX_ITEMS)
            .max_loaned_samples(CameraCloud::LIMITS.loaned)
            .backpressure_strategy(BackpressureStrategy::DiscardData)
            .create()
            .expect("a publisher");
        let notifier = || wake_ups(&node).notifier_builder().create();
        Self {
            publisher,
            notifier: (!task.is_polled()).then(|| notifier().expect("a notifier")),
            n_points: task.n_points(),
            _node: node,
        }
    }
}

impl<S: Service> ports::Sender for Sending<S> {
    fn send(&mut self, number: u64, fill: &mut Fill) {
        let sample = self.publisher.loan_slice_uninit(self.n_points);
        // SAFETY: the memory is a mapped file, which the kernel hands out zeroed;
        // any bytes are points.
        let mut sample = unsafe { sample.expect("a loan").assume_init() };
        fill.write(number, bytemuck::cast_slice_mut(sample.payload_mut()));
        let header = sample.user_header_mut();
        header.sequence = number;
        header.published_stamp_ns = clock::now_ns();
        sample.send().expect("sent");
        if let Some(notifier) = &self.notifier {
            notifier.notify().expect("woken");
        }
    }
}

pub struct Receiving<S: Service> {
    subscriber: Subscriber<S, [CloudPoint], FrameHeader>,
    wait: Wait<S>,
    _node: Node<S>,
}

/// How the receiver waits.
enum Wait<S: Service> {
    Polled,
    Task(Descriptor<S>),
    Thread(Listener<S>),
}

impl<S: Service> Receiving<S> {
    pub fn new(task: &Task, place: &Place) -> Self {
        let node = node(place);
        let subscriber = clouds(&node)
            .subscriber_builder()
            .buffer_size(CameraCloud::LIMITS.buffer)
            .create();
        let listener = || {
            let listener = wake_ups(&node).listener_builder().create();
            listener.expect("a listener")
        };
        let wait = match task.system {
            _ if task.is_polled() => Wait::Polled,
            System::Iceoryx2Thread => Wait::Thread(listener()),
            _ => Wait::Task(Descriptor(listener())),
        };
        Self {
            subscriber: subscriber.expect("a subscriber"),
            wait,
            _node: node,
        }
    }
}

/// Notes what is there; tells whether the last message was.
fn drain<S: Service>(subscriber: &Subscriber<S, [CloudPoint], FrameHeader>, log: &mut Log) -> bool {
    while let Some(sample) = subscriber.receive().expect("an answer") {
        let header = sample.user_header();
        let payload = bytemuck::cast_slice(sample.payload());
        if log.note(header.sequence, header.published_stamp_ns, payload) {
            return true;
        }
    }
    false
}

impl<S: Service> ports::Receiver for Receiving<S>
where
    Listener<S>: FileDescriptorBased,
{
    fn receive(self: Box<Self>, mut log: Log) -> Log {
        let Self {
            subscriber, wait, ..
        } = *self;
        match wait {
            Wait::Polled => {
                while !drain(&subscriber, &mut log) {
                    std::hint::spin_loop();
                }
            }
            Wait::Thread(listener) => {
                while !drain(&subscriber, &mut log) {
                    listener.blocking_wait(|_| {}).expect("a wake-up");
                }
            }
            Wait::Task(descriptor) => reactor::runtime().block_on(async {
                // SAFETY: `Descriptor` gives the number of the one descriptor that its
                // listener keeps open until it is dropped.
                let listener = unsafe { AsyncFd::register(descriptor) };
                let listener = listener.expect("a descriptor");
                while !drain(&subscriber, &mut log) {
                    woken(&listener).await;
                }
            }),
        }
        log
    }
}

/// The listener's descriptor as tokio wants it.
struct Descriptor<S: Service>(Listener<S>);

impl<S: Service> AsFd for Descriptor<S>
where
    Listener<S>: FileDescriptorBased,
{
    fn as_fd(&self) -> BorrowedFd<'_> {
        // SAFETY: the number is not kept beyond the borrow below.
        let number = unsafe { self.0.file_descriptor().native_handle() };
        // SAFETY: the listener owns the open descriptor and outlives the borrow.
        unsafe { BorrowedFd::borrow_raw(number) }
    }
}

impl<S: Service> AsRawFd for Descriptor<S>
where
    Listener<S>: FileDescriptorBased,
{
    fn as_raw_fd(&self) -> RawFd {
        self.as_fd().as_raw_fd()
    }
}

async fn woken<S: Service>(listener: &AsyncFd<Descriptor<S>>)
where
    Listener<S>: FileDescriptorBased,
{
    loop {
        let mut ready = listener.readable().await.expect("a reactor");
        let n_wake_ups = ready.get_inner().0.try_wait(|_| {}).expect("a listener");
        ready.clear_ready();
        if n_wake_ups > 0 {
            return;
        }
    }
}
