//! Layering: a crate uses only the folders and crates that the README tables allow,
//! and each foreign library is named by its owners only.

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, Package};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Foreign libraries and the only crates that may name them.
const OWNERS: [(&str, &[&str]); 21] = [
    ("iceoryx2", &["channel", "message"]),
    ("iceoryx2-log", &["channel"]),
    ("rusty-leveldb", &["durable-leveldb"]),
    ("libloading", &["freenect"]),
    ("mcap", &["recording"]),
    ("foxglove", &["recorder"]),
    ("rapier3d", &["simulated-world"]),
    ("roxmltree", &["dataset"]),
    ("pathfinding", &["tracking"]),
    ("mio", &["command-line"]),
    ("indicatif", &["command-line", "experiments"]),
    ("plotters", &["plot", "evaluation"]),
    ("rayon", &["experiments"]),
    (
        "ciborium",
        &[
            "object-model",
            "control-protocol",
            "durable-leveldb",
            "perceptual-memory",
        ],
    ),
    ("hdrhistogram", &["latency-report"]),
    ("libc", &["channel", "service"]),
    ("sd-notify", &["service"]),
    ("clap_complete", &["service"]),
    ("clap_mangen", &["service"]),
    ("tracing-subscriber", &["service"]),
    (
        "tokio",
        &[
            "channel",
            "actor",
            "service",
            "arm-driver",
            "capture",
            "memory-requests",
            "command-line",
            "camera",
            "simulator",
            "perception",
            "memory",
            "gateway",
            "executive",
        ],
    ),
];

/// Types of the topics with ground truth, and the only crates that may name them: whoever plans or acts
/// knows only what the camera sees.
const TRUTH_TOPICS: [&str; 2] = ["TrueObjects", "TrueMasks"];
const TRUTH_OWNERS: [&str; 4] = ["channel", "message", "simulator", "tests"];
/// The only other file that names them: the judge of the demonstrations.
const TRUTH_JUDGE: &str = "shared/lab/experiments/src/demo/judge.rs";

/// Readings of a clock, which no kernel takes: times are arguments.
const CLOCKS: [&str; 3] = ["Instant::now", "SystemTime::now", "monotonic_ns("];

/// Folders whose crates never log.
const SILENT_FOLDERS: [&str; 3] = ["core", "perception", "planning"];

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn workspace() -> Metadata {
    let manifest = root().join("Cargo.toml");
    MetadataCommand::new()
        .manifest_path(manifest)
        .exec()
        .unwrap()
}

/// Direct dependencies of a package when it runs; tests may use any crate.
fn dependencies(package: &Package) -> impl Iterator<Item = &str> {
    let runs = |d: &&cargo_metadata::Dependency| d.kind != DependencyKind::Development;
    package
        .dependencies
        .iter()
        .filter(runs)
        .map(|dependency| dependency.name.as_str())
}

/// Words in back quotes in a text.
fn quoted(text: &str) -> Vec<String> {
    text.split('`')
        .skip(1)
        .step_by(2)
        .map(str::to_owned)
        .collect()
}

/// Rows of the Markdown table in a README: the first word in quotes, and the last cell's.
fn table(readme: &str) -> BTreeMap<String, BTreeSet<String>> {
    let text = std::fs::read_to_string(root().join(readme)).unwrap();
    let rows = text
        .lines()
        .filter(|line| line.starts_with('|') && line.contains('`'));
    rows.map(|row| {
        let cells: Vec<&str> = row.trim_matches('|').split('|').collect();
        let name = quoted(cells[0]).remove(0);
        let uses = quoted(cells[cells.len() - 1]).into_iter().collect();
        (name, uses)
    })
    .collect()
}

/// The ordered list of crates in a folder's README.
fn order(folder: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join("shared").join(folder).join("README.md"));
    let text = text.unwrap();
    let is_entry = |line: &&str| {
        line.split_once(". `")
            .is_some_and(|(n, _)| n.parse::<u32>().is_ok())
    };
    text.lines()
        .filter(is_entry)
        .map(|line| quoted(line).remove(0))
        .collect()
}

/// Each library crate with its folder and its place in the folder's list.
fn homes() -> BTreeMap<String, (String, usize)> {
    let mut homes = BTreeMap::new();
    for folder in table("shared/README.md").into_keys() {
        for (place, name) in order(&folder).into_iter().enumerate() {
            homes.insert(name, (folder.clone(), place));
        }
    }
    homes
}

/// Folder below `shared` or `services`, and the crate's own folder.
fn location(package: &Package) -> (String, String) {
    let folder = package.manifest_path.parent().unwrap();
    let name = |path: &cargo_metadata::camino::Utf8Path| path.file_name().unwrap().to_owned();
    (name(folder.parent().unwrap()), name(folder))
}

#[test]
fn layering_of_libraries_follows_the_readmes() {
    let (homes, folders) = (homes(), table("shared/README.md"));
    for package in workspace().workspace_packages() {
        let Some((folder, place)) = homes.get(package.name.as_str()) else {
            continue;
        };
        for dependency in dependencies(package) {
            let Some((its_folder, its_place)) = homes.get(dependency) else {
                continue;
            };
            let is_allowed = if its_folder == folder {
                its_place < place
            } else {
                folders[folder].contains(its_folder)
            };
            assert!(
                is_allowed,
                "{folder}/{} names {its_folder}/{dependency}",
                package.name
            );
        }
    }
}

#[test]
fn layering_of_programs_follows_their_readme() {
    let (homes, programs) = (homes(), table("services/README.md"));
    for package in workspace().workspace_packages() {
        let Some(allowed) = programs.get(package.name.as_str()) else {
            continue;
        };
        for dependency in dependencies(package) {
            if let Some((folder, _)) = homes.get(dependency) {
                assert!(
                    allowed.contains(folder),
                    "{} names {folder}/{dependency}",
                    package.name
                );
            }
        }
    }
}

#[test]
fn layering_gives_every_crate_a_home() {
    let (homes, programs) = (homes(), table("services/README.md"));
    for package in workspace().workspace_packages() {
        let (parent, folder) = location(package);
        assert_eq!(
            folder,
            package.name.as_str(),
            "a folder's name is its crate's name"
        );
        let is_listed = match parent.as_str() {
            "services" => programs.contains_key(&folder),
            _ if folder == "tests" => true,
            layer => homes.get(&folder).is_some_and(|(home, _)| home == layer),
        };
        assert!(is_listed, "{folder} is not in the README of {parent}");
    }
}

#[test]
fn layering_is_drawn_with_every_crate_in_the_order_of_its_folder() {
    let picture = std::fs::read_to_string(root().join("docs/architecture.svg")).unwrap();
    let label = |line: &str| {
        let text = line.trim().strip_suffix("</text>")?;
        let text = text.split_once("class=\"crate\"")?.1;
        Some(text.rsplit_once('>')?.1.to_owned())
    };
    let drawn: Vec<String> = picture.lines().filter_map(label).collect();
    let homes = homes();
    for folder in table("shared/README.md").into_keys() {
        let is_here = |name: &&String| homes.get(*name).is_some_and(|(its, _)| *its == folder);
        let shown: Vec<String> = drawn.iter().filter(is_here).cloned().collect();
        assert_eq!(
            shown,
            order(&folder),
            "shared/{folder} in docs/architecture.svg"
        );
    }
    for program in table("services/README.md").into_keys() {
        assert!(drawn.contains(&program), "{program} is not drawn");
    }
}

#[test]
fn layering_leaves_foreign_libraries_to_their_owners() {
    let metadata = workspace();
    let packages = metadata.workspace_packages();
    for package in packages.into_iter().filter(|p| *p.name != "tests") {
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
fn layering_keeps_kernels_from_logging() {
    let homes = homes();
    for package in workspace().workspace_packages() {
        let home = homes.get(package.name.as_str());
        if home.is_some_and(|(folder, _)| SILENT_FOLDERS.contains(&folder.as_str())) {
            let logs = dependencies(package).any(|name| name == "tracing");
            assert!(!logs, "{} logs", package.name);
        }
    }
}

/// Source files of a package with their text, tests and benches apart.
fn sources(package: &Package) -> Vec<(String, String)> {
    let mut folders = vec![package.manifest_path.parent().unwrap().join("src")];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in folder.read_dir_utf8().into_iter().flatten() {
            let entry = entry.unwrap();
            let path = entry.path();
            if path.is_dir() {
                folders.push(path.to_owned());
            } else if path.extension() == Some("rs") {
                let text = std::fs::read_to_string(path).unwrap();
                found.push((path.to_string(), text));
            }
        }
    }
    found
}

#[test]
fn layering_leaves_ground_truth_to_the_simulation_and_the_tests() {
    let metadata = workspace();
    let mut n_sources = 0;
    for package in metadata.workspace_packages() {
        if TRUTH_OWNERS.contains(&package.name.as_str()) {
            continue;
        }
        for (path, text) in sources(package) {
            n_sources += 1;
            if path.ends_with(TRUTH_JUDGE) {
                continue;
            }
            let named = TRUTH_TOPICS.iter().find(|topic| text.contains(*topic));
            assert!(named.is_none(), "{path} names {named:?}");
        }
    }
    assert!(n_sources > 500, "{n_sources}");
}

#[test]
fn layering_keeps_kernels_from_clocks() {
    let homes = homes();
    for package in workspace().workspace_packages() {
        let home = homes.get(package.name.as_str());
        let is_kernel =
            home.is_some_and(|(folder, _)| ["perception", "planning"].contains(&&**folder));
        for (path, text) in is_kernel.then(|| sources(package)).into_iter().flatten() {
            let read = CLOCKS.iter().find(|clock| text.contains(*clock));
            assert!(read.is_none(), "{path} reads a clock: {read:?}");
        }
    }
}
