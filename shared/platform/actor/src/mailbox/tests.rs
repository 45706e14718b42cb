use std::pin::pin;
use std::task::Waker;
use std::time::Duration;

use proptest::prelude::*;
use tokio::time::timeout;

use super::*;
use std::collections::VecDeque;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::task::{Context, Poll};

/// Watchdog of a test, far beyond any healthy run, paused clocks included.
const WATCHDOG: Duration = Duration::from_secs(60);

fn room(n: usize) -> NonZeroUsize {
    NonZeroUsize::new(n).unwrap()
}

/// Polls the receiver once, without waiting.
fn poll_now<T, P: Overflow>(receiver: &mut Receiver<T, P>) -> Poll<Option<T>> {
    let mut context = Context::from_waker(Waker::noop());
    pin!(receiver.recv()).poll(&mut context)
}

#[derive(Debug, Clone, Copy)]
enum MailboxStep {
    Send,
    Receive,
    Close,
}

fn steps() -> impl Strategy<Value = Vec<MailboxStep>> {
    let step = prop_oneof![30 => Just(MailboxStep::Send), 20 => Just(MailboxStep::Receive), 1 => Just(MailboxStep::Close)];
    prop::collection::vec(step, 1..200)
}

/// Compares the mailbox with a plain list under the same policy.
fn check<P: Immediate>(capacity: usize, steps: &[MailboxStep]) -> Result<(), TestCaseError> {
    let (sender, mut receiver) = mailbox::<usize, P>(room(capacity));
    let (mut model, mut n_displaced, mut is_closed) = (VecDeque::new(), 0_u64, false);
    for (stamp, step) in steps.iter().enumerate() {
        match step {
            MailboxStep::Send if is_closed => {
                prop_assert_eq!(sender.send(stamp), Err(SendError::Closed(stamp)));
            }
            MailboxStep::Send if model.len() == capacity && !P::DISPLACES => {
                prop_assert_eq!(sender.send(stamp), Err(SendError::Full(stamp)));
            }
            MailboxStep::Send => {
                if model.len() == capacity {
                    model.pop_front();
                    n_displaced += 1;
                }
                model.push_back(stamp);
                prop_assert_eq!(sender.send(stamp), Ok(()));
            }
            MailboxStep::Receive => {
                let expected = match model.pop_front() {
                    None if !is_closed => Poll::Pending,
                    next => Poll::Ready(next),
                };
                prop_assert_eq!(poll_now(&mut receiver), expected);
            }
            MailboxStep::Close => {
                sender.close();
                model.clear();
                is_closed = true;
            }
        }
        prop_assert_eq!(sender.dropped(), n_displaced);
        prop_assert_eq!(receiver.dropped(), n_displaced);
        prop_assert_eq!(sender.is_closed(), is_closed);
    }
    Ok(())
}

proptest! {
    #[test]
    fn drop_oldest_agrees_with_a_list(capacity in 1_usize..6, steps in steps()) {
        check::<DropOldest>(capacity, &steps)?;
    }

    #[test]
    fn refuse_agrees_with_a_list(capacity in 1_usize..6, steps in steps()) {
        check::<Refuse>(capacity, &steps)?;
    }
}

#[test]
fn a_displaced_message_gives_its_resource_back_at_once() {
    let (sender, _receiver) = mailbox::<_, DropOldest>(room(2));
    let frames: Vec<_> = (0..3).map(Arc::new).collect();
    for frame in &frames {
        sender.send(Arc::clone(frame)).unwrap();
    }
    let n_owners: Vec<_> = frames.iter().map(Arc::strong_count).collect();
    assert_eq!(n_owners, [1, 2, 2]);
    assert_eq!(sender.dropped(), 1);
}

#[test]
fn closing_and_dropping_give_all_resources_back() {
    let frame = Arc::new(());
    let (sender, receiver) = mailbox::<_, Refuse>(room(4));
    sender.send(Arc::clone(&frame)).unwrap();
    sender.close();
    assert_eq!(Arc::strong_count(&frame), 1, "closed from the sending side");
    drop(receiver);

    let (sender, receiver) = mailbox::<_, Refuse>(room(4));
    sender.send(Arc::clone(&frame)).unwrap();
    drop(receiver);
    assert_eq!(Arc::strong_count(&frame), 1, "receiver dropped");
    assert!(matches!(sender.send(frame), Err(SendError::Closed(_))));
}

#[test]
fn a_message_that_closes_its_own_mailbox_when_dropped_finds_no_lock_held() {
    struct Closer(Option<Sender<Closer, DropOldest>>);
    impl Drop for Closer {
        fn drop(&mut self) {
            if let Some(sender) = &self.0 {
                sender.close();
            }
        }
    }
    let (sender, _receiver) = mailbox::<_, DropOldest>(room(1));
    sender.send(Closer(Some(sender.clone()))).unwrap();
    sender.send(Closer(None)).unwrap();
    assert!(sender.is_closed());
}

#[tokio::test(start_paused = true)]
async fn receiver_without_senders_gets_the_rest_and_the_end() {
    let (sender, mut receiver) = mailbox::<_, Refuse>(room(4));
    let other = sender.clone();
    sender.send(1).unwrap();
    drop(sender);
    other.send(2).unwrap();
    let waiting = tokio::spawn(async move {
        let mut all = Vec::new();
        while let Some(message) = receiver.recv().await {
            all.push(message);
        }
        all
    });
    tokio::task::yield_now().await;
    drop(other);
    assert_eq!(timeout(WATCHDOG, waiting).await.unwrap().unwrap(), [1, 2]);
}

#[tokio::test(start_paused = true)]
async fn block_waits_for_room_in_the_order_of_asking() {
    let (sender, mut receiver) = mailbox::<_, Backpressure>(room(1));
    sender.send(0).await.unwrap();
    let blocked: Vec<_> = (1..4)
        .map(|n| {
            let sender = sender.clone();
            tokio::spawn(async move { sender.send(n).await })
        })
        .collect();
    tokio::task::yield_now().await;
    assert!(blocked.iter().all(|sending| !sending.is_finished()));
    for expected in 0..4 {
        assert_eq!(
            timeout(WATCHDOG, receiver.recv()).await.unwrap(),
            Some(expected)
        );
    }
    assert_eq!(sender.dropped(), 0);
}

#[tokio::test(start_paused = true)]
async fn block_returns_the_message_when_the_receiver_goes() {
    let (sender, receiver) = mailbox::<_, Backpressure>(room(1));
    sender.send("kept").await.unwrap();
    let blocked = tokio::spawn({
        let sender = sender.clone();
        async move { sender.send("waiting").await }
    });
    tokio::task::yield_now().await;
    drop(receiver);
    let outcome = timeout(WATCHDOG, blocked).await.unwrap().unwrap();
    assert_eq!(outcome, Err(SendError::Closed("waiting")));
}

#[tokio::test(start_paused = true)]
async fn cancelled_send_takes_no_place_in_line() {
    let (sender, mut receiver) = mailbox::<_, Backpressure>(room(1));
    sender.send(1).await.unwrap();
    assert!(
        timeout(Duration::from_millis(1), sender.send(2))
            .await
            .is_err()
    );
    assert_eq!(receiver.recv().await, Some(1));
    timeout(WATCHDOG, sender.send(3)).await.unwrap().unwrap();
    assert_eq!(receiver.recv().await, Some(3));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn messages_across_threads_keep_their_order() {
    const N_SENDERS: usize = 4;
    const N_MESSAGES: usize = 5_000;
    let (sender, mut receiver) = mailbox::<_, Backpressure>(room(3));
    for source in 0..N_SENDERS {
        let sender = sender.clone();
        tokio::spawn(async move {
            for n in 0..N_MESSAGES {
                sender.send((source, n)).await.unwrap();
            }
        });
    }
    drop(sender);
    let mut next = [0; N_SENDERS];
    let receiving = async {
        while let Some((source, n)) = receiver.recv().await {
            assert_eq!(n, next[source]);
            next[source] += 1;
        }
    };
    timeout(WATCHDOG, receiving).await.unwrap();
    assert_eq!(next, [N_MESSAGES; N_SENDERS]);
}

#[tokio::test(start_paused = true)]
async fn a_full_mailbox_does_not_starve_other_tasks() {
    let (sender, mut receiver) = mailbox::<_, DropOldest>(room(1));
    sender.send(()).unwrap();
    let greedy = tokio::spawn({
        let sender = sender.clone();
        async move {
            while receiver.recv().await.is_some() {
                let _ = sender.send(());
            }
        }
    });
    // Reached only if the greedy task yields although it always has a message.
    tokio::task::yield_now().await;
    sender.close();
    timeout(WATCHDOG, greedy).await.unwrap().unwrap();
}
