//! Crates name only crates of lower layers, never a sibling; each foreign
//! library has its owners. Folders alone do not hold; this does.

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, Package};
use std::collections::BTreeMap;

/// The layers, lowest first. What is not listed here can not be in the workspace.
const LAYERS: [&[&str]; 11] = [
    &["geometry", "random"],
    &["point-cloud", "mesh"],
    &[
        "detection",
        "description",
        "dataset",
        "household",
        "rendering",
        "manipulator",
    ],
    &["tracking", "learning", "simulation"],
    &["pipeline", "message"],
    &["channel", "store", "freenect"],
    &["actor"],
    &["service", "evaluation"],
    &[
        "capture",
        "memory-control",
        "command-line",
        "latency-report",
        "machine",
    ],
    &[
        "camera",
        "simulator",
        "perception",
        "memory",
        "latency",
        "tabula",
    ],
    &["tests"],
];

/// Foreign libraries and the only crates that may name them.
const OWNERS: [(&str, &[&str]); 14] = [
    ("iceoryx2", &["channel", "message"]),
    ("iceoryx2-log", &["channel"]),
    ("rusty-leveldb", &["store"]),
    ("libloading", &["freenect"]),
    ("rapier3d", &["simulation"]),
    ("pathfinding", &["tracking"]),
    ("indicatif", &["command-line", "tabula"]),
    ("plotters", &["evaluation"]),
    ("ciborium", &["channel", "store"]),
    ("hdrhistogram", &["latency-report"]),
    ("libc", &["machine", "service"]),
    ("sd-notify", &["service"]),
    ("tracing-subscriber", &["service"]),
    (
        "tokio",
        &[
            "channel",
            "actor",
            "service",
            "capture",
            "machine",
            "memory-control",
            "command-line",
            "camera",
            "simulator",
            "perception",
            "memory",
            "tabula",
        ],
    ),
];

/// Above this layer crates may log.
const HIGHEST_SILENT_LAYER: usize = 3;

fn workspace() -> Metadata {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/../Cargo.toml");
    MetadataCommand::new()
        .manifest_path(manifest)
        .exec()
        .unwrap()
}

/// Names of what a package needs when it runs; tests may use anything below them.
fn dependencies(package: &Package) -> impl Iterator<Item = &str> {
    let runs = |d: &&cargo_metadata::Dependency| d.kind != DependencyKind::Development;
    package
        .dependencies
        .iter()
        .filter(runs)
        .map(|dependency| dependency.name.as_str())
}

fn layer_of() -> BTreeMap<&'static str, usize> {
    let layers = LAYERS.iter().enumerate();
    layers
        .flat_map(|(layer, names)| names.iter().map(move |name| (*name, layer)))
        .collect()
}

#[test]
fn crates_name_only_crates_of_lower_layers() {
    let layers = layer_of();
    for package in workspace().workspace_packages() {
        let name = package.name.as_str();
        let layer = layers
            .get(name)
            .unwrap_or_else(|| panic!("{name} is in no layer"));
        for dependency in dependencies(package) {
            if let Some(below) = layers.get(dependency) {
                assert!(
                    below < layer,
                    "{name} (layer {layer}) names {dependency} (layer {below})"
                );
            }
        }
    }
}

#[test]
fn foreign_libraries_are_named_by_their_owners_only() {
    for package in workspace()
        .workspace_packages()
        .into_iter()
        .filter(|p| *p.name != "tests")
    {
        for dependency in dependencies(package) {
            for (library, owners) in OWNERS {
                let is_allowed = dependency != library || owners.contains(&package.name.as_str());
                assert!(
                    is_allowed,
                    "{} names {library}, which belongs to {owners:?}",
                    package.name
                );
            }
        }
    }
}

#[test]
fn kernels_do_not_log() {
    let layers = layer_of();
    for package in workspace().workspace_packages() {
        if layers[package.name.as_str()] <= HIGHEST_SILENT_LAYER {
            assert!(
                dependencies(package).all(|name| name != "tracing"),
                "{} logs",
                package.name
            );
        }
    }
}

#[test]
fn a_folders_name_is_its_crates_name() {
    for package in workspace().workspace_packages() {
        let folder = package.manifest_path.parent().unwrap().file_name().unwrap();
        assert_eq!(folder, package.name.as_str());
    }
}
