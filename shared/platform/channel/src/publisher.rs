//! Publisher of a topic: loan, fill, send by value (zero-copy).
#![expect(
    unsafe_code,
    reason = "a loaned message is not zeroed before it is filled"
)]

use crate::domain::{Domain, Service};
use crate::segment_backing::back_segment;
use crate::segment_map::SegmentMap;
use crate::shared_memory::check_shared_memory;
use crate::topic::{self, Topic};
use crate::topic_service::{IoxService, open_service};
use crate::wake_event::WakeNotifier;
use crate::{Error, Reservation};
use iceoryx2::port::update_connections::UpdateConnections as _;
use iceoryx2::port::{BackpressureAction, LoanError, SendError};
use iceoryx2::prelude::BackpressureStrategy;
use iceoryx2::sample_mut::SampleMut;
use message::{SegmentLocation, SequencedHeader};

type IoxPublisher<T> =
    iceoryx2::port::publisher::Publisher<Service, [<T as Topic>::Item], <T as Topic>::Header>;
type IoxSample<T> = SampleMut<Service, [<T as Topic>::Item], <T as Topic>::Header>;

/// Publisher of one topic.
#[derive(Debug)]
pub struct Publisher<T: Topic> {
    port: IoxPublisher<T>,
    service: IoxService<T>,
    waker: WakeNotifier,
    segments: SegmentMap,
    max_items: usize,
    guest_places: u32,
    sent: u64,
    _domain: Domain,
}

/// Loaned message to fill. Dropping it returns the memory unsent.
#[derive(Debug)]
pub struct Loan<T: Topic> {
    sample: IoxSample<T>,
}

impl<T: Topic> Publisher<T> {
    /// Creates a publisher with all its memory allocated.
    ///
    /// # Errors
    /// When the service is of another version, has its publishers already, or the
    /// memory cannot be reserved.
    pub fn new(domain: &Domain) -> Result<Self, Error> {
        Self::for_items(domain, T::MAX_ITEMS)
    }

    /// Creates a publisher of messages of at most `max_items` items, with all its memory
    /// allocated. They may be more than the topic's [`MAX_ITEMS`](Topic::MAX_ITEMS): a camera
    /// with large images needs more memory than the domain has reserved for every camera.
    ///
    /// # Errors
    /// As [`new`](Self::new), and when the additional memory is not free.
    pub fn for_items(domain: &Domain, max_items: usize) -> Result<Self, Error> {
        let places = domain.guest_places();
        let frame_points = topic::frame_points::<T>(max_items);
        check_shared_memory(domain.name(), frame_points, places)?;
        let service = open_service::<T>(domain)?;
        let publisher = service
            .publisher_builder()
            .initial_max_slice_len(max_items)
            .max_loaned_samples(T::LIMITS.loaned)
            .override_sample_preallocation(move |_| T::LIMITS.slots(places))
            .backpressure_strategy(BackpressureStrategy::DiscardData)
            .set_backpressure_handler(|_| BackpressureAction::DiscardDataAndFail)
            .create()
            .map_err(|e| Error::transport("make a publisher of", T::NAME, e))?;
        back_segment(domain.name(), T::NAME, publisher.id().value())?;
        Ok(Self {
            port: publisher,
            service,
            waker: WakeNotifier::new(domain, T::NAME)?,
            segments: SegmentMap::default(),
            max_items,
            guest_places: places,
            sent: 0,
            _domain: domain.clone(),
        })
    }

    /// Loans a message of `n_items` items with a default header. The items hold the
    /// bytes of an earlier message: clearing 4.9 MB that the caller fills anyway
    /// would cost as much as writing them.
    ///
    /// # Errors
    /// When all loans are held, or `n_items` is more than was reserved.
    pub fn loan(&self, n_items: usize) -> Result<Loan<T>, Error> {
        if n_items > self.max_items {
            return Err(Error::TooLong {
                service: T::NAME,
                len: n_items,
                max: self.max_items,
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

    /// Sends a filled message and wakes the waiting subscribers. Sets the message
    /// number in the header.
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

    /// Loans, fills and sends a small message in one call.
    ///
    /// # Errors
    /// As [`loan`](Self::loan) and [`send`](Self::send).
    pub fn send_copy(&mut self, header: T::Header, items: &[T::Item]) -> Result<(), Error> {
        let mut loan = self.loan(items.len())?;
        *loan.header_mut() = header;
        loan.items_mut().copy_from_slice(items);
        self.send(loan)
    }

    /// Delivers the topic's history to subscribers that have come since the last
    /// message. Sending does so too; a publisher that may be silent for long calls
    /// this about once a second.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn deliver_history(&self) -> Result<(), Error> {
        let greeted = self.port.update_connections();
        greeted.map_err(|e| Error::transport("connect the subscribers of", T::NAME, e))?;
        self.waker.wake();
        Ok(())
    }

    /// `true` when the topic has a subscriber.
    pub fn has_subscribers(&self) -> bool {
        use iceoryx2::prelude::PortFactory as _;
        self.service.dynamic_config().number_of_subscribers() > 0
    }

    /// Location of a loan's items in shared memory.
    pub fn location(&mut self, loan: &Loan<T>) -> SegmentLocation {
        self.segments.locate(loan.sample.payload().as_ptr().addr())
    }

    /// Shared memory reserved by this publisher.
    pub fn reservation(&self) -> Reservation {
        let all = topic::reservation::<T>(self.max_items, self.guest_places);
        Reservation {
            slots: all.slots / T::LIMITS.publishers as u64,
            ..all
        }
    }
}

impl<T: Topic> Loan<T> {
    /// Message header to fill before sending.
    pub fn header_mut(&mut self) -> &mut T::Header {
        self.sample.user_header_mut()
    }

    /// Message items to fill before sending.
    pub fn items_mut(&mut self) -> &mut [T::Item] {
        self.sample.payload_mut()
    }
}
