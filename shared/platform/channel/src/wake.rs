//! Waking a tokio task from another process.

use crate::Error;
use crate::domain::{Domain, Service};
use iceoryx2::port::{listener::Listener, notifier::Notifier};
use iceoryx2::prelude::{FileDescriptorBased, ServiceName};
use iceoryx2::service::port_factory::event::PortFactory;
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, RawFd};
use tokio::io::unix::AsyncFd;

/// Most processes that wait for, or wake the waiters of, one service.
const MAX_PORTS: usize = 32;

fn open(domain: &Domain, name: &'static str) -> Result<PortFactory<Service>, Error> {
    let failed = |cause: &dyn std::fmt::Debug| Error::transport("open the event", name, cause);
    let service_name: ServiceName = name.try_into().map_err(|e| failed(&e))?;
    domain
        .node()
        .service_builder(&service_name)
        .event()
        .max_listeners(MAX_PORTS)
        .max_notifiers(MAX_PORTS)
        .max_nodes(MAX_PORTS)
        .open_or_create()
        .map_err(|e| failed(&e))
}

/// Wakes whoever waits for a service.
#[derive(Debug)]
pub(crate) struct Waker {
    notifier: Notifier<Service>,
    service: PortFactory<Service>,
}

impl Waker {
    pub(crate) fn new(domain: &Domain, name: &'static str) -> Result<Self, Error> {
        let service = open(domain, name)?;
        let notifier = service
            .notifier_builder()
            .create()
            .map_err(|e| Error::transport("make a notifier of", name, e))?;
        Ok(Self { notifier, service })
    }

    /// A wake-up costs 13 to 20 µs, so only those who wait get one.
    pub(crate) fn wake(&self) {
        use iceoryx2::prelude::PortFactory as _;
        if self.service.dynamic_config().number_of_listeners() > 0 {
            // A waiter that has died is no reason to fail; the sweep removes it.
            let _ = self.notifier.notify();
        }
    }
}

/// The listener's descriptor as tokio wants it.
#[derive(Debug)]
struct Descriptor(Listener<Service>);

impl AsFd for Descriptor {
    #[expect(
        unsafe_code,
        reason = "iceoryx2 gives its descriptor as a bare number only"
    )]
    fn as_fd(&self) -> BorrowedFd<'_> {
        // SAFETY: the number is not closed and not kept beyond the borrow below.
        let number = unsafe { self.0.file_descriptor().native_handle() };
        // SAFETY: the listener owns the open descriptor and outlives the borrow of `self`.
        unsafe { BorrowedFd::borrow_raw(number) }
    }
}

impl AsRawFd for Descriptor {
    fn as_raw_fd(&self) -> RawFd {
        self.as_fd().as_raw_fd()
    }
}

/// Waits for wake-ups of one service.
#[derive(Debug)]
pub(crate) struct Sleeper {
    listener: AsyncFd<Descriptor>,
}

impl Sleeper {
    /// Must be called within a tokio runtime.
    pub(crate) fn new(domain: &Domain, name: &'static str) -> Result<Self, Error> {
        let listener = open(domain, name)?
            .listener_builder()
            .create()
            .map_err(|e| Error::transport("make a listener of", name, e))?;
        let descriptor = Descriptor(listener);
        #[expect(unsafe_code, reason = "tokio wants a promise about the descriptor")]
        // SAFETY: `Descriptor` always gives the number of the one descriptor that
        // its listener keeps open until it is dropped.
        let listener = unsafe { AsyncFd::register(descriptor) };
        let listener = listener.map_err(|e| Error::transport("wait for", name, e))?;
        Ok(Self { listener })
    }

    /// Returns after a wake-up since the last return; a wake-up before the first
    /// call is not lost. All pending wake-ups are taken together.
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
