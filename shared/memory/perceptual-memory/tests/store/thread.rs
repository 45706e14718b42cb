//! Tests of the store thread: order, group commit, full queue, stop.

use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use learning::TeachingError;
use perceptual_memory::{Error, MutationReceipt, StoreConfig, StoreHandle, StoreThread};
use tempfile::TempDir;

use crate::builders::{
    answer, correct, counts, fast_folder, folder, lesson, name_of, open, store as store_views,
    teach, view,
};

/// Watchdog timeout: a deadlock becomes a failure.
const WATCHDOG: Duration = Duration::from_secs(60);

/// Number of track-ids leased for each test, from one on.
const N_LEASED: u64 = 20;

fn start(folder: &TempDir, queue_capacity: usize) -> (StoreThread, StoreHandle) {
    let config = StoreConfig {
        folder: folder.path().to_owned(),
        queue_capacity,
        limits: perceptual_memory::RetentionLimits::default(),
        write_buffer_bytes: perceptual_memory::WRITE_BUFFER_BYTES,
        wall_clock: || 1,
        on_reopened: Box::new(|_| {}),
        on_notice: Box::new(|_| {}),
    };
    let (thread, handle, _) = StoreThread::start(config).unwrap();
    handle.lease_track_ids_and_wait(N_LEASED).unwrap();
    (thread, handle)
}

/// Blocks the store thread until the returned sender is dropped.
fn occupy(handle: &StoreHandle) -> std::sync::mpsc::Sender<()> {
    let (release, released) = channel::<()>();
    let (started_sender, started) = channel();
    handle.read(
        move |_| {
            started_sender.send(()).unwrap();
            let _ = released.recv_timeout(WATCHDOG);
            Ok(())
        },
        |_| {},
    );
    started.recv_timeout(WATCHDOG).unwrap();
    release
}

#[test]
fn group_commit_keeps_the_order() {
    let folder = folder();
    let (thread, handle) = start(&folder, 64);
    let release = occupy(&handle);
    let (sender, answers): (_, Receiver<(u32, Result<MutationReceipt, Error>)>) = channel();
    let group = [
        store_views(1, vec![view(1, 0, 0)]),
        teach(2, 1, "Mug"),
        teach(3, 1, "Cup"),
        correct(4, 1, "Cup"),
        teach(2, 1, "Mug"),
        teach(5, 9, "Mug"),
    ];
    for (i, mutation) in (0..).zip(group) {
        let sender = sender.clone();
        handle.mutate(mutation, move |answer| sender.send((i, answer)).unwrap());
    }
    drop(release);
    let next = || answers.recv_timeout(WATCHDOG).unwrap();
    for (i, sequence) in [(0, 1), (1, 2)] {
        let (told, given) = next();
        assert_eq!((told, given.unwrap()), (i, answer(sequence, 1)));
    }
    assert!(next().1.unwrap().contradiction.is_some());
    assert_eq!(next().1.unwrap(), answer(4, 1));
    assert_eq!(
        next().1.unwrap(),
        answer(2, 1),
        "the repeated one gets its first answer"
    );
    assert_eq!(lesson(next().1), TeachingError::NoViews { track_id: 9 });
    thread.stop().unwrap();
    let (memory, _) = open(&folder);
    assert_eq!(
        (memory.sequence(), counts(&memory)),
        (4, vec![("Cup".to_owned(), 1)])
    );
}

#[test]
fn read_sees_all_earlier_mutations() {
    let folder = fast_folder();
    let (_thread, handle) = start(&folder, 64);
    let release = occupy(&handle);
    handle.mutate(store_views(1, vec![view(1, 0, 0)]), |_| {});
    let (sender, receiver) = channel();
    handle.read(
        |memory| memory.views_of_track(1),
        move |views| sender.send(views).unwrap(),
    );
    handle.mutate(teach(2, 1, "Mug"), |_| {});
    drop(release);
    let views = receiver.recv_timeout(WATCHDOG).unwrap().unwrap();
    assert_eq!((views.len(), name_of(&views[0])), (1, None));
    assert_eq!(
        handle
            .read_and_wait(|memory| Ok(counts(memory)))
            .unwrap()
            .len(),
        1
    );
    assert_eq!(handle.lease_track_ids_and_wait(3).unwrap(), 1 + N_LEASED);
}

#[test]
fn full_queue_is_an_error_of_the_caller() {
    let folder = fast_folder();
    let (_thread, handle) = start(&folder, 2);
    let release = occupy(&handle);
    let (sender, answers) = channel();
    for id in 1..=2 {
        let sender = sender.clone();
        handle.mutate(store_views(id, vec![view(id as u64, 0, 0)]), move |a| {
            sender.send(a).unwrap();
        });
    }
    let refused = handle
        .mutate_and_wait(store_views(3, vec![view(3, 0, 0)]))
        .unwrap_err();
    assert!(
        matches!(refused, Error::QueueFull { capacity: 2 }),
        "{refused}"
    );
    assert!(matches!(
        handle.lease_track_ids_and_wait(1),
        Err(Error::QueueFull { .. })
    ));
    assert!(matches!(
        handle.read_and_wait(|_| Ok(())),
        Err(Error::QueueFull { .. })
    ));
    drop(release);
    for _ in 0..2 {
        answers.recv_timeout(WATCHDOG).unwrap().unwrap();
    }
    assert_eq!(
        handle
            .read_and_wait(|memory| Ok(memory.sequence()))
            .unwrap(),
        2
    );
}

#[test]
fn stop_serves_waiting_requests_and_refuses_later_ones() {
    let folder = fast_folder();
    let (thread, handle) = start(&folder, 64);
    let release = occupy(&handle);
    let (sender, answers) = channel();
    for id in 1..=20 {
        let sender = sender.clone();
        handle.mutate(store_views(id, vec![view(id as u64, 0, 0)]), move |a| {
            sender.send(a).unwrap();
        });
    }
    let stopping = std::thread::spawn(move || thread.stop());
    drop(release);
    stopping.join().unwrap().unwrap();
    for _ in 0..20 {
        answers.recv_timeout(WATCHDOG).unwrap().unwrap();
    }
    assert!(matches!(
        handle.lease_track_ids_and_wait(1),
        Err(Error::Stopped)
    ));
    let (memory, report) = open(&folder);
    assert!(!report.is_loss());
    assert_eq!(memory.sequence(), 20);
}

#[test]
fn request_during_stop_is_answered_once() {
    for _ in 0..20 {
        let folder = fast_folder();
        let (thread, handle) = start(&folder, 8);
        let (sender, answers) = channel();
        let n_asked: usize = std::thread::scope(|scope| {
            let askers: Vec<_> = (0..4)
                .map(|_| {
                    let (handle, sender) = (handle.clone(), sender.clone());
                    scope.spawn(move || {
                        for n_asked in 1.. {
                            let sender = sender.clone();
                            let (told, telling) = channel();
                            handle.lease_track_ids(1, move |answer| {
                                let is_stopped = matches!(answer, Err(Error::Stopped));
                                sender.send(()).unwrap();
                                let _ = told.send(is_stopped);
                            });
                            if telling.recv_timeout(WATCHDOG).unwrap() {
                                return n_asked;
                            }
                        }
                        0
                    })
                })
                .collect();
            thread.stop().unwrap();
            askers.into_iter().map(|asker| asker.join().unwrap()).sum()
        });
        assert_eq!(answers.try_iter().count(), n_asked);
    }
}

#[test]
fn panic_in_a_read_or_reply_is_contained() {
    let folder = fast_folder();
    let (_thread, handle) = start(&folder, 8);
    let panicked = handle.read_and_wait(|_| -> Result<(), Error> { panic!("meant by the test") });
    assert!(matches!(panicked, Err(Error::Stopped)), "{panicked:?}");
    handle.mutate(store_views(1, vec![view(1, 0, 0)]), |_| {
        panic!("meant by the test")
    });
    assert_eq!(
        handle.mutate_and_wait(teach(2, 1, "Mug")).unwrap().sequence,
        2
    );
}

#[test]
fn limits_are_replaced_while_the_thread_runs() {
    let folder = fast_folder();
    let (thread, handle) = start(&folder, 8);
    let n_unnamed_after = |tracks: std::ops::RangeInclusive<u64>| {
        for track in tracks {
            let stored = store_views(u128::from(track), vec![view(track, 0, 0)]);
            handle.mutate_and_wait(stored).unwrap();
        }
        handle
            .read_and_wait(|memory| memory.stats())
            .unwrap()
            .n_unnamed
    };
    assert_eq!(n_unnamed_after(1..=12), 12);
    handle.set_limits(perceptual_memory::RetentionLimits {
        max_unnamed_views: 10,
        ..perceptual_memory::RetentionLimits::default()
    });
    assert_eq!(n_unnamed_after(13..=13), 9);
    thread.stop().unwrap();
}
