//! Interleavings of send, displace, receive, close, wait and drop on a mailbox.

use std::num::NonZeroUsize;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

use loom::future::block_on;
use loom::sync::Arc;
use loom::sync::atomic::{AtomicUsize, Ordering};
use loom::thread;

use crate::explore;
use crate::mailbox::endpoints::{Receiver, Sender, mailbox};
use crate::mailbox::overflow::{Backpressure, DropOldest, Immediate, Overflow, Refuse};
use crate::mailbox::send_error::SendError;

fn open<P: Overflow>(capacity: usize) -> (Sender<Message, P>, Receiver<Message, P>, Living) {
    let (sender, receiver) = mailbox(NonZeroUsize::new(capacity).expect("not empty"));
    (sender, receiver, Living::default())
}

/// Number of live messages: each stands for a loan of shared memory.
#[derive(Clone, Default)]
struct Living(Arc<AtomicUsize>);

impl Living {
    fn message(&self, n: u32) -> Message {
        self.0.fetch_add(1, Ordering::Relaxed);
        Message(n, self.clone())
    }

    fn count(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }
}

struct Message(u32, Living);

impl Drop for Message {
    fn drop(&mut self) {
        self.1.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Receives messages until the mailbox ends.
fn drain<P: Overflow>(receiver: &mut Receiver<Message, P>) -> Vec<u32> {
    block_on(async {
        let mut received = Vec::new();
        while let Some(message) = receiver.recv().await {
            received.push(message.0);
        }
        received
    })
}

/// Sends numbers from another thread; returns those accepted.
fn send_all<P: Immediate>(
    sender: Sender<Message, P>,
    living: &Living,
    numbers: [u32; 2],
) -> thread::JoinHandle<Vec<u32>> {
    let living = living.clone();
    thread::spawn(move || {
        let accepted = |n: &u32| sender.send(living.message(*n)).is_ok();
        numbers.into_iter().filter(accepted).collect()
    })
}

#[test]
fn receiver_is_woken_for_each_message_and_the_end() {
    explore(|| {
        let (sender, mut receiver, living) = open::<Refuse>(2);
        let other = send_all(sender.clone(), &living, [1, 2]);
        let accepted = sender.send(living.message(10)).is_ok();
        drop(sender);
        let received = drain(&mut receiver);
        let mut sent = other.join().unwrap();
        let of_other: Vec<_> = received.iter().copied().filter(|n| *n < 10).collect();
        assert_eq!(of_other, sent, "in the order of sending");
        sent.extend(accepted.then_some(10));
        assert_eq!(received.len(), sent.len());
        assert_eq!(living.count(), 0);
    });
}

#[test]
fn drop_oldest_displaces_and_counts_the_oldest() {
    explore(|| {
        let (sender, mut receiver, living) = open::<DropOldest>(1);
        let other = send_all(sender.clone(), &living, [1, 2]);
        sender.send(living.message(10)).unwrap();
        drop(sender);
        let received = drain(&mut receiver);
        assert_eq!(other.join().unwrap(), [1, 2], "never refused");
        assert_eq!(received.len() as u64 + receiver.dropped(), 3);
        assert!(received.is_sorted_by_key(|n| n % 10), "{received:?}");
        assert!(matches!(received.last(), Some(2 | 10)), "{received:?}");
        assert_eq!(living.count(), 0);
    });
}

#[test]
fn close_during_send_leaks_no_message() {
    explore(|| {
        let (sender, mut receiver, living) = open::<DropOldest>(1);
        let closer = sender.clone();
        let other = send_all(sender, &living, [1, 2]);
        let closing = thread::spawn(move || closer.close());
        let received = drain(&mut receiver);
        let accepted = other.join().unwrap();
        closing.join().unwrap();
        assert!(received.iter().all(|n| accepted.contains(n)));
        assert!(received.is_sorted());
        assert_eq!(living.count(), 0, "returned before the receiver is dropped");
    });
}

#[test]
fn receiver_drop_during_send_leaks_no_message() {
    explore(|| {
        let (sender, receiver, living) = open::<Refuse>(1);
        let keeper = sender.clone();
        let other = send_all(sender, &living, [1, 2]);
        drop(receiver);
        other.join().unwrap();
        assert!(keeper.is_closed());
        assert_eq!(living.count(), 0);
    });
}

/// Sends numbers from another thread, waiting for room.
fn send_waiting(
    sender: Sender<Message, Backpressure>,
    living: &Living,
    numbers: &'static [u32],
) -> thread::JoinHandle<Vec<u32>> {
    let living = living.clone();
    thread::spawn(move || {
        block_on(async {
            let mut sent = Vec::new();
            for n in numbers {
                match sender.send(living.message(*n)).await {
                    Ok(()) => sent.push(*n),
                    Err(error) => assert!(matches!(error, SendError::Closed(_))),
                }
            }
            sent
        })
    })
}

#[test]
fn blocked_sender_proceeds_in_order_without_loss() {
    explore(|| {
        let (sender, mut receiver, living) = open::<Backpressure>(1);
        let first = send_waiting(sender.clone(), &living, &[1, 2]);
        let second = send_waiting(sender, &living, &[10]);
        let received = drain(&mut receiver);
        assert_eq!(first.join().unwrap(), [1, 2]);
        assert_eq!(second.join().unwrap(), [10]);
        let of_first: Vec<_> = received.iter().filter(|n| **n < 10).collect();
        assert_eq!(of_first, [&1, &2]);
        assert_eq!(received.len(), 3);
        assert_eq!(living.count(), 0);
    });
}

#[test]
fn blocked_senders_all_proceed_when_there_is_room() {
    explore(|| {
        let (sender, mut receiver, living) = open::<Backpressure>(2);
        block_on(sender.send(living.message(1))).unwrap();
        block_on(sender.send(living.message(2))).unwrap();
        let first = send_waiting(sender.clone(), &living, &[3]);
        let second = send_waiting(sender, &living, &[4]);
        for n in [1, 2] {
            assert_eq!(block_on(receiver.recv()).map(|m| m.0), Some(n));
        }
        // No further message is received until both are in.
        first.join().unwrap();
        second.join().unwrap();
        assert_eq!(drain(&mut receiver).len(), 2);
    });
}

#[test]
fn blocked_sender_that_is_cancelled_yields_its_turn() {
    explore(|| {
        let (sender, mut receiver, living) = open::<Backpressure>(1);
        block_on(sender.send(living.message(1))).unwrap();
        let mut context = Context::from_waker(Waker::noop());
        let mut impatient = Box::pin({
            let (sender, message) = (sender.clone(), living.message(2));
            async move { sender.send(message).await }
        });
        assert!(impatient.as_mut().poll(&mut context).is_pending());
        let patient = send_waiting(sender, &living, &[3]);
        let giving_up = thread::spawn(move || drop(impatient));
        let received = drain(&mut receiver);
        giving_up.join().unwrap();
        assert_eq!(patient.join().unwrap(), [3]);
        assert_eq!(received, [1, 3]);
        assert_eq!(living.count(), 0);
    });
}

#[test]
fn close_ends_all_blocked_senders() {
    explore(|| {
        let (sender, mut receiver, living) = open::<Backpressure>(1);
        let waiting = send_waiting(sender.clone(), &living, &[1, 2]);
        let other = send_waiting(sender.clone(), &living, &[3]);
        sender.close();
        let received = drain(&mut receiver);
        assert!(received.is_empty(), "closed before it began to receive");
        waiting.join().unwrap();
        other.join().unwrap();
        assert_eq!(living.count(), 0);
    });
}

#[test]
fn blocked_send_fails_after_close() {
    explore(|| {
        let (sender, mut receiver, living) = open::<Backpressure>(1);
        block_on(sender.send(living.message(1))).unwrap();
        let mut context = Context::from_waker(Waker::noop());
        let mut sending = pin!(sender.send(living.message(2)));
        assert!(sending.as_mut().poll(&mut context).is_pending());
        let keeper = sender.clone();
        let closing = thread::spawn(move || keeper.close());
        let n_early = drain(&mut receiver).len();
        closing.join().unwrap();
        let late = sending.as_mut().poll(&mut context);
        assert!(n_early <= 1);
        assert!(matches!(late, Poll::Ready(Err(SendError::Closed(_)))));
    });
}
