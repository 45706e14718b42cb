//! Supervision of object actors: a panic costs other tracks nothing, and too many restart
//! the process.

use crate::daemon::{Daemon, Sandbox, eventually};
use crate::recorder::{RecordedScene, Recorder, SceneRecorder};
use crate::skeleton::wait_for_all;
use channel::topic::ActorEvents;
use message::{ActorEvent, ActorEventKind, ProcessKind, SceneObject};
use serde_json::Value;
use std::collections::BTreeMap;

/// The synthetic table at a low rate, since several daemons share the cores.
const TABLE: [&str; 4] = ["--source", "synthetic:0", "--rate", "10"];
/// Track whose actor panics: the first id of a new memory.
const FAULTY_TRACK: u64 = 1;

/// Deadline of a frame for its actors, milliseconds: the time that a frame would take if
/// it waited for an actor that has panicked.
const DEADLINE_MS: u64 = 60_000;

/// Configuration with a panic of one actor every second.
fn configure(sandbox: &Sandbox, restarts_max: u32, window_s: f64) {
    let text = format!(
        "[perception]\n\
         actor_restarts_max = {restarts_max}\n\
         actor_restart_window_s = {window_s:?}\n\
         # No answer is late on a busy computer.\n\
         actor_deadline_ms = {DEADLINE_MS}\n\
         fault_panic_every_ms = 1000\n\
         fault_panic_track_id = {FAULTY_TRACK}\n"
    );
    std::fs::write(sandbox.home().join("tabula.toml"), text).unwrap();
}

fn others(scene: &RecordedScene) -> impl Iterator<Item = &SceneObject> {
    let is_other = |object: &&SceneObject| object.track_id != FAULTY_TRACK;
    scene.items.iter().filter(is_other)
}

fn sequence(scene: &RecordedScene) -> u64 {
    scene.header.sequence
}

/// Asserts that from scene to scene each track but the faulty one has one view more.
fn check_gapless(scenes: &[RecordedScene]) {
    for pair in scenes.windows(2) {
        let [before, after] = [&pair[0], &pair[1]];
        let views: BTreeMap<u64, u32> = others(before)
            .map(|object| (object.track_id, object.n_views))
            .collect();
        for object in others(after) {
            let expected = views.get(&object.track_id).map_or(1, |n| n + 1);
            assert_eq!(
                object.n_views,
                expected,
                "track {} in frame {}",
                object.track_id,
                sequence(after)
            );
        }
        assert!(after.header.n_late <= 1);
    }
}

fn of_kind(events: &[ActorEvent], kind: ActorEventKind) -> Vec<&ActorEvent> {
    events
        .iter()
        .filter(|event| event.kind() == Some(kind))
        .collect()
}

/// Frames that the faulty track has lost by panics, from the log.
fn frames_in_log(daemon: &Daemon<'_>) -> Vec<u64> {
    let printed = format!("the actor of track {FAULTY_TRACK} starts again");
    let frame = |line: &str| {
        let (_, rest) = line.split_once("(at frame ")?;
        rest.split(',').next()?.parse().ok()
    };
    let log = daemon.log();
    let lines = log.lines().filter(|line| line.contains(&printed));
    lines
        .map(|line| frame(line).unwrap_or_else(|| panic!("{line}")))
        .collect()
}

fn items(events: Vec<crate::recorder::RecordedMessage<ActorEvents>>) -> Vec<ActorEvent> {
    events.into_iter().flat_map(|event| event.items).collect()
}

/// Asserts that health, log and events agree, and returns the number of restarts.
fn check_agreement(daemon: &Daemon<'_>, events: &[ActorEvent]) -> u64 {
    let restarting = of_kind(events, ActorEventKind::Restarting);
    for (i, event) in restarting.iter().enumerate() {
        assert_eq!(event.track_id, FAULTY_TRACK, "{event:?}");
        assert_eq!(event.n_restarts, i as u64 + 1, "{event:?}");
        assert_eq!(
            event.cause.as_str(),
            Some("it panicked: a fault on purpose")
        );
    }
    assert!(events.iter().all(|event| event.n_lost == 0));
    let frames: Vec<u64> = restarting
        .iter()
        .map(|event| event.frame().unwrap())
        .collect();
    // The next one may have been logged meanwhile.
    assert!(frames_in_log(daemon).starts_with(&frames));
    restarting.len() as u64
}

/// Number of actor restarts that were published.
fn n_restarts(events: &Recorder<ActorEvents>) -> u64 {
    let mut n_restarts = 0;
    events.is(|events| {
        let all = events.iter().flat_map(|event| &event.items);
        let restarting = Some(ActorEventKind::Restarting);
        n_restarts = all.filter(|event| event.kind() == restarting).count() as u64;
        true
    });
    n_restarts
}

/// Panics below the restart limit: the other tracks lose nothing.
fn panic_every_second(n_panics: u64) {
    let sandbox = Sandbox::with_faulty_perception();
    configure(&sandbox, 5, 2.0);
    let events = Recorder::<ActorEvents>::start(&sandbox);
    let daemon = sandbox.start(&TABLE);
    wait_for_all(&daemon, 0);
    let scenes = SceneRecorder::start(&sandbox);
    let before = n_restarts(&events);
    while n_restarts(&events) < before + n_panics {
        let n_now = n_restarts(&events);
        eventually("the actor panics again", || n_restarts(&events) > n_now);
    }
    let (scenes, n_lost_scenes) = scenes.stop();
    // Health, log and events report the past restarts with a delay.
    let restarts = || {
        daemon.health("perception").unwrap()["restarts"]
            .as_u64()
            .unwrap()
    };
    eventually("health, log and events agree", || {
        let n_published = n_restarts(&events);
        n_published == restarts() && n_published == frames_in_log(&daemon).len() as u64
    });
    let health = daemon.health("perception").unwrap();
    let (events, n_lost_events) = events.stop();
    assert_eq!((n_lost_scenes, n_lost_events), (0, 0));
    check_agreement(&daemon, &items(events));
    check_gapless(&scenes);
    let took_ns = |scene: &RecordedScene| {
        let stamps = &scene.header.stamps;
        stamps.recognised_ns - stamps.detected_ns
    };
    let longest_ns = scenes.iter().map(took_ns).max().unwrap();
    assert!(
        longest_ns < DEADLINE_MS * 1_000_000,
        "a frame waited for the actor that had panicked: {longest_ns} ns"
    );
    assert_eq!(health["actors"], 5, "{health:#}");
    let faulty = |scene: &RecordedScene| {
        let track = scene
            .items
            .iter()
            .find(|object| object.track_id == FAULTY_TRACK);
        track.map(|track| track.n_views)
    };
    let [first, last] = [&scenes[0], scenes.last().unwrap()].map(faulty);
    assert!(last > first, "the faulty actor has described nothing more");
    daemon.stop();
}

#[test]
fn panic_every_second_costs_other_tracks_no_frame() {
    panic_every_second(15);
}

#[test]
#[ignore = "long"]
fn long_panic_every_second_costs_other_tracks_no_frame() {
    panic_every_second(280);
}

/// Waits until perception runs as another process.
fn wait_for_another(daemon: &Daemon<'_>, before: u32) {
    eventually("perception is started again", || {
        daemon
            .pid(ProcessKind::PERCEPTION)
            .is_some_and(|pid| pid != before)
    });
}

#[test]
fn panics_above_the_restart_limit_restart_the_process() {
    const MAX: u32 = 3;
    let sandbox = Sandbox::with_faulty_perception();
    configure(&sandbox, MAX, 3600.0);
    let events = Recorder::<ActorEvents>::start(&sandbox);
    let daemon = sandbox.start(&TABLE);
    wait_for_all(&daemon, 0);
    let before = daemon.pid(ProcessKind::PERCEPTION).unwrap();
    wait_for_another(&daemon, before);
    // The new tracks have other ids: nothing panics any more.
    wait_for_all(&daemon, 0);
    let (events, n_lost) = events.stop();
    let events = items(events);
    let (of_first, of_second): (Vec<ActorEvent>, Vec<ActorEvent>) =
        events.into_iter().partition(|event| event.pid == before);
    assert_eq!(n_lost, 0);
    assert_eq!(check_agreement(&daemon, &of_first), u64::from(MAX));
    let escalated = of_kind(&of_first, ActorEventKind::Escalated);
    assert_eq!(escalated.len(), 1);
    assert_eq!(escalated[0].track_id, FAULTY_TRACK);
    let last = of_first.last().unwrap();
    assert_eq!(last.kind(), Some(ActorEventKind::Escalated), "{last:?}");
    assert_eq!(of_kind(&of_second, ActorEventKind::Restarting).len(), 0);
    assert_eq!(of_kind(&of_second, ActorEventKind::Started).len(), 5);
    assert_eq!(frames_in_log(&daemon).len(), MAX as usize);
    eventually("its readiness is reported", || {
        daemon.log().contains("tabula-perception runs again")
    });
    check_log(&daemon.log(), MAX, escalated[0].frame().unwrap());
    let health: Value = daemon.health("perception").unwrap();
    assert_eq!(health["restarts"], 0, "{health:#}");
    daemon.stop();
}

fn check_log(log: &str, max: u32, frame: u64) {
    let escalation = format!(
        "the object actors needed more than {max} restarts within 3600 s, the last one the actor of \
         track {FAULTY_TRACK}: it panicked: a fault on purpose (at frame {frame}, which it loses)"
    );
    for printed in [
        escalation.as_str(),
        "tabula-perception has ended (exit status: 1); starting it again",
        "tabula-perception runs again",
    ] {
        assert_eq!(log.matches(printed).count(), 1, "{printed}\n{log}");
    }
}
