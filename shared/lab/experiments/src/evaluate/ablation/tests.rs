use super::super::open_ended::tests::write_bars;
use super::*;
use crate::arguments::{LessonArguments, ViewProtocol};
use serde_json::Value;
use std::fs;
use std::path::Path;

fn arguments(dataset: &Path, out: &Path) -> AblationArguments {
    AblationArguments {
        lessons: LessonArguments {
            dataset: dataset.to_owned(),
            out: out.to_owned(),
            seed: 3,
            tau: 0.67,
            protocol: Some(ViewProtocol::View),
        },
        variants: vec![
            AblationVariant::OursPrincipal,
            AblationVariant::Published,
            AblationVariant::OursNoSize,
        ],
        runs: 4,
        bins: 15,
        views_max: None,
    }
}

fn document(out: &Path) -> Value {
    serde_json::from_slice(&fs::read(out.join("ablation.json")).unwrap()).unwrap()
}

#[test]
fn ablation_compares_variants_on_the_same_seeds() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    write_bars(&data, 6, 40);
    let arguments = arguments(&data, &folder.path().join("out"));
    run(&arguments, &Output::new(true)).unwrap();
    let document = document(&arguments.lessons.out);
    let variants = document["variants"].as_array().unwrap();
    let names: Vec<&str> = variants
        .iter()
        .map(|v| v["name"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        ["published", "ours", "ours-no-size", "ours-principal"]
    );
    let gca_of_runs = |variant: &Value| -> Vec<f64> {
        let runs = variant["runs"].as_array().unwrap();
        assert_eq!(runs[0]["seed"], 3);
        runs.iter()
            .map(|run| run["gca"].as_f64().unwrap())
            .collect()
    };
    let (published, ours) = (gca_of_runs(&variants[0]), gca_of_runs(&variants[1]));
    let mean = |values: &[f64]| values.iter().sum::<f64>() / 4.0;
    let figure = |variant: &Value, key: &str| variant[key]["value"].as_f64().unwrap();
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} is not {b}");
    close(figure(&variants[0], "gca"), mean(&published));
    let difference = mean(&published) - mean(&ours);
    close(figure(&variants[0], "gca_difference"), difference);
    let ratio = (1.0 - mean(&published)) / (1.0 - mean(&ours));
    close(figure(&variants[0], "error_ratio"), ratio);
    assert_eq!(variants[1]["gca_difference"], Value::Null);
    // These files have no upward direction, so ignoring it changes nothing.
    close(figure(&variants[3], "gca_difference"), 0.0);
    let svg = fs::read_to_string(arguments.lessons.out.join("gca.svg")).unwrap();
    assert!(names.iter().all(|name| svg.contains(name)), "{svg}");
}

#[test]
fn ablation_is_reproducible() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    write_bars(&data, 4, 30);
    let arguments = arguments(&data, &folder.path().join("out"));
    run(&arguments, &Output::new(true)).unwrap();
    let first = document(&arguments.lessons.out);
    run(&arguments, &Output::new(true)).unwrap();
    assert_eq!(first, document(&arguments.lessons.out));
}
