//! Subscriber of a topic.

use crate::domain::{Domain, Service};
use crate::guest_places::GuestPlace;
use crate::shared_message::SharedMessage;
use crate::topic::Topic;
use crate::topic_service::open_service;
use crate::wake_event::WakeListener;
use crate::{Error, segment_map::SegmentMap};
use iceoryx2::port::ReceiveError;
use message::SequencedHeader;
use std::sync::Arc;

type IoxSubscriber<T> =
    iceoryx2::port::subscriber::Subscriber<Service, [<T as Topic>::Item], <T as Topic>::Header>;

/// Subscriber of one topic.
#[derive(Debug)]
pub struct Subscriber<T: Topic> {
    port: IoxSubscriber<T>,
    listener: Option<WakeListener>,
    segments: SegmentMap,
    guest: Option<Guest>,
    /// Last message of each publisher: mostly one entry.
    last: Vec<LastMessage>,
    n_lost: u64,
    _domain: Domain,
}

/// Guest of a topic: its place, and a count of the messages that it holds.
#[derive(Debug)]
struct Guest {
    _place: GuestPlace,
    borrowed: usize,
    held: Arc<()>,
}

/// Number of the last message received from a publisher.
#[derive(Debug)]
struct LastMessage {
    publisher: u128,
    sent: u64,
}

/// Result of [`Subscriber::receive`].
#[derive(Debug)]
pub enum Received<T: Topic> {
    /// Next message of the topic.
    Message(SharedMessage<T>),
    /// No message is queued for the subscriber.
    Nothing,
    /// Borrow limit reached: the caller must drop a message first.
    BorrowLimitReached,
}

impl<T: Topic> Subscriber<T> {
    /// Creates a polled subscriber, which costs nothing between calls; of a topic with guest
    /// places it is a guest.
    ///
    /// # Errors
    /// When the service is of another version or has its subscribers already, or no place for a
    /// guest is free.
    pub fn polled(domain: &Domain) -> Result<Self, Error> {
        let Some(limits) = T::LIMITS.guest else {
            return Self::with(domain, T::LIMITS.buffer, None);
        };
        let guest = Guest {
            _place: GuestPlace::take(domain.locks(), T::NAME, domain.guest_places())?,
            borrowed: limits.borrowed,
            held: Arc::new(()),
        };
        Self::with(domain, limits.buffer, Some(guest))
    }

    /// Creates the subscriber for which a topic with guest places has one more place, with a
    /// longer queue and more borrowed messages. It can wait; within a tokio runtime.
    ///
    /// # Errors
    /// As [`polled`](Self::polled).
    pub fn owner(domain: &Domain) -> Result<Self, Error> {
        let listener = WakeListener::new(domain, T::NAME)?;
        Ok(Self {
            listener: Some(listener),
            ..Self::with(domain, T::LIMITS.buffer, None)?
        })
    }

    fn with(domain: &Domain, buffer: usize, guest: Option<Guest>) -> Result<Self, Error> {
        let service = open_service::<T>(domain)?;
        let subscriber = service
            .subscriber_builder()
            .buffer_size(buffer)
            .history_request(T::LIMITS.history)
            .create()
            .map_err(|e| Error::transport("make a subscriber of", T::NAME, e))?;
        Ok(Self {
            port: subscriber,
            listener: None,
            segments: SegmentMap::default(),
            guest,
            last: Vec::new(),
            n_lost: 0,
            _domain: domain.clone(),
        })
    }

    /// Creates a subscriber that can wait for messages; within a tokio runtime.
    ///
    /// # Errors
    /// As [`polled`](Self::polled).
    pub fn waiting(domain: &Domain) -> Result<Self, Error> {
        let listener = WakeListener::new(domain, T::NAME)?;
        Ok(Self {
            listener: Some(listener),
            ..Self::polled(domain)?
        })
    }

    /// Takes the oldest queued message of the topic.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn receive(&mut self) -> Result<Received<T>, Error> {
        let held = self.guest.as_ref().map(|guest| &guest.held);
        let is_full = |guest: &Guest| Arc::strong_count(&guest.held) > guest.borrowed;
        if self.guest.as_ref().is_some_and(is_full) {
            return Ok(Received::BorrowLimitReached);
        }
        let held = held.cloned();
        let sample = match self.port.receive() {
            Ok(Some(sample)) => sample,
            Ok(None) => return Ok(Received::Nothing),
            Err(ReceiveError::ExceedsMaxBorrows) => return Ok(Received::BorrowLimitReached),
            Err(error) => return Err(Error::transport("receive from", T::NAME, error)),
        };
        let publisher = sample.origin().value();
        // Takes a lock. Until then no cache line of the other process should be
        // waited for: after it they all arrive together. The header's first line is
        // among them because it is requested here: a memory barrier that moves the
        // frame waits for lines requested before it and allows none to be requested
        // behind it.
        let frame = SharedMessage::<T>::new(sample, &mut self.segments, held);
        self.count(publisher, frame.header().sent());
        Ok(Received::Message(frame))
    }

    /// Takes all queued messages, oldest first, up to the borrow limit.
    ///
    /// # Errors
    /// As [`receive`](Self::receive).
    pub fn take_all(&mut self, mut take: impl FnMut(SharedMessage<T>)) -> Result<(), Error> {
        while let Received::Message(message) = self.receive()? {
            take(message);
        }
        Ok(())
    }

    /// Takes the newest queued message and drops older ones uncounted: for state, of
    /// which only the latest matters.
    ///
    /// # Errors
    /// As [`receive`](Self::receive).
    pub fn latest(&mut self) -> Result<Option<SharedMessage<T>>, Error> {
        let mut newest = None;
        self.take_all(|message| newest = Some(message))?;
        Ok(newest)
    }

    /// Waits until a message may be queued. Polled subscribers wait for ever.
    pub async fn wake_event(&self) {
        match &self.listener {
            Some(listener) => listener.woken().await,
            None => std::future::pending().await,
        }
    }

    /// Waits for the next message of the topic.
    ///
    /// # Errors
    /// As [`receive`](Self::receive); also when the borrow limit is reached.
    pub async fn next(&mut self) -> Result<SharedMessage<T>, Error> {
        loop {
            match self.receive()? {
                Received::Message(message) => return Ok(message),
                Received::Nothing => self.wake_event().await,
                Received::BorrowLimitReached => {
                    return Err(Error::transport(
                        "receive from",
                        T::NAME,
                        "all messages are held",
                    ));
                }
            }
        }
    }

    /// Number of messages overwritten between received ones.
    pub fn n_lost(&self) -> u64 {
        self.n_lost
    }

    fn count(&mut self, publisher: u128, sent: u64) {
        let known = self
            .last
            .iter_mut()
            .find(|last| last.publisher == publisher);
        let Some(last) = known else {
            self.last.push(LastMessage { publisher, sent });
            return;
        };
        self.n_lost += sent.saturating_sub(last.sent + 1);
        last.sent = sent;
    }
}
