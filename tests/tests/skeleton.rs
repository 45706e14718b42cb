//! Walking skeleton: start, see, teach, restart, recognise, stop.

use crate::daemon::{Daemon, Sandbox, nearest};
use crate::recorder::SceneRecorder;
use camera::synthetic::SyntheticTable;
use serde_json::Value;

/// Number of frames of a static scene.
const N_STILL_FRAMES: usize = 150;

/// Ground-truth position of an object of an arrangement.
pub(crate) fn place_of(arrangement: u32, name: &str) -> [f64; 3] {
    let table = SyntheticTable::new(arrangement);
    let objects = table.objects();
    let object = objects.iter().find(|object| object.name == name).unwrap();
    object.centre_in_world().into()
}

/// Track-id of an object, as an argument.
pub(crate) fn id(object: &Value) -> String {
    object["track_id"].to_string()
}

/// Waits until all objects of an arrangement are tracked, and nothing else is.
pub(crate) fn wait_for_all(daemon: &Daemon<'_>, arrangement: u32) -> Vec<Value> {
    let n_objects = SyntheticTable::new(arrangement).objects().len();
    daemon.wait_for("all objects are tracked", |objects| {
        let tracked = objects.iter().filter(|object| object["state"] == "tracked");
        tracked.count() == n_objects && objects.len() == n_objects
    })
}

#[test]
fn recognition_follows_the_shape_and_not_the_position() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let objects = wait_for_all(&daemon, 0);
    for (name, label) in [("bowl", "bowl"), ("box", "cereal box")] {
        let taught = nearest(&objects, place_of(0, name));
        daemon.ask(&["teach", &id(taught), label]);
    }
    daemon.stop();

    let daemon = sandbox.start(&["--source", "synthetic:1"]);
    let objects = wait_for_all(&daemon, 1);
    let label = |name: &str| nearest(&objects, place_of(1, name))["label"].clone();
    assert_eq!(label("bowl"), "bowl", "{objects:#?}");
    assert_eq!(label("box"), "cereal box", "{objects:#?}");
    for never_taught in ["can", "ball", "mug"] {
        assert_eq!(label(never_taught), Value::Null, "{objects:#?}");
    }
    daemon.stop();
}

/// The yaw of round objects is noise, and no motion.
#[test]
fn static_objects_have_one_key_view() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    wait_for_all(&daemon, 0);
    let scenes = SceneRecorder::start(&sandbox);
    scenes.wait_for("frames go by", |scenes| scenes.len() >= N_STILL_FRAMES);
    let (scenes, _) = scenes.stop();
    for object in scenes.iter().flat_map(|scene| &scene.items) {
        assert_eq!(object.n_key_views, 1, "track {}", object.track_id);
    }
    daemon.stop();
}
