use std::fs;
use std::path::Path;

use durable_leveldb::MutationId;
use tempfile::TempDir;

use super::*;
use crate::tests::{CONFIG, place, sighting};
use crate::{
    EventKind, FactQuery, NewTask, Outcome, StepContent, StepState, Subject, TaskEnd, Value,
};

const SECOND: u64 = 1_000_000_000;

fn folder() -> TempDir {
    tempfile::tempdir_in("/dev/shm").unwrap()
}

fn open(folder: &Path, now_ns: u64) -> (WorkingMemory, WorldModel, WorldReport) {
    WorkingMemory::open(folder, CONFIG, now_ns).unwrap()
}

fn all_facts(model: &WorldModel) -> Vec<crate::Fact> {
    let query = FactQuery {
        subject: None,
        label: None,
        region: None,
        window: None,
        before: None,
        n_most: usize::MAX,
    };
    model.facts(&query).facts
}

/// Fills a model with a moving mug and a running task.
fn fill(memory: &mut WorkingMemory, model: &mut WorldModel) {
    for second in 10..20_u64 {
        let now_ns = second * SECOND;
        let seen = (7, 0, 1, second as u8);
        model.observe([sighting(&seen, now_ns)], true, now_ns);
        memory.write_changes(model).unwrap();
    }
    let new = NewTask {
        id: MutationId(u128::MAX),
        kind: "clear the table".to_owned(),
        parameters: "{}".to_owned(),
        author: "anna".to_owned(),
    };
    model.start_task(&new, 20 * SECOND).unwrap();
    memory.write_changes(model).unwrap();
}

#[test]
fn facts_end_at_their_last_observation_after_a_restart() {
    let folder = folder();
    let (mut memory, mut model, report) = open(folder.path(), SECOND);
    assert_eq!(report.condition, WorldCondition::New);
    fill(&mut memory, &mut model);
    let before = all_facts(&model);
    // Killed: nothing is closed.
    drop(memory);
    let (_memory, model, report) = open(folder.path(), 100 * SECOND);
    assert_eq!(report.condition, WorldCondition::Sound, "{report}");
    let mut expected = before.clone();
    for fact in &mut expected {
        if fact.end_ns.is_none() && fact.subject == Subject::Object(7) {
            fact.end_ns = Some(19 * SECOND);
        }
    }
    assert_ne!(before, expected);
    assert_eq!(all_facts(&model), expected);
    assert_eq!(model.objects().count(), 0);
    let place_then = expected
        .iter()
        .find(|fact| matches!(fact.value, Value::Place(_)));
    assert_eq!(place_then.unwrap().value, Value::Place(place(19)));
    let started = model.events_since(0).last().unwrap();
    assert_eq!(
        (&started.kind, started.wall_ns),
        (&EventKind::Started, 100 * SECOND)
    );
}

#[test]
fn task_continues_after_a_restart_and_a_retry_is_answered() {
    let folder = folder();
    let (mut memory, mut model, _) = open(folder.path(), SECOND);
    fill(&mut memory, &mut model);
    let end = TaskEnd {
        id: MutationId(5),
        task: 1,
        outcome: Outcome::Succeeded,
        reason: String::new(),
    };
    for now_s in [30, 40] {
        drop(memory);
        (memory, model, _) = open(folder.path(), now_s * SECOND);
        let task = model.end_task(&end, now_s * SECOND).unwrap().clone();
        let crate::TaskState::Ended { ended_ns, .. } = task.state else {
            panic!("{task:?}");
        };
        assert_eq!(ended_ns, 30 * SECOND);
        memory.write_changes(&mut model).unwrap();
    }
}

#[test]
fn steps_go_on_after_a_restart() {
    let folder = folder();
    let (mut memory, mut model, _) = open(folder.path(), SECOND);
    fill(&mut memory, &mut model);
    let step = |number, state| StepContent {
        number,
        state,
        primitive: "lift".to_owned(),
        track_id: 7,
        label: None,
        place: None,
        attempt: 1,
        reason: String::new(),
        plan: "{}".to_owned(),
    };
    for (number, state) in [
        (1, StepState::Running),
        (1, StepState::Succeeded),
        (2, StepState::Held),
    ] {
        model
            .record_step(1, step(number, state), 21 * SECOND)
            .unwrap();
    }
    memory.write_changes(&mut model).unwrap();
    let before = model.task(1).unwrap().clone();
    // Killed: nothing is closed.
    drop(memory);
    let (_memory, mut model, report) = open(folder.path(), 100 * SECOND);
    assert_eq!(report.condition, WorldCondition::Sound, "{report}");
    assert_eq!(model.task(1), Some(&before));
    assert_eq!(before.open_step().unwrap().content.number, 2);
    let held = step(2, StepState::Held);
    assert_eq!(model.record_step(1, held, 101 * SECOND).unwrap(), &before);
    let released = step(2, StepState::Succeeded);
    let task = model.record_step(1, released, 101 * SECOND).unwrap();
    assert_eq!(task.steps[1].started_ns, 21 * SECOND);
    assert_eq!(task.steps[1].ended_ns, Some(101 * SECOND));
}

#[test]
fn numbers_are_not_given_again_when_what_had_them_is_forgotten() {
    let folder = folder();
    let (mut memory, mut model, _) = open(folder.path(), SECOND);
    fill(&mut memory, &mut model);
    model.observe([], true, 21 * SECOND);
    let (fact, event) = (model.facts.newest, model.newest_event());
    while model.expire(1000 * SECOND) {}
    assert_eq!(all_facts(&model).len(), 1, "the running task's");
    memory.write_changes(&mut model).unwrap();
    memory.close().unwrap();
    let (_memory, mut model, report) = open(folder.path(), 2000 * SECOND);
    assert_eq!(report.n_facts, 1, "{report}");
    model.observe(
        [sighting(&(8, 0, 0, 0), 2001 * SECOND)],
        true,
        2001 * SECOND,
    );
    assert_eq!(all_facts(&model)[0].number, fact + 2);
    // Events that were told and lost have no successor of the same number.
    let mut since = model.events_since(event);
    assert!(since.all(|known| known.sequence > event + 1000));
    assert_eq!(model.newest_event(), event + 1002);
}

#[test]
fn second_opening_is_refused() {
    let folder = folder();
    let first = open(folder.path(), SECOND);
    let refused = WorkingMemory::open(folder.path(), CONFIG, SECOND);
    let refused = refused.map(|_| ()).unwrap_err();
    assert!(
        matches!(refused, Error::Storage(StorageError::InUse { .. })),
        "{refused}"
    );
    drop(first);
    open(folder.path(), SECOND);
}

#[test]
fn newer_schema_is_refused_and_left_unchanged() {
    let folder = folder();
    let (mut memory, _, _) = open(folder.path(), SECOND);
    let meta = WorkingMeta {
        schema: SCHEMA + 1,
        newest_fact: 0,
        newest_event: 0,
        newest_task: 0,
        newest_surface: 0,
    };
    let key = RecordKey::Meta.key();
    let record = Some(seal(&key, &meta));
    memory.write(vec![RecordWrite { key, record }]).unwrap();
    drop(memory);
    let refused = WorkingMemory::open(folder.path(), CONFIG, SECOND);
    let refused = refused.map(|_| ()).unwrap_err();
    assert!(
        matches!(refused, Error::Storage(StorageError::NewerSchema { .. })),
        "{refused}"
    );
    assert!(!folder.path().join("database.damaged-1").exists());
}

/// Database files of a folder with their content.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder.join("database")).unwrap().flatten();
    let read = |entry: fs::DirEntry| {
        let name = entry.file_name().into_string().unwrap();
        (name, fs::read(entry.path()).unwrap())
    };
    entries.map(read).collect()
}

/// Opens a memory with damaged files and checks that it reports no wrong facts and works.
fn check_damaged(files: &[(String, Vec<u8>)], whole: &[crate::Fact]) -> bool {
    let folder = folder();
    let database = folder.path().join("database");
    fs::create_dir(&database).unwrap();
    for (name, content) in files {
        fs::write(database.join(name), content).unwrap();
    }
    let (mut memory, mut model, report) = open(folder.path(), 100 * SECOND);
    for fact in all_facts(&model) {
        let is_known = |known: &&crate::Fact| {
            (known.number, &known.value, known.start_ns)
                == (fact.number, &fact.value, fact.start_ns)
        };
        assert!(whole.iter().any(|known| is_known(&known)), "{fact:?}");
    }
    if let WorldCondition::Reset { set_aside, .. } = &report.condition {
        assert!(set_aside.join("CURRENT").exists() || set_aside.read_dir().unwrap().count() > 0);
    }
    model.observe([sighting(&(9, 0, 0, 0), 101 * SECOND)], true, 101 * SECOND);
    memory.write_changes(&mut model).unwrap();
    drop(memory);
    let (_, model, again) = open(folder.path(), 102 * SECOND);
    assert_eq!(again.condition, WorldCondition::Sound, "{again}");
    assert!(
        all_facts(&model)
            .iter()
            .any(|fact| fact.subject == Subject::Object(9))
    );
    report.is_loss()
}

#[test]
fn damaged_memory_is_set_aside_and_replaced() {
    let folder = folder();
    let (mut memory, mut model, _) = open(folder.path(), SECOND);
    fill(&mut memory, &mut model);
    let whole = all_facts(&model);
    drop((memory, model));
    let files = files(folder.path());
    let mut n_losses = 0;
    for (i, (name, content)) in files.iter().enumerate() {
        let step = (content.len() / 12).max(1);
        for at in (0..content.len()).step_by(step) {
            let mut flipped = files.clone();
            flipped[i].1[at] ^= 0x40;
            let mut cut = files.clone();
            cut[i].1.truncate(at);
            let is_kept = |name: &str| ["LOG", "LOCK"].contains(&name);
            let losses = [check_damaged(&flipped, &whole), check_damaged(&cut, &whole)];
            n_losses += losses.iter().filter(|is_loss| **is_loss).count();
            assert!(!is_kept(name) || losses == [false; 2], "{name} at {at}");
        }
    }
    assert!(n_losses > 20, "{n_losses} times");
}
