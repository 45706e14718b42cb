//! Wake-up of a tokio task by another process (iceoryx2 event service).

use crate::Error;
use crate::domain::{Domain, Service};
use crate::service_creation::open_or_create;
use iceoryx2::port::{listener::Listener, notifier::Notifier};
use iceoryx2::prelude::{FileDescriptorBased, MessagingPattern, ServiceName};
use iceoryx2::service::builder::event::{EventOpenError, EventOpenOrCreateError};
use iceoryx2::service::port_factory::event::PortFactory;
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, RawFd};
use tokio::io::unix::AsyncFd;

/// Largest number of processes that wait for, or wake the waiters of, one service.
const MAX_PORTS: usize = 32;

fn open(domain: &Domain, name: &'static str) -> Result<PortFactory<Service>, Error> {
    let failed = |cause: &dyn std::fmt::Debug| Error::transport("open the event", name, cause);
    let service_name: ServiceName = name.try_into().map_err(|e| failed(&e))?;
    let open = || {
        domain
            .node()
            .service_builder(&service_name)
            .event()
            .max_listeners(MAX_PORTS)
            .max_notifiers(MAX_PORTS)
            .max_nodes(MAX_PORTS)
            .open_or_create()
    };
    let hangs = EventOpenOrCreateError::EventOpenError(EventOpenError::HangsInCreation);
    let pattern = MessagingPattern::Event;
    open_or_create(domain, &service_name, pattern, open, |error| {
        *error == hangs
    })
    .map_err(|e| failed(&e))
}

/// Notifier of one service's event: wakes the waiting processes.
#[derive(Debug)]
pub(crate) struct WakeNotifier {
    notifier: Notifier<Service>,
    service: PortFactory<Service>,
}

impl WakeNotifier {
    pub(crate) fn new(domain: &Domain, name: &'static str) -> Result<Self, Error> {
        let service = open(domain, name)?;
        let notifier = service
            .notifier_builder()
            .create()
            .map_err(|e| Error::transport("make a notifier of", name, e))?;
        Ok(Self { notifier, service })
    }

    /// Wakes the waiting processes. A wake-up costs 13 to 20 µs, so it is skipped
    /// without listeners.
    pub(crate) fn wake(&self) {
        use iceoryx2::prelude::PortFactory as _;
        if self.service.dynamic_config().number_of_listeners() > 0 {
            // A dead waiter is no reason to fail; the sweep removes it.
            let _ = self.notifier.notify();
        }
    }
}

/// File descriptor of a listener, for tokio's reactor.
#[derive(Debug)]
struct ListenerDescriptor(Listener<Service>);

impl AsFd for ListenerDescriptor {
    #[expect(
        unsafe_code,
        reason = "iceoryx2 exposes its file descriptor only as a raw number"
    )]
    fn as_fd(&self) -> BorrowedFd<'_> {
        // SAFETY: the number is not closed and not kept beyond the borrow below.
        let number = unsafe { self.0.file_descriptor().native_handle() };
        // SAFETY: the listener owns the open descriptor and outlives the borrow of `self`.
        unsafe { BorrowedFd::borrow_raw(number) }
    }
}

impl AsRawFd for ListenerDescriptor {
    fn as_raw_fd(&self) -> RawFd {
        self.as_fd().as_raw_fd()
    }
}

/// Listener of one service's event.
#[derive(Debug)]
pub(crate) struct WakeListener {
    listener: AsyncFd<ListenerDescriptor>,
}

impl WakeListener {
    /// Creates a listener; within a tokio runtime.
    pub(crate) fn new(domain: &Domain, name: &'static str) -> Result<Self, Error> {
        let listener = open(domain, name)?
            .listener_builder()
            .create()
            .map_err(|e| Error::transport("make a listener of", name, e))?;
        let descriptor = ListenerDescriptor(listener);
        #[expect(
            unsafe_code,
            reason = "registering a raw file descriptor with tokio is unsafe"
        )]
        // SAFETY: `ListenerDescriptor` always gives the number of the one descriptor that
        // its listener keeps open until it is dropped.
        let listener = unsafe { AsyncFd::register(descriptor) };
        let listener = listener.map_err(|e| Error::transport("wait for", name, e))?;
        Ok(Self { listener })
    }

    /// Waits for a wake-up since the last return; one before the first call is not
    /// lost. All pending wake-ups are taken together.
    pub(crate) async fn woken(&self) {
        loop {
            let Ok(mut ready) = self.listener.readable().await else {
                return;
            };
            let n_wakeups = ready.get_inner().0.try_wait(|_| {}).unwrap_or(0);
            ready.clear_ready();
            if n_wakeups > 0 {
                return;
            }
        }
    }
}
