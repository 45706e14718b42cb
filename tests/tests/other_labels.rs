//! Labels of the objects that a change of the memory is not about: they are read anew from the same
//! evidence, so that a change and its opposite leave every label as it was.

use crate::daemon::{Daemon, Sandbox, eventually};
use crate::skeleton::id;
use message::ProcessKind;
use serde_json::Value;

/// Number of objects that are taught.
const N_TAUGHT: usize = 4;

/// Track-id, number of sides, label, probability and nearest categories of each object.
fn answers(daemon: &Daemon<'_>) -> Vec<[Value; 5]> {
    let keys = ["track_id", "n_sides", "label", "probability", "categories"];
    let objects = daemon.objects();
    let answer = |object: &Value| keys.map(|key| object[key].clone());
    objects.iter().map(answer).collect()
}

fn n_sides(daemon: &Daemon<'_>) -> Vec<(Value, Value)> {
    let answers = answers(daemon).into_iter();
    answers.map(|[track, sides, ..]| (track, sides)).collect()
}

/// Plays a recording to its end, in which objects were seen from several sides.
fn after_a_recording(sandbox: &Sandbox) -> Daemon<'_> {
    let folder = test_data::path("kitchen-sequence");
    let source = folder.to_str().unwrap();
    let daemon = sandbox.start(&["--source", source, "--to", "300", "--lockstep"]);
    eventually("the recording ends", || {
        let camera = daemon.health(ProcessKind::CAMERA.word());
        camera.is_some_and(|camera| camera["state"] == "idle")
    });
    daemon
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn labels_of_other_objects_rest_on_the_same_evidence_after_a_correction() {
    let sandbox = Sandbox::new();
    let daemon = after_a_recording(&sandbox);
    let objects = daemon.objects();
    let has_views = |object: &&Value| object["n_key_views"].as_u64() >= Some(1);
    let taught: Vec<String> = objects.iter().filter(has_views).map(id).collect();
    assert!(taught.len() >= N_TAUGHT, "{objects:#?}");
    for (number, track) in taught[..N_TAUGHT].iter().enumerate() {
        daemon.ask(&["teach", track, &format!("thing {number}")]);
    }
    let (before, sides_before) = (answers(&daemon), n_sides(&daemon));
    assert!(
        sides_before
            .iter()
            .any(|(_, sides)| sides.as_u64() >= Some(2)),
        "an object has several sides: {before:#?}"
    );
    for corrected in &taught[..N_TAUGHT] {
        daemon.ask(&["correct", corrected, "renamed"]);
        assert_eq!(
            n_sides(&daemon),
            sides_before,
            "after correcting {corrected}"
        );
        let of_corrected = |answers: &[[Value; 5]]| {
            let mut answers = answers.iter();
            answers
                .find(|[track, ..]| track.as_u64() == corrected.parse().ok())
                .cloned()
        };
        let [_, _, label, ..] = of_corrected(&answers(&daemon)).unwrap();
        assert_eq!(label, "renamed");
        daemon.ask(&["undo"]);
        assert_eq!(
            answers(&daemon),
            before,
            "after undoing the correction of {corrected}"
        );
    }
    daemon.stop();
}
