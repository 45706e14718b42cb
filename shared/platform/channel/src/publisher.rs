//! Sending: loan, fill, send by value.
#![expect(unsafe_code, reason = "a loan is not cleared before it is filled")]

use crate::domain::{Domain, Service};
use crate::segment::SegmentMap;
use crate::topic::{Overflow, Topic};
use crate::wake::Waker;
use crate::{Error, Reservation, topic::Limits};
use iceoryx2::port::update_connections::UpdateConnections as _;
use iceoryx2::port::{BackpressureAction, LoanError, SendError};
use iceoryx2::prelude::{BackpressureStrategy, ServiceName};
use iceoryx2::sample_mut::SampleMut;
use iceoryx2::service::builder::publish_subscribe::{
    PublishSubscribeOpenError, PublishSubscribeOpenOrCreateError,
};
use iceoryx2::service::port_factory::publish_subscribe::PortFactory;
use message::{Counted, SegmentLocation};

type IoxService<T> = PortFactory<Service, [<T as Topic>::Item], <T as Topic>::Header>;
type IoxPublisher<T> =
    iceoryx2::port::publisher::Publisher<Service, [<T as Topic>::Item], <T as Topic>::Header>;
type IoxSample<T> = SampleMut<Service, [<T as Topic>::Item], <T as Topic>::Header>;

/// Opens a service, and makes it when it is not there, with its topic's limits.
pub(crate) fn open_service<T: Topic>(domain: &Domain) -> Result<IoxService<T>, Error> {
    let Limits {
        publishers,
        subscribers,
        buffer,
        borrowed,
        history,
        ..
    } = T::LIMITS;
    let name: ServiceName = T::NAME
        .try_into()
        .map_err(|e| Error::transport("name", T::NAME, e))?;
    domain
        .node()
        .service_builder(&name)
        .publish_subscribe::<[T::Item]>()
        .user_header::<T::Header>()
        .max_publishers(publishers)
        .max_subscribers(subscribers)
        .max_nodes(publishers + subscribers)
        .subscriber_max_buffer_size(buffer)
        .subscriber_max_borrowed_samples(borrowed)
        .history_size(history)
        .enable_safe_overflow(T::Overflow::DROPS_OLDEST)
        .open_or_create()
        .map_err(|error| open_failed::<T>(domain, error))
}

fn open_failed<T: Topic>(domain: &Domain, error: PublishSubscribeOpenOrCreateError) -> Error {
    use PublishSubscribeOpenError as Open;
    match error {
        PublishSubscribeOpenOrCreateError::PublishSubscribeOpenError(
            Open::IncompatibleTypes
            | Open::IncompatibleMessagingPattern
            | Open::IncompatibleAttributes
            | Open::IncompatibleOverflowBehavior
            | Open::DoesNotSupportRequestedMinBufferSize
            | Open::DoesNotSupportRequestedMinHistorySize
            | Open::DoesNotSupportRequestedMinSubscriberBorrowedSamples
            | Open::DoesNotSupportRequestedAmountOfPublishers
            | Open::DoesNotSupportRequestedAmountOfSubscribers
            | Open::DoesNotSupportRequestedAmountOfNodes,
        ) => Error::OtherVersion {
            service: T::NAME,
            domain: domain.name().to_string(),
        },
        other => Error::transport("open", T::NAME, other),
    }
}

/// Sends messages of one topic.
#[derive(Debug)]
pub struct Publisher<T: Topic> {
    port: IoxPublisher<T>,
    service: IoxService<T>,
    waker: Waker,
    segments: SegmentMap,
    sent: u64,
    _domain: Domain,
}

/// A message being filled. Dropping it gives the memory back unsent.
#[derive(Debug)]
pub struct Loan<T: Topic> {
    sample: IoxSample<T>,
}

impl<T: Topic> Publisher<T> {
    /// A publisher with all its memory reserved.
    ///
    /// # Errors
    /// When the service is of another version, has its publishers already, or
    /// the memory can not be reserved.
    pub fn new(domain: &Domain) -> Result<Self, Error> {
        let service = open_service::<T>(domain)?;
        let publisher = service
            .publisher_builder()
            .initial_max_slice_len(T::MAX_ITEMS)
            .max_loaned_samples(T::LIMITS.loaned)
            .backpressure_strategy(BackpressureStrategy::DiscardData)
            .set_backpressure_handler(|_| BackpressureAction::DiscardDataAndFail)
            .create()
            .map_err(|e| Error::transport("make a publisher of", T::NAME, e))?;
        Ok(Self {
            port: publisher,
            service,
            waker: Waker::new(domain, T::NAME)?,
            segments: SegmentMap::default(),
            sent: 0,
            _domain: domain.clone(),
        })
    }

    /// Borrows a message of `n_items` items with a default header. The items hold
    /// whatever an earlier message left there: clearing 4.9 MB that the caller
    /// fills anyway would cost as much as writing them.
    ///
    /// # Errors
    /// When all loans are held, or `n_items` is more than the topic carries.
    pub fn loan(&self, n_items: usize) -> Result<Loan<T>, Error> {
        if n_items > T::MAX_ITEMS {
            return Err(Error::TooLong {
                service: T::NAME,
                len: n_items,
                max: T::MAX_ITEMS,
            });
        }
        let sample = self
            .port
            .loan_slice_uninit(n_items)
            .map_err(|error| match error {
                LoanError::ExceedsMaxLoans | LoanError::OutOfMemory => {
                    Error::NoLoan { service: T::NAME }
                }
                other => Error::transport("loan", T::NAME, other),
            })?;
        // SAFETY: the memory is a mapped file, which the kernel hands out zeroed
        // and which then holds earlier messages: its bytes are always initialised.
        // Any bit pattern is a valid item (`AnyBitPattern`).
        let sample = unsafe { sample.assume_init() };
        Ok(Loan { sample })
    }

    /// Sends a filled message and wakes those who wait. The header is numbered here.
    ///
    /// # Errors
    /// When the topic refuses overflow and a receiver's queue is full.
    pub fn send(&mut self, mut loan: Loan<T>) -> Result<(), Error> {
        self.sent += 1;
        loan.header_mut().set_sent(self.sent);
        loan.sample.send().map_err(|error| match error {
            SendError::UnableToDeliver => Error::QueueFull { service: T::NAME },
            other => Error::transport("send", T::NAME, other),
        })?;
        self.waker.wake();
        Ok(())
    }

    /// Sends a small message in one call.
    ///
    /// # Errors
    /// As [`loan`](Self::loan) and [`send`](Self::send).
    pub fn send_copy(&mut self, header: T::Header, items: &[T::Item]) -> Result<(), Error> {
        let mut loan = self.loan(items.len())?;
        *loan.header_mut() = header;
        loan.items_mut().copy_from_slice(items);
        self.send(loan)
    }

    /// Gives subscribers that have come since the last message the topic's history.
    /// Sending does so too; a publisher that may be silent for long calls this
    /// about once a second.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn greet_new_subscribers(&self) -> Result<(), Error> {
        let greeted = self.port.update_connections();
        greeted.map_err(|e| Error::transport("connect the subscribers of", T::NAME, e))?;
        self.waker.wake();
        Ok(())
    }

    /// Whether anybody subscribes.
    pub fn has_subscribers(&self) -> bool {
        use iceoryx2::prelude::PortFactory as _;
        self.service.dynamic_config().number_of_subscribers() > 0
    }

    /// Where a loan's items lie in shared memory.
    pub fn location(&mut self, loan: &Loan<T>) -> SegmentLocation {
        self.segments.locate(loan.sample.payload().as_ptr().addr())
    }

    /// Shared memory this publisher has reserved.
    pub fn reservation(&self) -> Reservation {
        let all = Reservation::of_topic::<T>();
        Reservation {
            slots: all.slots / T::LIMITS.publishers as u64,
            ..all
        }
    }
}

impl<T: Topic> Loan<T> {
    /// The header to fill.
    pub fn header_mut(&mut self) -> &mut T::Header {
        self.sample.user_header_mut()
    }

    /// The items to fill.
    pub fn items_mut(&mut self) -> &mut [T::Item] {
        self.sample.payload_mut()
    }
}
