//! Many tracks at once. What is asserted are counts; the figures are times.

use crate::daemon::{Daemon, Place, eventually};
use crate::recorder::{Recorded, SceneRecorder};
use message::TrackState;
use std::collections::BTreeSet;
use std::time::Duration;

/// Nanoseconds of a stage of a scene.
type Took = fn(&Recorded) -> u64;

/// Blocks on the table, and frames that are looked at once all are tracked.
const N_BLOCKS: usize = 200;
const N_FRAMES: usize = 60;

fn n_tracked(scene: &Recorded) -> usize {
    let is_tracked = |state: u32| TrackState::from_code(state) == Some(TrackState::Tracked);
    let objects = scene.items.iter();
    objects.filter(|object| is_tracked(object.state)).count()
}

fn ids(scene: &Recorded) -> BTreeSet<u64> {
    scene.items.iter().map(|object| object.track_id).collect()
}

fn start_crowd<'a>(place: &'a Place, n_blocks: usize, rate_hz: &str) -> Daemon<'a> {
    place.start(&["--source", &format!("crowd:{n_blocks}"), "--rate", rate_hz])
}

fn wait_for_tracks(scenes: &SceneRecorder, n: usize) {
    eventually("all blocks are tracked", || {
        scenes
            .last()
            .is_some_and(|last| n_tracked(&last) == n && last.items.len() == n)
    });
}

#[test]
fn two_hundred_tracks_at_once_keep_their_ids() {
    let place = Place::new();
    let scenes = SceneRecorder::start(&place);
    let daemon = start_crowd(&place, N_BLOCKS, "30");
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
    let told = daemon.ask(&["objects"]);
    assert_eq!(told["objects"].as_array().unwrap().len(), N_BLOCKS);
    assert_eq!(told["n_more"], 0);
    let health = daemon.health("perception").unwrap();
    assert_eq!(health["actors"], N_BLOCKS, "{health:#}");
    assert_eq!(health["restarts"], 0, "{health:#}");
    daemon.stop();
}

/// What a load costs, printed: `scripts/test --long` shows it.
#[test]
#[ignore = "long"]
fn long_figures_of_many_tracks_at_once() {
    for n_blocks in [50, 100, 150, 200, 250] {
        let place = Place::new();
        let scenes = SceneRecorder::start(&place);
        let daemon = start_crowd(&place, n_blocks, "30");
        wait_for_tracks(&scenes, n_blocks);
        let n_before = scenes.len();
        std::thread::sleep(Duration::from_secs(60));
        let (scenes, n_lost) = scenes.stop();
        daemon.stop();
        tell(n_blocks, &scenes[n_before..], n_lost);
    }
}

fn tell(n_blocks: usize, scenes: &[Recorded], n_lost: u64) {
    let sequence = |scene: &Recorded| scene.header.sequence;
    let n_frames = sequence(scenes.last().unwrap()) - sequence(&scenes[0]) + 1;
    let n_dropped = n_frames - scenes.len() as u64 - n_lost;
    let n_late: u32 = scenes.iter().map(|scene| scene.header.n_late).sum();
    let fewest = scenes.iter().map(n_tracked).min().unwrap();
    let stages: [(&str, Took); 4] = [
        ("end to end", |s| {
            s.header.stamps.published_ns - s.header.stamps.scheduled_ns
        }),
        ("detection", |s| {
            s.header.stamps.detected_ns - s.header.stamps.received_ns
        }),
        ("objects", |s| {
            s.header.stamps.recognised_ns - s.header.stamps.detected_ns
        }),
        ("publishing", |s| {
            s.header.stamps.published_ns - s.header.stamps.recognised_ns
        }),
    ];
    println!(
        "{n_blocks} blocks: {n_frames} frames, {n_dropped} dropped, {n_late} answers late, at least {fewest} tracked"
    );
    for (name, took) in stages {
        let mut ms: Vec<f64> = scenes.iter().map(|s| took(s) as f64 * 1e-6).collect();
        ms.sort_by(f64::total_cmp);
        let at = |share: f64| ms[((ms.len() - 1) as f64 * share) as usize];
        println!(
            "  {name}: p50 {:.1} ms, p99 {:.1} ms, most {:.1} ms",
            at(0.5),
            at(0.99),
            at(1.0)
        );
    }
}
