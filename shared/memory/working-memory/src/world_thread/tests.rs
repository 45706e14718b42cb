use std::fs;
use std::sync::mpsc::{Receiver, channel};

use tempfile::TempDir;

use super::*;
use crate::tests::{CONFIG, sighting};
use crate::{FactQuery, Subject};

const PATIENCE: Duration = Duration::from_secs(20);
const NOW_NS: u64 = 1_000_000_000_000;

type Trouble = Receiver<Result<(), String>>;

fn start(folder: &TempDir) -> (WorldThread, WorldHandle, Receiver<u64>, Trouble) {
    let (written, versions) = channel();
    let (trouble, troubles) = channel();
    let config = WorldThreadConfig {
        folder: folder.path().to_owned(),
        world: CONFIG,
        period: Duration::from_millis(5),
        wall_clock: || NOW_NS,
        on_written: Box::new(move |version| {
            // The last ones may arrive after the receiver has gone.
            let _ = written.send(version);
        }),
        on_trouble: Box::new(move |told| {
            let told = told.as_ref().map(|_| ()).map_err(ToString::to_string);
            drop(trouble.send(told));
        }),
    };
    let (thread, handle, _) = WorldThread::start(config).unwrap();
    (thread, handle, versions, troubles)
}

/// Observes one more object; returns the resulting model version.
fn see(handle: &WorldHandle, track_id: u64) -> u64 {
    handle.with(|model| {
        let seen = (track_id, 0, 1, 0);
        model.observe([sighting(&seen, NOW_NS)], false, NOW_NS);
        model.version()
    })
}

fn wait_until_written(versions: &Receiver<u64>, version: u64) {
    while versions.recv_timeout(PATIENCE).unwrap() < version {}
}

fn is_known(handle: &WorldHandle, track_id: u64) -> bool {
    let query = FactQuery {
        subject: Some(Subject::Object(track_id)),
        label: None,
        region: None,
        window: None,
        before: None,
        n_most: 1,
    };
    handle.with(|model| !model.facts(&query).facts.is_empty())
}

#[test]
fn written_changes_survive_without_a_stop() {
    let folder = tempfile::tempdir_in("/dev/shm").unwrap();
    let (thread, handle, versions, _) = start(&folder);
    wait_until_written(&versions, see(&handle, 1));
    let copy = tempfile::tempdir_in("/dev/shm").unwrap();
    fs::create_dir(copy.path().join("database")).unwrap();
    for entry in fs::read_dir(folder.path().join("database"))
        .unwrap()
        .flatten()
    {
        fs::copy(
            entry.path(),
            copy.path().join("database").join(entry.file_name()),
        )
        .unwrap();
    }
    let (_other, other, ..) = start(&copy);
    assert!(is_known(&other, 1) && !is_known(&other, 2));
    thread.stop().unwrap();
}

#[test]
fn loaded_version_is_reported_as_written() {
    let folder = tempfile::tempdir_in("/dev/shm").unwrap();
    let (thread, handle, versions, _) = start(&folder);
    wait_until_written(&versions, handle.with(|model| model.version()));
    thread.stop().unwrap();
}

#[test]
fn stop_writes_waiting_changes() {
    let folder = tempfile::tempdir_in("/dev/shm").unwrap();
    let (thread, handle, ..) = start(&folder);
    for track_id in 1..300 {
        see(&handle, track_id);
    }
    thread.stop().unwrap();
    let (_thread, handle, ..) = start(&folder);
    assert!((1..300).all(|track_id| is_known(&handle, track_id)));
}

#[test]
fn failed_database_is_rewritten_from_the_model() {
    let folder = tempfile::tempdir_in("/dev/shm").unwrap();
    let (thread, handle, versions, troubles) = start(&folder);
    wait_until_written(&versions, see(&handle, 1));
    let database = folder.path().join("database");
    // As if the disk had lost it: nothing can be made in a folder that is not there.
    handle.with(|_| fs::rename(&database, folder.path().join("lost")).unwrap());
    let mut track_id = 2;
    while troubles.try_recv().is_err() {
        see(&handle, track_id);
        track_id += 1;
        std::thread::sleep(Duration::from_millis(1));
        assert!(track_id < 20_000, "no write failed");
    }
    let version = see(&handle, track_id);
    assert_eq!(troubles.recv_timeout(PATIENCE), Ok(Ok(())));
    wait_until_written(&versions, version);
    thread.stop().unwrap();
    let (_thread, handle, ..) = start(&folder);
    assert!(is_known(&handle, 1) && is_known(&handle, track_id));
}
