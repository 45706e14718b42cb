use super::*;
use crate::arguments::{SceneArguments, SimulateVerb};
use crate::simulate;
use serde_json::Value;

/// Scene file: three separate objects for one second.
const SCENE: &str = r#"
duration_s = 1.0

[[object]]
category = "soda-can"
position_m = [-0.2, -0.1]

[[object]]
category = "soda-can"
position_m = [0.2, -0.1]

[[object]]
category = "juice-box"
position_m = [0.0, 0.1]
yaw_deg = 30.0
"#;

fn arguments(dataset: &Path, out: &Path) -> TrackingArguments {
    TrackingArguments {
        dataset: Some(dataset.to_owned()),
        out: out.to_owned(),
        seeds: 2,
        seed: 1,
        scene: Vec::new(),
        labels: None,
        truth: None,
        hidden_people: false,
    }
}

fn document(out: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(out.join("tracking.json")).unwrap()).unwrap()
}

/// Asserts near-perfect scores of objects at rest; the first frames, before confirmation, are
/// missed.
fn check_at_rest(figures: &Value, context: &str) {
    let number = |key: &str| {
        figures[key]
            .as_f64()
            .unwrap_or_else(|| panic!("{context}: {key} in {figures}"))
    };
    assert!(
        (0.8..=1.0).contains(&number("mota")),
        "{context}: {figures}"
    );
    assert!((0.8..=1.0).contains(&number("idf1")), "{context}");
    assert_eq!(
        (number("id_switches"), number("lost")),
        (0.0, 0.0),
        "{context}"
    );
    assert_eq!(number("ids_per_object"), 1.0, "{context}");
    let median_mm = figures["centre_error_mm"]["median"].as_f64().unwrap();
    assert!((0.0..15.0).contains(&median_mm), "{context}: {median_mm}");
    let turn_deg = figures["orientation_error_deg"]["median"].as_f64().unwrap();
    assert!((0.0..10.0).contains(&turn_deg), "{context}: {turn_deg}");
}

#[test]
fn tracking_of_a_scene_at_rest_is_near_perfect_live_and_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = folder.path().join("scenes");
    std::fs::create_dir(&scenes).unwrap();
    let file = scenes.join("rest.toml");
    std::fs::write(&file, SCENE).unwrap();
    let output = Output::new(true);
    let live = folder.path().join("live");
    run(&arguments(&scenes, &live), &output).unwrap();
    let found = document(&live);
    check_at_rest(&found, "live");
    let rest = &found["scenes"]["rest"];
    check_at_rest(rest, "scene");
    assert_eq!(rest["per_seed"][1]["seed"], 2);
    assert_eq!(
        (&found["n_runs"], &found["n_objects"]),
        (&2.into(), &6.into())
    );
    let page = std::fs::read_to_string(live.join("index.html")).unwrap();
    assert!(page.contains("tracks/rest-2.svg") && live.join("tracks/rest-2.svg").exists());
    // The same of a recording of it, without people, and with the sensor's depth.
    let recording = folder.path().join("recording");
    let verb = SimulateVerb::Scene(SceneArguments {
        file: Some(file),
        kind: None,
        objects: None,
        models: None,
        seed: Some(1),
        frames: 20,
        rate: 30.0,
        out: recording.clone(),
    });
    simulate::run(&verb, &output).unwrap();
    let replayed = folder.path().join("replayed");
    run(&arguments(&recording, &replayed), &output).unwrap();
    check_at_rest(&document(&replayed)["scenes"]["recording"], "recorded");
    check_without_ground_truth(&recording, folder.path());
}

/// Evaluates the same recording without its ground truth.
fn check_without_ground_truth(recording: &Path, folder: &Path) {
    for entry in std::fs::read_dir(recording).unwrap() {
        let path = entry.unwrap().path();
        if path
            .extension()
            .is_some_and(|extension| extension == "json")
        {
            std::fs::remove_file(path).unwrap();
        }
    }
    let out = folder.join("unknown");
    let mut arguments = arguments(recording, &out);
    run(&arguments, &Output::new(true)).unwrap();
    let found = document(&out);
    let ids = found["tracks"].as_array().unwrap().iter();
    let ids: Vec<u64> = ids.map(|track| track["id"].as_u64().unwrap()).collect();
    let [a, b, c] = ids[..] else {
        panic!("not three tracks: {ids:?}")
    };
    let labels = folder.join("labels.csv");
    let table = format!("track_id,object-name\n{a},first\n{b},second\n{c},first\n");
    std::fs::write(&labels, table).unwrap();
    arguments.labels = Some(labels);
    run(&arguments, &Output::new(true)).unwrap();
    let found = document(&out);
    assert!(found["truth"].is_null());
    assert_eq!(
        (&found["n_frames"], &found["n_ids"]),
        (&20.into(), &3.into())
    );
    assert_eq!(found["ids_per_object"], 1.5);
    assert_eq!(found["objects"]["first"]["ids"], serde_json::json!([a, c]));
    for track in found["tracks"].as_array().unwrap() {
        let drift_mm = track["drift_mm"].as_f64().unwrap();
        assert!((0.0..20.0).contains(&drift_mm), "{track}");
    }
    assert!(out.join("frames/000000.png").exists() && out.join("tracks/recording.svg").exists());
    let truth = folder.join("truth.toml");
    std::fs::write(&truth, marks_of(&found["tracks"][0]["centre_m"])).unwrap();
    arguments.truth = Some(truth);
    run(&arguments, &Output::new(true)).unwrap();
    check_marked(&document(&out)["truth"]);
}

/// Truth file that marks one of the objects of the recording.
fn marks_of(place_m: &Value) -> String {
    format!(
        "[[object]]\nname = \"can\"\ncolor = \"red\"\nplace_in_world_m = {place_m}\n\
         radius_m = 0.06\nin_view = [[2, 19]]\n"
    )
}

/// Asserts the score of one marked object of three.
fn check_marked(found: &Value) {
    assert_eq!(found["ids_per_object"], 1.0, "{found}");
    assert_eq!(found["tracks_of_nothing"].as_array().unwrap().len(), 2);
    let can = &found["objects"][0];
    assert_eq!(
        (&can["name"], &can["n_frames_tracked"]),
        (&"can".into(), &18.into())
    );
    assert!(can["drift_mm"].as_f64().unwrap() < 20.0, "{can}");
}

#[test]
fn unusable_inputs_are_refused_with_reasons() {
    let folder = tempfile::tempdir().unwrap();
    let output = Output::new(true);
    let out = folder.path().join("out");
    let check = |arguments: &TrackingArguments, part: &str| {
        let failure = run(arguments, &output).unwrap_err().to_string();
        assert!(failure.contains(part), "{failure}");
    };
    check(&arguments(folder.path(), &out), "holds no frames");
    let file = folder.path().join("broken.toml");
    std::fs::write(&file, "tables = 1").unwrap();
    check(&arguments(&file, &out), "broken");
    let labelled = TrackingArguments {
        labels: Some(file.clone()),
        ..arguments(&file, &out)
    };
    check(&labelled, "--labels");
}
