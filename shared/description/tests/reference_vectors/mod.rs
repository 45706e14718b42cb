//! Reads the golden values of the published implementation.

use description::DescriptorFrame;
use point_cloud::Point;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// One run of the published implementation.
pub(crate) struct ReferenceVector {
    /// Name of the file.
    pub(crate) name: String,
    /// The points described.
    pub(crate) cloud: Vec<Point>,
    /// Bins a side.
    pub(crate) n_bins: usize,
    /// Sign threshold, metres.
    pub(crate) sign_threshold_m: f32,
    /// The frame it found.
    pub(crate) frame: DescriptorFrame,
    /// The descriptor it computed.
    pub(crate) descriptor: Vec<f32>,
}

/// All runs of the published variant, in the order of their names.
pub(crate) fn all_published() -> Vec<ReferenceVector> {
    let folder = reference_folder();
    let mut clouds = HashMap::new();
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder.join("vectors"))
        .expect("the golden vectors lie under TABULA_DATA/../reference")
        .map(|entry| entry.expect("the folder can be read").path())
        .filter(|path| is_published(path))
        .collect();
    files.sort();
    files
        .iter()
        .map(|path| read_vector(&folder, path, &mut clouds))
        .collect()
}

fn reference_folder() -> PathBuf {
    let data = std::env::var_os("TABULA_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")),
        PathBuf::from,
    );
    data.join("../reference/good")
}

fn is_published(path: &Path) -> bool {
    let name = path
        .file_name()
        .expect("a file has a name")
        .to_string_lossy();
    !name.starts_with("ws_") && name.contains("_bins") && name.contains("_thr")
}

fn read_vector(
    folder: &Path,
    path: &Path,
    clouds: &mut HashMap<String, Vec<Point>>,
) -> ReferenceVector {
    let text = std::fs::read_to_string(path).expect("a golden vector is text");
    let rows: HashMap<&str, &str> = text.lines().filter_map(|row| row.split_once(',')).collect();
    let numbers = |key: &str| -> Vec<f32> {
        rows[key]
            .split(',')
            .filter(|v| !v.is_empty())
            .map(|v| v.parse().expect("a value is a number"))
            .collect()
    };
    let transform = numbers("transform_rowmajor_4x4");
    let row = |i: usize| std::array::from_fn(|j| transform[4 * i + j]);
    let cloud = rows["cloud"].to_owned();
    ReferenceVector {
        name: path
            .file_stem()
            .expect("a file has a name")
            .to_string_lossy()
            .into_owned(),
        n_bins: rows["bins"].parse().expect("bins is a number"),
        sign_threshold_m: numbers("threshold")[0],
        frame: DescriptorFrame {
            object_from_source: [row(0), row(1), row(2)],
        },
        descriptor: numbers("descriptor"),
        cloud: clouds
            .entry(cloud)
            .or_insert_with_key(|name| read_cloud(folder, name))
            .clone(),
    }
}

fn read_cloud(folder: &Path, name: &str) -> Vec<Point> {
    let file = |extension: &str| folder.join("clouds").join(format!("{name}.{extension}"));
    if file("pcd").exists() {
        dataset::pcd::open(&file("pcd"))
            .expect("the cloud is valid")
            .points
    } else {
        dataset::ply::open(&file("ply"))
            .expect("the cloud is valid")
            .vertices
    }
}
