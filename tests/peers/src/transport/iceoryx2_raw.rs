//! Bare iceoryx2 ports with the types, limits and configuration of our topic.

use crate::benchmark_case::{BenchmarkCase, System};
use crate::ipc_namespace::IpcNamespace;
use crate::latency_recorder::LatencyRecorder;
use crate::{clock, payload::PayloadWriter, ports, tokio_runtime};
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

/// Node in the namespace, without signal handling.
fn node<S: Service>(namespace: &IpcNamespace) -> Node<S> {
    set_log_level(LogLevel::Error);
    let root = Path::new(namespace.iceoryx2_root().as_os_str().as_encoded_bytes());
    let prefix = FileName::new(namespace.iceoryx2_prefix().as_bytes());
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

/// Name of the service.
fn name() -> ServiceName {
    "cloud".try_into().expect("a name")
}

/// Publish-subscribe service of point clouds.
type Clouds<S> = publish_subscribe::PortFactory<S, [CloudPoint], FrameHeader>;

/// Opens or creates the publish-subscribe service.
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

/// Opens or creates the event service that wakes the receiver.
fn wake_ups<S: Service>(node: &Node<S>) -> event::PortFactory<S> {
    let events = node.service_builder(&name()).event();
    events.open_or_create().expect("an event")
}

/// Sending port.
pub struct Iceoryx2Sender<S: Service> {
    publisher: Publisher<S, [CloudPoint], FrameHeader>,
    /// Notifier of a blocking receiver; `None` if it polls.
    notifier: Option<Notifier<S>>,
    n_points: usize,
    _node: Node<S>,
}

impl<S: Service> Iceoryx2Sender<S> {
    pub fn new(case: &BenchmarkCase, namespace: &IpcNamespace) -> Self {
        let node = node(namespace);
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
            notifier: (!case.is_polled()).then(|| notifier().expect("a notifier")),
            n_points: case.n_points(),
            _node: node,
        }
    }
}

impl<S: Service> ports::Sender for Iceoryx2Sender<S> {
    fn send(&mut self, number: u64, writer: &mut PayloadWriter) {
        let sample = self.publisher.loan_slice_uninit(self.n_points);
        // SAFETY: the memory is a mapped file, which the kernel provides zeroed; any bytes are
        // valid points.
        let mut sample = unsafe { sample.expect("a loan").assume_init() };
        writer.write(number, bytemuck::cast_slice_mut(sample.payload_mut()));
        let header = sample.user_header_mut();
        header.sequence = number;
        header.published_stamp_ns = clock::now_ns();
        sample.send().expect("sent");
        if let Some(notifier) = &self.notifier {
            notifier.notify().expect("a notification");
        }
    }
}

/// Receiving port.
pub struct Iceoryx2Receiver<S: Service> {
    subscriber: Subscriber<S, [CloudPoint], FrameHeader>,
    wait: WaitStrategy<S>,
    _node: Node<S>,
}

/// Waiting strategy of the receiver.
enum WaitStrategy<S: Service> {
    /// Busy polling.
    Polled,
    /// Tokio task on the listener's descriptor.
    Task(ListenerDescriptor<S>),
    /// Blocking wait of the thread.
    Thread(Listener<S>),
}

impl<S: Service> Iceoryx2Receiver<S> {
    pub fn new(case: &BenchmarkCase, namespace: &IpcNamespace) -> Self {
        let node = node(namespace);
        let subscriber = clouds(&node)
            .subscriber_builder()
            .buffer_size(CameraCloud::LIMITS.buffer)
            .create();
        let listener = || {
            let listener = wake_ups(&node).listener_builder().create();
            listener.expect("a listener")
        };
        let wait = match case.system {
            _ if case.is_polled() => WaitStrategy::Polled,
            System::Iceoryx2Thread => WaitStrategy::Thread(listener()),
            _ => WaitStrategy::Task(ListenerDescriptor(listener())),
        };
        Self {
            subscriber: subscriber.expect("a subscriber"),
            wait,
            _node: node,
        }
    }
}

/// Records all available messages; `true` if the last one was among them.
fn drain<S: Service>(
    subscriber: &Subscriber<S, [CloudPoint], FrameHeader>,
    recorder: &mut LatencyRecorder,
) -> bool {
    while let Some(sample) = subscriber.receive().expect("an answer") {
        let header = sample.user_header();
        let payload = bytemuck::cast_slice(sample.payload());
        if recorder.record(header.sequence, header.published_stamp_ns, payload) {
            return true;
        }
    }
    false
}

impl<S: Service> ports::Receiver for Iceoryx2Receiver<S>
where
    Listener<S>: FileDescriptorBased,
{
    fn receive(self: Box<Self>, mut recorder: LatencyRecorder) -> LatencyRecorder {
        let Self {
            subscriber, wait, ..
        } = *self;
        match wait {
            WaitStrategy::Polled => {
                while !drain(&subscriber, &mut recorder) {
                    std::hint::spin_loop();
                }
            }
            WaitStrategy::Thread(listener) => {
                while !drain(&subscriber, &mut recorder) {
                    listener.blocking_wait(|_| {}).expect("a wake-up");
                }
            }
            WaitStrategy::Task(descriptor) => tokio_runtime::runtime().block_on(async {
                // SAFETY: `ListenerDescriptor` gives the number of the one descriptor that its
                // listener keeps open until it is dropped.
                let listener = unsafe { AsyncFd::register(descriptor) };
                let listener = listener.expect("a descriptor");
                while !drain(&subscriber, &mut recorder) {
                    wait_for_wake_up(&listener).await;
                }
            }),
        }
        recorder
    }
}

/// File descriptor of a listener, for the reactor of tokio.
struct ListenerDescriptor<S: Service>(Listener<S>);

impl<S: Service> AsFd for ListenerDescriptor<S>
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

impl<S: Service> AsRawFd for ListenerDescriptor<S>
where
    Listener<S>: FileDescriptorBased,
{
    fn as_raw_fd(&self) -> RawFd {
        self.as_fd().as_raw_fd()
    }
}

/// Waits for at least one wake-up.
async fn wait_for_wake_up<S: Service>(listener: &AsyncFd<ListenerDescriptor<S>>)
where
    Listener<S>: FileDescriptorBased,
{
    loop {
        let mut ready = listener.readable().await.expect("a tokio reactor");
        let n_wake_ups = ready.get_inner().0.try_wait(|_| {}).expect("a listener");
        ready.clear_ready();
        if n_wake_ups > 0 {
            return;
        }
    }
}
