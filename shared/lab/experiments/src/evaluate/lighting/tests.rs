use super::*;
use crate::arguments::LightingArguments;
use simulated_world::ModelSource;

#[test]
fn lighting_report_has_all_rooms_and_white_balance_helps_under_a_bulb() {
    let out = tempfile::tempdir().unwrap();
    let arguments = LightingArguments {
        models: ModelSource::Generated,
        objects: 8,
        views: 3,
        seed: 2,
        out: out.path().to_owned(),
    };
    let output = Output::new(true);
    run(&arguments, &output).unwrap();
    let json = std::fs::read(out.path().join("lighting.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let rooms = report["rooms"].as_array().unwrap();
    assert_eq!(rooms.len(), ROOMS.len());
    let mean = |treatment: &str| {
        let values = rooms
            .iter()
            .map(|room| room[treatment]["value"].as_f64().unwrap());
        values.sum::<f64>() / rooms.len() as f64
    };
    assert!(mean("accuracy") >= mean("as_seen"), "{report}");
    for file in ["accuracy.svg", "index.html"] {
        assert!(out.path().join(file).exists(), "{file}");
    }
}
