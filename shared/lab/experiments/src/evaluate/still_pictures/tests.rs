use super::*;
use crate::arguments::{SceneArguments, SimulateVerb};
use crate::simulate;

#[test]
fn still_pictures_of_a_simulated_table_are_still() {
    let folder = tempfile::tempdir().unwrap();
    let (dataset, out) = (folder.path().join("data"), folder.path().join("out"));
    let output = Output::new(true);
    let scene = SceneArguments {
        file: None,
        kind: Some("isolated".into()),
        objects: Some(3),
        models: None,
        seed: Some(2),
        frames: 2,
        rate: 2.0,
        out: dataset.join("isolated"),
    };
    simulate::run(&SimulateVerb::Scene(scene), &output).unwrap();
    let arguments = StillPicturesArguments {
        dataset,
        out: out.clone(),
        frames: 25,
        every: 2,
        seed: 1,
    };
    run(&arguments, &output).unwrap();
    let json = std::fs::read(out.join("still-pictures.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(report["n_pictures"], 1);
    assert_eq!(
        (&report["n_still"], &report["n_still_with_noise"]),
        (&1.into(), &1.into())
    );
    for bytes in ["equal", "noise"] {
        let play = &report["pictures"][0][bytes];
        assert!(play["n_tracks"].as_u64().unwrap() >= 3, "{report}");
        assert!(play["table_step_mm"].as_f64().unwrap() < 1.0, "{report}");
    }
}
