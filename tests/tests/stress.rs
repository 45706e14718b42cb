//! Stress test: many tracks at once keep their ids.

use crate::daemon::{Daemon, Sandbox, eventually};
use crate::recorder::{RecordedScene, SceneRecorder};
use message::TrackState;
use std::collections::BTreeSet;

/// Number of blocks on the table, and of frames after all are tracked.
const N_BLOCKS: usize = 200;
const N_FRAMES: usize = 60;

fn n_tracked(scene: &RecordedScene) -> usize {
    let is_tracked = |state: u32| TrackState::from_code(state) == Some(TrackState::Tracked);
    let objects = scene.items.iter();
    objects.filter(|object| is_tracked(object.state)).count()
}

fn ids(scene: &RecordedScene) -> BTreeSet<u64> {
    scene.items.iter().map(|object| object.track_id).collect()
}

fn start_crowd<'a>(sandbox: &'a Sandbox, n_blocks: usize, rate_hz: &str) -> Daemon<'a> {
    sandbox.start(&["--source", &format!("crowd:{n_blocks}"), "--rate", rate_hz])
}

fn wait_for_tracks(scenes: &SceneRecorder, n: usize) {
    eventually("all blocks are tracked", || {
        scenes
            .last()
            .is_some_and(|last| n_tracked(&last) == n && last.items.len() == n)
    });
}

#[test]
fn tracks_keep_their_ids_among_two_hundred() {
    let sandbox = Sandbox::new();
    let scenes = SceneRecorder::start(&sandbox);
    let daemon = start_crowd(&sandbox, N_BLOCKS, "30");
    wait_for_tracks(&scenes, N_BLOCKS);
    let n_before = scenes.len();
    scenes.wait_for("further frames", |scenes| {
        scenes.len() >= n_before + N_FRAMES
    });
    let (scenes, _) = scenes.stop();
    let all: BTreeSet<u64> = ids(&scenes[n_before - 1]);
    assert_eq!(all.len(), N_BLOCKS);
    for scene in &scenes[n_before..] {
        let lost: Vec<_> = all.difference(&ids(scene)).copied().collect();
        let new: Vec<_> = ids(scene).difference(&all).copied().collect();
        let sequence = scene.header.sequence;
        assert!(
            lost.is_empty() && new.is_empty(),
            "frame {sequence}: {lost:?} {new:?}"
        );
        assert_eq!(scene.header.n_objects_total as usize, N_BLOCKS);
    }
    let reported = daemon.ask(&["objects"]);
    assert_eq!(reported["objects"].as_array().unwrap().len(), N_BLOCKS);
    assert_eq!(reported["n_more"], 0);
    let health = daemon.health("perception").unwrap();
    assert_eq!(health["actors"], N_BLOCKS, "{health:#}");
    assert_eq!(health["restarts"], 0, "{health:#}");
    daemon.stop();
}
