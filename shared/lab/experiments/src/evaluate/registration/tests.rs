use super::*;
use simulated_world::ModelSource;
use std::path::PathBuf;

fn arguments(pairs: Option<PathBuf>, models: Option<ModelSource>) -> RegistrationArguments {
    RegistrationArguments {
        pairs,
        models,
        objects: 3,
        angle: 30.0,
        starts: 1,
        seed: 5,
        out: None,
    }
}

/// Corner of a box of 10 cm, seen from outside: three faces.
fn corner() -> Vec<u8> {
    let side = |i: u16| f32::from(i) * 0.002;
    let cells = (0..50_u16).flat_map(|a| (0..50).map(move |b| (side(a), side(b))));
    cells
        .flat_map(|(a, b)| [[a, b, 0.0], [a, 0.0, b], [0.0, a, b]])
        .flatten()
        .flat_map(f32::to_le_bytes)
        .collect()
}

#[test]
fn corner_is_registered_with_itself_from_all_starts() {
    let folder = tempfile::tempdir().unwrap();
    for ending in ["src", "tgt"] {
        std::fs::write(folder.path().join(format!("box_{ending}.f32")), corner()).unwrap();
    }
    let out = folder.path().join("out");
    let arguments = RegistrationArguments {
        out: Some(out.clone()),
        ..arguments(Some(folder.path().to_owned()), None)
    };
    run(&arguments, &Output::new(true)).unwrap();
    let json = std::fs::read(out.join("registration.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(report["pairs"][0]["name"], "box");
    assert_eq!(report["pairs"][0]["n_trials"], 12);
    assert_eq!(report["pairs"][0]["n_success"], 12, "{report}");
    assert!(out.join("index.html").exists() && out.join("success.svg").exists());
}

#[test]
fn simulated_pairs_show_one_object_and_are_read_back() {
    let models = ModelSource::Generated;
    let arguments = arguments(None, Some(models.clone()));
    let pairs = simulated_pairs::simulate(&models, &arguments, &Output::new(true)).unwrap();
    assert!(!pairs.is_empty());
    for pair in &pairs {
        let [at_target, at_source] = pair.viewpoints.unwrap();
        assert!(
            (0.3..0.8).contains(&(at_target - at_source).norm()),
            "{}",
            pair.name
        );
        // Both views show the same object, from the distance of the turntable's camera.
        let [target, source] = [&pair.target, &pair.source].map(|points| trials::centroid(points));
        assert!((target - source).norm() < 0.1, "{}", pair.name);
        assert!(
            (0.6..1.4).contains(&(at_target - target).norm()),
            "{}",
            pair.name
        );
    }
    let folder = tempfile::tempdir().unwrap();
    pair_files::write_all(&pairs, folder.path()).unwrap();
    let read = pair_files::read(folder.path()).unwrap();
    assert_eq!(read.len(), pairs.len());
    assert!(read[0].target == pairs[0].target && read[0].source == pairs[0].source);
}

#[test]
fn folders_without_pairs_and_cut_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |expected: &str| {
        let arguments = arguments(Some(folder.path().to_owned()), None);
        let failure = run(&arguments, &Output::new(true)).unwrap_err();
        assert!(failure.to_string().contains(expected), "{failure}");
    };
    refused("no pairs of views");
    std::fs::write(folder.path().join("cup_src.f32"), [0; 24]).unwrap();
    refused("cup_tgt.f32 cannot be read");
    std::fs::write(folder.path().join("cup_tgt.f32"), [0; 25]).unwrap();
    refused("has 25 bytes");
    std::fs::write(folder.path().join("cup_tgt.f32"), [0; 24]).unwrap();
    refused("too few to register");
    let failure = run(&arguments(None, None), &Output::new(true)).unwrap_err();
    assert!(failure.to_string().contains("--models"), "{failure}");
}
