//! Reader of the golden vectors of the authors' programs.

use description::{DescriptorFrame, GoodVariant, Support};
use point_cloud::Point;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Golden vector: one run of a reference program.
pub(crate) struct ReferenceVector {
    /// File name of the reference vector.
    pub(crate) name: String,
    /// Points of the described object.
    pub(crate) cloud: Vec<Point>,
    /// Histogram bins per side.
    pub(crate) n_bins: usize,
    /// Variant of GOOD that the program computes.
    pub(crate) variant: GoodVariant,
    /// Object frame computed by the reference program.
    pub(crate) frame: DescriptorFrame,
    /// Descriptor computed by the reference program.
    pub(crate) descriptor: Vec<f32>,
}

/// All runs of the published program, ordered by name.
pub(crate) fn all_published() -> Vec<ReferenceVector> {
    let is_published = |name: &str| !name.starts_with("ws_") && name.contains("_thr");
    let variant = |rows: &Rows| GoodVariant::Published {
        sign_threshold_m: rows.numbers("threshold")[0],
    };
    all(is_published, variant)
}

/// All runs of the workspace's program, ordered by name.
pub(crate) fn all_workspace() -> Vec<ReferenceVector> {
    let is_workspace = |name: &str| name.starts_with("ws_") && name.contains("_bins");
    let variant = |rows: &Rows| {
        let is_adaptive = rows.text("adaptive_support_lenght_param") == "0";
        let side_m = f64::from(rows.numbers("global_image_width")[0]);
        let support = if is_adaptive {
            Support::Adaptive
        } else {
            Support::Fixed { side_m }
        };
        GoodVariant::Workspace { support }
    };
    all(
        |name| is_workspace(name) && !name.contains("distances"),
        variant,
    )
}

fn all(
    is_wanted: impl Fn(&str) -> bool,
    variant: impl Fn(&Rows) -> GoodVariant,
) -> Vec<ReferenceVector> {
    let folder = reference_folder();
    let mut clouds = HashMap::new();
    let mut names: Vec<String> = std::fs::read_dir(folder.join("vectors"))
        .expect("the golden vectors lie under TABULA_DATA/../reference")
        .map(|entry| entry.expect("the folder can be read").path())
        .filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned()))
        .filter(|name| is_wanted(name))
        .collect();
    names.sort();
    names
        .into_iter()
        .map(|name| {
            let rows = Rows::read(&folder, &name);
            let cloud = rows.text("cloud");
            ReferenceVector {
                n_bins: rows.text("bins").parse().expect("bins is a number"),
                variant: variant(&rows),
                frame: frame(&folder, cloud),
                descriptor: rows.numbers("descriptor"),
                cloud: clouds
                    .entry(cloud.to_owned())
                    .or_insert_with_key(|name| read_cloud(&folder, name))
                    .clone(),
                name,
            }
        })
        .collect()
}

/// Object frame of a cloud, which depends on neither program nor parameters.
fn frame(folder: &Path, cloud: &str) -> DescriptorFrame {
    let transform =
        Rows::read(folder, &format!("{cloud}_bins15_thr0.0015")).numbers("transform_rowmajor_4x4");
    let row = |i: usize| std::array::from_fn(|j| transform[4 * i + j]);
    DescriptorFrame {
        object_from_source: [row(0), row(1), row(2)],
    }
}

/// CSV file of rows `key,values...`.
struct Rows(HashMap<String, String>);

impl Rows {
    fn read(folder: &Path, name: &str) -> Self {
        let path = folder.join("vectors").join(format!("{name}.csv"));
        let text = std::fs::read_to_string(path).expect("a golden vector is text");
        let rows = text.lines().filter_map(|row| row.split_once(','));
        Self(
            rows.map(|(key, values)| (key.to_owned(), values.to_owned()))
                .collect(),
        )
    }

    fn text(&self, key: &str) -> &str {
        &self.0[key]
    }

    fn numbers(&self, key: &str) -> Vec<f32> {
        self.0[key]
            .split(',')
            .filter(|v| !v.is_empty())
            .map(|v| v.parse().expect("a value is a number"))
            .collect()
    }
}

fn reference_folder() -> PathBuf {
    test_data::path("../reference/good")
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
