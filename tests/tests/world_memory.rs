//! Working memory: facts survive a kill, and end when their object was last seen.

use crate::daemon::{Daemon, KilledOnDrop, Sandbox, WATCHDOG, WITH_CAMERA, eventually, nearest};
use crate::skeleton::{id, place_of, wait_for_all};
use control_protocol::{
    Command, MutationId, RecordedStep, RefusalKind, Reply, TaskOutcome, WorldCommand, WorldReply,
    request,
};
use daemon_client::DaemonClient;
use message::ProcessKind;
use rustix::process::{Pid, Signal, kill_process};
use scene_document::{EventsDocument, TaskDocument};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

fn list(document: &Value, name: &str) -> Vec<Value> {
    document[name].as_array().unwrap().clone()
}

fn world(daemon: &Daemon<'_>) -> Vec<Value> {
    let output = daemon.sandbox.tabula(&["world", "--json"]);
    let document: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    document["objects"].as_array().cloned().unwrap_or_default()
}

fn facts(daemon: &Daemon<'_>, arguments: &[&str]) -> Vec<Value> {
    let document = daemon.ask(&[&["world", "history"], arguments].concat());
    list(&document, "facts")
}

fn events(daemon: &Daemon<'_>) -> Vec<Value> {
    list(&daemon.ask(&["world", "events"]), "events")
}

fn n_events(events: &[Value], kind: &str) -> usize {
    events.iter().filter(|event| event["event"] == kind).count()
}

/// Kills the memory, and waits until its replacement answers.
fn kill_memory(daemon: &Daemon<'_>) {
    let killed = daemon.pid(ProcessKind::MEMORY);
    daemon.signal(ProcessKind::MEMORY, Signal::KILL);
    eventually("another memory answers", || {
        daemon
            .pid(ProcessKind::MEMORY)
            .is_some_and(|pid| Some(pid) != killed)
    });
}

/// Waits until the working memory has a number of objects.
fn wait_for_world(daemon: &Daemon<'_>, n_objects: usize) {
    eventually("the working memory sees the objects", || {
        world(daemon).len() == n_objects
    });
}

/// Waits until the working memory is on disk: the start of a task is answered only then.
fn wait_until_written(sandbox: &Sandbox) {
    task(&mut connect(sandbox), start_task()).unwrap();
}

#[test]
fn facts_survive_a_kill_and_end_when_their_object_was_last_seen() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let objects = wait_for_all(&daemon, 0);
    wait_for_world(&daemon, objects.len());
    let bowl = nearest(&objects, place_of(0, "bowl"));
    let track = id(bowl);
    daemon.ask(&["teach", &track, "bowl"]);
    eventually("the label is a fact", || {
        !facts(&daemon, &["--track", &track, "--label", "bowl"]).is_empty()
    });
    let before = facts(&daemon, &["--track", &track]);
    let property = |facts: &[Value], name: &str| {
        let found = facts.iter().find(|fact| fact["property"] == name);
        found
            .unwrap_or_else(|| panic!("{name} in {facts:#?}"))
            .clone()
    };
    let (label, place_then) = (property(&before, "label"), property(&before, "place"));
    assert_eq!(label["value"], "bowl");
    assert_eq!(label["end_ns"], Value::Null);
    wait_until_written(&sandbox);
    kill_memory(&daemon);
    wait_for_world(&daemon, objects.len());

    let after = facts(&daemon, &["--track", &track]);
    for known in [&label, &place_then] {
        let found = after.iter().find(|fact| fact["fact"] == known["fact"]);
        let found = found.unwrap_or_else(|| panic!("{known} in {after:#?}"));
        assert_eq!(found["value"], known["value"]);
        assert_eq!(found["start_ns"], known["start_ns"]);
        let (start, end) = (found["start_ns"].as_u64(), found["end_ns"].as_u64());
        assert!(end >= start, "ended: {found}");
    }
    let holds = property(&after, "label");
    assert_eq!(holds["end_ns"], Value::Null, "it is seen again: {after:#?}");
    let seen = events(&daemon);
    assert_eq!(n_events(&seen, "started"), 2, "{seen:#?}");
    assert_eq!(n_events(&seen, "appeared"), objects.len(), "{seen:#?}");
    assert_eq!(n_events(&seen, "taught"), 1, "{seen:#?}");
    daemon.stop();

    // Another session: all that was known of the tracks before is over.
    let daemon = sandbox.start(&["--source", "synthetic:1"]);
    wait_for_all(&daemon, 1);
    let kept = facts(&daemon, &["--track", &track]);
    assert!(kept.len() >= after.len(), "{kept:#?}");
    assert!(kept.iter().all(|fact| fact["end_ns"].is_u64()), "{kept:#?}");
    daemon.stop();
}

#[test]
fn facts_are_queried_by_label_position_and_time() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let objects = wait_for_all(&daemon, 0);
    wait_for_world(&daemon, objects.len());
    let mug = place_of(0, "mug");
    let track = id(nearest(&objects, mug));
    let near = format!("{},{},{}", mug[0], mug[1], mug[2]);
    let tracks = |facts: &[Value]| {
        let mut tracks: Vec<String> = facts
            .iter()
            .filter(|fact| fact["subject"] == "object")
            .map(|fact| fact["track_id"].to_string())
            .collect();
        tracks.sort();
        tracks.dedup();
        tracks
    };
    let there = facts(&daemon, &["--near", &near, "--radius", "0.06"]);
    assert_eq!(tracks(&there), [track.as_str()], "{there:#?}");
    // A day ago there was no table; now there are all.
    assert!(facts(&daemon, &["--at", "-1d"]).is_empty());
    assert_eq!(
        tracks(&facts(&daemon, &["--since", "-1d"])).len(),
        objects.len()
    );
    let (code, sentence) = daemon.refused(&["world", "history", "--at", "noon"]);
    assert!(code == 2 && sentence.contains("-10m"), "{sentence}");
    let (code, sentence) =
        daemon.refused(&["world", "history", "--since", "-1m", "--until", "-2m"]);
    assert!(code == 4 && sentence.contains("lies before"), "{sentence}");
    // A page after the other is the whole.
    let all = facts(&daemon, &["--limit", "1000"]);
    assert!(facts(&daemon, &["--limit", "2"]).len() == 2 && all.len() > 2);
    daemon.stop();
}

#[test]
fn events_are_followed_as_they_happen() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let objects = wait_for_all(&daemon, 0);
    wait_for_world(&daemon, objects.len());
    let mut follower = sandbox.command("tabula");
    follower.args(["world", "events", "--follow", "--since", "0", "--json"]);
    let mut follower = KilledOnDrop(follower.stdout(Stdio::piped()).spawn().unwrap());
    let lines = BufReader::new(follower.0.stdout.take().unwrap()).lines();
    let (sender, reported) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        for line in lines.map_while(Result::ok) {
            let event: Value = serde_json::from_str(&line).unwrap();
            if sender.send(event).is_err() {
                return;
            }
        }
    });
    let wait_for = |kind: &str| loop {
        let event = reported.recv_timeout(WATCHDOG).unwrap();
        if event["event"] == kind {
            return event;
        }
    };
    assert_eq!(wait_for("started")["sequence"], 1);
    daemon.ask(&["teach", &id(&objects[0]), "thing", "--author", "anna"]);
    let taught = wait_for("taught");
    assert!(taught["sentence"].as_str().unwrap().contains("anna"));
    kill_memory(&daemon);
    wait_for("started");
    drop(follower);
    daemon.stop();
}

/// Starts a memory beside a gateway, and waits until it answers.
fn start_memory(sandbox: &Sandbox) -> KilledOnDrop {
    let alone = sandbox.start_program("tabula-memory");
    eventually("the memory answers", || {
        sandbox.tabula(&["world"]).status.success()
    });
    alone
}

fn connect(sandbox: &Sandbox) -> DaemonClient {
    DaemonClient::connect(&sandbox.domain, &[sandbox.run_folder()], WATCHDOG).unwrap()
}

fn task(client: &mut DaemonClient, command: WorldCommand) -> Result<TaskDocument, RefusalKind> {
    match client.call(Command::World(command)).unwrap() {
        Reply::World(WorldReply::Task(task)) => Ok(*task),
        Reply::Refused(refusal) => Err(refusal.kind),
        other => panic!("{other:?}"),
    }
}

fn start_task() -> WorldCommand {
    WorldCommand::StartTask {
        id: MutationId(1),
        kind: "clear_table".into(),
        parameters: "{}".into(),
        author: "executive".into(),
    }
}

fn end_task(id: u128, task_id: u64) -> WorldCommand {
    WorldCommand::EndTask {
        id: MutationId(id),
        task_id,
        outcome: TaskOutcome::Failed,
        reason: "the mug slipped".into(),
    }
}

fn events_since(client: &mut DaemonClient, since: u64, wait_ms: u64) -> EventsDocument {
    client.ask(&request::events(since, wait_ms)).unwrap()
}

#[test]
fn task_is_recorded_once_and_survives_the_memory_process() {
    let sandbox = Sandbox::new();
    // Nobody looks at anything, so that only the task happens.
    let _gateway = sandbox.start_program("tabula-gateway");
    let memory = start_memory(&sandbox);
    let mut client = connect(&sandbox);
    let started = task(&mut client, start_task()).unwrap();
    assert_eq!((started.task_id, started.state.as_str()), (1, "running"));
    assert_eq!(task(&mut client, start_task()), Ok(started.clone()));
    let newest = events_since(&mut client, 0, 0).newest;
    assert_eq!(events_since(&mut client, newest, 10).events, []);
    let waiting = std::thread::spawn({
        let mut client = connect(&sandbox);
        move || loop {
            let events = events_since(&mut client, newest, 20_000).events;
            if !events.is_empty() {
                return events;
            }
        }
    });
    let ended = task(&mut client, end_task(2, 1)).unwrap();
    assert_eq!(ended.state, "failed");
    let reported = waiting.join().unwrap();
    assert_eq!(reported[0].event, "task_failed");
    assert!(
        reported[0].sentence.contains("the mug slipped"),
        "{reported:?}"
    );

    drop(memory);
    let mut memory = start_memory(&sandbox);
    let mut client = connect(&sandbox);
    // Acknowledged changes are on disk: a retry is answered, not executed again.
    assert_eq!(task(&mut client, end_task(2, 1)), Ok(ended));
    assert_eq!(
        task(&mut client, end_task(3, 1)),
        Err(RefusalKind::Conflict)
    );
    assert_eq!(
        task(&mut client, end_task(4, 77)),
        Err(RefusalKind::NotFound)
    );
    kill_process(Pid::from_child(&memory.0), Signal::TERM).unwrap();
    assert!(memory.0.wait().unwrap().success());
}

/// Records a step of the first task.
fn record(
    client: &mut DaemonClient,
    number: u64,
    state: &str,
    primitive: &str,
) -> Result<TaskDocument, RefusalKind> {
    let step = RecordedStep {
        number,
        state: state.into(),
        primitive: primitive.into(),
        track_id: 7,
        label: Some("mug".into()),
        place: Some("shelf".into()),
        attempt: number as u32,
        reason: if state == "failed" { "it slipped" } else { "" }.into(),
        plan: format!(r#"{{"grasp": {number}}}"#),
    };
    task(client, WorldCommand::RecordStep { task_id: 1, step })
}

#[test]
fn steps_of_a_task_survive_a_kill_and_go_on() {
    let sandbox = Sandbox::new();
    let _gateway = sandbox.start_program("tabula-gateway");
    let memory = start_memory(&sandbox);
    let mut client = connect(&sandbox);
    task(&mut client, start_task()).unwrap();
    let newest = events_since(&mut client, 0, 0).newest;
    record(&mut client, 1, "running", "reach").unwrap();
    record(&mut client, 1, "failed", "lift").unwrap();
    record(&mut client, 2, "running", "approach").unwrap();
    let held = record(&mut client, 2, "held", "lift").unwrap();
    assert_eq!(record(&mut client, 2, "held", "lift"), Ok(held));
    let whole = client.ask(&request::task(1)).unwrap();

    // Killed: an executive that starts anew finds the plan of the step that holds its object.
    drop(memory);
    let _memory = start_memory(&sandbox);
    let mut client = connect(&sandbox);
    let found = client.ask(&request::task(1)).unwrap();
    assert_eq!(found, whole);
    let states: Vec<_> = found.steps.iter().map(|step| step.state.as_str()).collect();
    assert_eq!(
        (states, found.state.as_str()),
        (vec!["failed", "held"], "running")
    );
    assert_eq!(found.steps[1].plan, r#"{"grasp": 2}"#);
    assert_eq!(
        record(&mut client, 1, "running", "reach"),
        Err(RefusalKind::Conflict)
    );
    assert_eq!(
        record(&mut client, 3, "running", "reach"),
        Err(RefusalKind::Conflict)
    );
    assert_eq!(
        record(&mut client, 2, "lost", "lift"),
        Err(RefusalKind::Invalid)
    );
    let page = record(&mut client, 2, "succeeded", "release").unwrap();
    let step = &page.steps[1];
    assert_eq!((step.number, step.plan.as_str()), (2, ""));
    assert!(step.ended_ns >= Some(found.steps[1].started_ns), "{step:?}");
    record(&mut client, 3, "running", "reach").unwrap();
    let ended = task(&mut client, end_task(2, 1)).unwrap();
    assert_eq!(ended.steps[2].reason, "the mug slipped");

    let events = events_since(&mut client, newest, 0).events;
    let steps = events.iter().filter(|event| event.step.is_some());
    let kinds: Vec<_> = steps.map(|event| event.event.as_str()).collect();
    let (run, fail) = ("step_running", "step_failed");
    assert_eq!(
        kinds,
        [run, fail, run, "step_held", "step_succeeded", run, fail]
    );
    let output = sandbox.tabula(&["world", "tasks"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let line = "    2 succeeded  release object 7 (mug) to shelf, attempt 2";
    assert!(text.lines().any(|its| its == line), "{text}");
}

#[test]
fn damaged_working_memory_is_reported_and_does_not_stop_the_daemon() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    wait_for_world(&daemon, wait_for_all(&daemon, 0).len());
    daemon.stop();
    let database = sandbox.home().join("working-memory/database");
    std::fs::write(database.join("CURRENT"), "rubbish\n").unwrap();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    wait_for_world(&daemon, wait_for_all(&daemon, 0).len());
    for process in WITH_CAMERA {
        assert!(daemon.pid(process).is_some(), "{}", process.word());
    }
    let log = daemon.log();
    assert!(log.contains("begun anew"), "{log}");
    assert!(
        sandbox
            .home()
            .join("working-memory/database.damaged-1")
            .is_dir()
    );
    let health = daemon.health("memory").unwrap();
    assert_eq!(health["state"], "degraded", "{health}");
    daemon.stop();
}
