//! Read-your-writes consistency: an answer includes every change acknowledged before the
//! question.

use crate::daemon::{Daemon, Sandbox, WATCHDOG, eventually};
use crate::skeleton::{id, wait_for_all};
use control_protocol::{Command, Labelling, MutationId, Reply};
use daemon_client::DaemonClient;
use message::ProcessKind;

/// Number of changes, each followed by a question at once.
const N_CHANGES: u128 = 20;

fn call(client: &mut DaemonClient, command: Command) -> Reply {
    client.call(command).unwrap()
}

/// Label of a track in the answers to `ask` and to `objects`.
fn labels(client: &mut DaemonClient, track_id: u64) -> [Option<String>; 2] {
    let Reply::Object(object) = call(client, Command::Ask { track_id }) else {
        panic!("track {track_id} is not answered")
    };
    let Reply::Objects(all) = call(client, Command::Objects) else {
        panic!("the objects are not answered")
    };
    let listed = all.objects.into_iter().find(|one| one.track_id == track_id);
    [object.label, listed.unwrap().label]
}

/// Corrects the label of a track repeatedly, and asks for it at once.
fn check_each_change_is_answered(daemon: &Daemon<'_>, track_id: u64) {
    let sandbox = daemon.sandbox;
    let folders = [sandbox.run_folder()];
    let mut client = DaemonClient::connect(&sandbox.domain, &folders, WATCHDOG).unwrap();
    for number in 0..N_CHANGES {
        let category = format!("thing {number}");
        let labelling = Labelling {
            is_new: false,
            id: MutationId(1 + number),
            author: "anna".to_owned(),
            track_id,
            category: category.clone(),
        };
        let changed = call(&mut client, Command::Correct(labelling));
        assert!(matches!(changed, Reply::Learned(_)), "{changed:?}");
        let expected = [Some(category.clone()), Some(category)];
        assert_eq!(labels(&mut client, track_id), expected);
    }
    let forget = Command::Forget {
        id: MutationId(1 + N_CHANGES),
        author: "anna".to_owned(),
        category: format!("thing {}", N_CHANGES - 1),
    };
    let forgot = call(&mut client, forget);
    assert!(matches!(forgot, Reply::Learned(_)), "{forgot:?}");
    assert_eq!(labels(&mut client, track_id), [None, None]);
}

#[test]
fn label_is_answered_directly_after_a_change_while_frames_come() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0", "--rate", "10"]);
    let track = id(&wait_for_all(&daemon, 0)[0]);
    check_each_change_is_answered(&daemon, track.parse().unwrap());
    daemon.stop();
}

#[test]
fn label_is_answered_directly_after_a_change_when_no_frame_comes_any_more() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0", "--to", "30", "--lockstep"]);
    eventually("the recording ends", || {
        let camera = daemon.health(ProcessKind::CAMERA.word());
        camera.is_some_and(|camera| camera["state"] == "idle")
    });
    let track = id(&daemon.objects()[0]);
    check_each_change_is_answered(&daemon, track.parse().unwrap());
    daemon.stop();
}
