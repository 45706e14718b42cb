//! Receiving.

use crate::domain::{Domain, Service};
use crate::publisher::open_service;
use crate::shared_frame::SharedFrame;
use crate::topic::Topic;
use crate::wake::Sleeper;
use crate::{Error, segment::SegmentMap};
use iceoryx2::port::ReceiveError;
use message::Counted;

type IoxSubscriber<T> =
    iceoryx2::port::subscriber::Subscriber<Service, [<T as Topic>::Item], <T as Topic>::Header>;

/// Receives messages of one topic.
#[derive(Debug)]
pub struct Subscriber<T: Topic> {
    port: IoxSubscriber<T>,
    sleeper: Option<Sleeper>,
    segments: SegmentMap,
    /// Of each publisher the last message: one mostly, and never many.
    last: Vec<Last>,
    n_lost: u64,
    _domain: Domain,
}

/// The last message of a publisher.
#[derive(Debug)]
struct Last {
    publisher: u128,
    sent: u64,
}

/// What [`Subscriber::receive`] found.
#[derive(Debug)]
pub enum Received<T: Topic> {
    /// The next message.
    Message(SharedFrame<T>),
    /// Nothing is waiting.
    Nothing,
    /// The subscriber holds as many messages as it may; drop one first.
    HoldsAll,
}

impl<T: Topic> Subscriber<T> {
    /// A subscriber that is asked, and costs nothing while it is not.
    ///
    /// # Errors
    /// When the service is of another version or has its subscribers already.
    pub fn polled(domain: &Domain) -> Result<Self, Error> {
        let service = open_service::<T>(domain)?;
        let subscriber = service
            .subscriber_builder()
            .buffer_size(T::LIMITS.buffer)
            .history_request(T::LIMITS.history)
            .create()
            .map_err(|e| Error::transport("make a subscriber of", T::NAME, e))?;
        Ok(Self {
            port: subscriber,
            sleeper: None,
            segments: SegmentMap::default(),
            last: Vec::new(),
            n_lost: 0,
            _domain: domain.clone(),
        })
    }

    /// A subscriber that can wait; within a tokio runtime.
    ///
    /// # Errors
    /// As [`polled`](Self::polled).
    pub fn waiting(domain: &Domain) -> Result<Self, Error> {
        let sleeper = Sleeper::new(domain, T::NAME)?;
        Ok(Self {
            sleeper: Some(sleeper),
            ..Self::polled(domain)?
        })
    }

    /// Takes the oldest waiting message.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn receive(&mut self) -> Result<Received<T>, Error> {
        let sample = match self.port.receive() {
            Ok(Some(sample)) => sample,
            Ok(None) => return Ok(Received::Nothing),
            Err(ReceiveError::ExceedsMaxBorrows) => return Ok(Received::HoldsAll),
            Err(error) => return Err(Error::transport("receive from", T::NAME, error)),
        };
        let publisher = sample.origin().value();
        // Takes a lock, before which no line of the other process's cache should
        // be waited for: after it they all come together. The header's first line is
        // among them because it is asked for here: what moves the frame waits for
        // the lines asked for before, and lets none be asked for behind it.
        let frame = SharedFrame::<T>::new(sample, &mut self.segments);
        self.count(publisher, frame.header().sent());
        Ok(Received::Message(frame))
    }

    /// Takes the newest waiting message and drops, uncounted, what is older:
    /// for state, of which only the latest matters.
    ///
    /// # Errors
    /// As [`receive`](Self::receive).
    pub fn latest(&mut self) -> Result<Option<SharedFrame<T>>, Error> {
        let mut newest = None;
        while let Received::Message(message) = self.receive()? {
            newest = Some(message);
        }
        Ok(newest)
    }

    /// Waits until a message may be there. Polled subscribers wait for ever.
    pub async fn woken(&self) {
        match &self.sleeper {
            Some(sleeper) => sleeper.woken().await,
            None => std::future::pending().await,
        }
    }

    /// Waits for the next message.
    ///
    /// # Errors
    /// As [`receive`](Self::receive); also when all messages it may hold are held.
    pub async fn next(&mut self) -> Result<SharedFrame<T>, Error> {
        loop {
            match self.receive()? {
                Received::Message(message) => return Ok(message),
                Received::Nothing => self.woken().await,
                Received::HoldsAll => {
                    return Err(Error::transport(
                        "receive from",
                        T::NAME,
                        "all messages are held",
                    ));
                }
            }
        }
    }

    /// Messages that were overwritten between received ones.
    pub fn n_lost(&self) -> u64 {
        self.n_lost
    }

    fn count(&mut self, publisher: u128, sent: u64) {
        let known = self
            .last
            .iter_mut()
            .find(|last| last.publisher == publisher);
        let Some(last) = known else {
            self.last.push(Last { publisher, sent });
            return;
        };
        self.n_lost += sent.saturating_sub(last.sent + 1);
        last.sent = sent;
    }
}
