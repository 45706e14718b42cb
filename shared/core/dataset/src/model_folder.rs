//! Folders of models in several formats, such as a set of scanned objects.

use crate::{FileModel, ModelError, dae, obj, ply, stl};
use file_access::{FileError, file_names};
use std::path::{Path, PathBuf};

/// Model file found in a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelFile {
    /// Path of the model file.
    pub path: PathBuf,
    /// Number at the start of the file name: 25 for `025_mug.ply`.
    pub number: Option<u32>,
    /// Name without number and extension, such as `mug`. A variant letter belongs to the name:
    /// `a_cups` for `065-a_cups.ply`.
    pub name: String,
}

/// Error of listing a folder of models or reading a model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to the model folder.
    #[error("{0}")]
    File(#[from] FileError),
    /// Folder without models.
    #[error("the folder {} holds no models; their names end in .ply, .obj, .stl or .dae", .0.display())]
    NoModels(PathBuf),
    /// File whose extension is that of no known format.
    #[error(
        "the model {} is neither PLY, OBJ, STL nor DAE by its name; it must end in .ply, .obj, \
         .stl or .dae",
        .0.display()
    )]
    UnknownFormat(PathBuf),
    /// Invalid model file.
    #[error("the model {} cannot be used: {source}", .path.display())]
    Model {
        /// Path of the model file.
        path: PathBuf,
        /// Error in the content of the model file.
        source: ModelError,
    },
}

/// Lists the models of a folder, at least one, in natural order of their file names. The files
/// are not opened.
///
/// # Errors
/// When the folder cannot be read or has no models.
pub fn list(folder: &Path) -> Result<Vec<ModelFile>, Error> {
    let is_model = |name: &str| Format::of(Path::new(name)).is_some();
    let names = file_names(folder, is_model)?;
    if names.is_empty() {
        return Err(Error::NoModels(folder.to_owned()));
    }
    let model = |file_name: &String| {
        // A model's name has an extension of four bytes.
        let (number, name) = number_and_name(&file_name[..file_name.len() - 4]);
        ModelFile {
            path: folder.join(file_name),
            number,
            name: name.to_owned(),
        }
    };
    Ok(names.iter().map(model).collect())
}

/// Extensions of formats of models that are not read.
const UNREAD_EXTENSIONS: [&str; 12] = [
    "glb", "gltf", "fbx", "off", "3ds", "x3d", "wrl", "step", "stp", "usd", "usdz", "blend",
];

/// Names of the models of a folder that are in a format that is not read, in natural order.
///
/// # Errors
/// When the folder cannot be read.
pub fn unread(folder: &Path) -> Result<Vec<String>, Error> {
    let is_unread = |name: &str| {
        let extension = Path::new(name).extension();
        extension.is_some_and(|extension| {
            let mut unread = UNREAD_EXTENSIONS.iter();
            unread.any(|unread| extension.eq_ignore_ascii_case(unread))
        })
    };
    Ok(file_names(folder, is_unread)?)
}

/// Reads a model; its extension tells the format.
///
/// # Errors
/// When the file has another extension, cannot be read, or is wrong; each
/// error names it.
pub fn open(path: &Path) -> Result<FileModel, Error> {
    let model = match Format::of(path) {
        Some(Format::Ply) => ply::open(path).map(FileModel::from).map_err(Into::into),
        Some(Format::Obj) => obj::open(path),
        Some(Format::Stl) => stl::open(path).map(FileModel::from),
        Some(Format::Dae) => dae::open(path),
        None => return Err(Error::UnknownFormat(path.to_owned())),
    };
    model.map_err(|source| Error::Model {
        path: path.to_owned(),
        source,
    })
}

#[derive(Clone, Copy)]
enum Format {
    Ply,
    Obj,
    Stl,
    Dae,
}

impl Format {
    /// Format by the file extension, in upper or lower case.
    fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        [
            ("ply", Self::Ply),
            ("obj", Self::Obj),
            ("stl", Self::Stl),
            ("dae", Self::Dae),
        ]
        .into_iter()
        .find_map(|(known, format)| extension.eq_ignore_ascii_case(known).then_some(format))
    }
}

/// Splits the stem of a file name into the number at its start and the name behind `_` or `-`:
/// `025_mug` into 25 and `mug`, `065-a_cups` into 65 and `a_cups`; any other stem is a name without
/// number. A number beyond 32 bits is left out.
pub fn number_and_name(stem: &str) -> (Option<u32>, &str) {
    let rest = stem.trim_start_matches(|c: char| c.is_ascii_digit());
    let digits = &stem[..stem.len() - rest.len()];
    let name = rest.strip_prefix(['_', '-']).unwrap_or_default();
    if digits.is_empty() || name.is_empty() {
        (None, stem)
    } else {
        (digits.parse().ok(), name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mutation_fuzzing::assert_sentence;

    const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n\
        property float y\nproperty float z\nend_header\n1 2 3\n";

    const STL: &str = "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
        endloop\nendfacet\nendsolid\n";

    #[test]
    fn models_come_in_natural_order_with_number_and_name() {
        let folder = tempfile::tempdir().unwrap();
        for name in [
            "100_fork.obj",
            "025_mug.ply",
            "9_a_b.PLY",
            "notes.txt",
            ".ply",
            "a.mtl",
        ] {
            std::fs::write(folder.path().join(name), []).unwrap();
        }
        let models = list(folder.path()).unwrap();
        let listed: Vec<_> = models
            .iter()
            .map(|model| (model.number, model.name.as_str()))
            .collect();
        assert_eq!(
            listed,
            [(Some(9), "a_b"), (Some(25), "mug"), (Some(100), "fork")]
        );
        assert_eq!(models[1].path, folder.path().join("025_mug.ply"));
    }

    #[test]
    fn number_and_name_are_separated() {
        for (stem, number, name) in [
            ("025_mug", Some(25), "mug"),
            ("065-a_cups", Some(65), "a_cups"),
            ("002_master_chef_can", Some(2), "master_chef_can"),
            ("mug", None, "mug"),
            ("red_mug", None, "red_mug"),
            ("12", None, "12"),
            ("12_", None, "12_"),
            ("_mug", None, "_mug"),
            ("+1_mug", None, "+1_mug"),
            ("065-ab_cups", Some(65), "ab_cups"),
            ("12-mug", Some(12), "mug"),
            ("3d_puzzle", None, "3d_puzzle"),
            ("99999999999_mug", None, "mug"),
        ] {
            assert_eq!(number_and_name(stem), (number, name), "{stem}");
        }
    }

    #[test]
    fn the_extension_chooses_the_format() {
        let folder = tempfile::tempdir().unwrap();
        for (name, content, n_triangles) in
            [("a.obj", OBJ, 1), ("b.PLY", PLY, 0), ("c.Stl", STL, 1)]
        {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            assert_eq!(
                open(&path).unwrap().mesh.triangles.len(),
                n_triangles,
                "{name}"
            );
        }
    }

    #[test]
    fn an_unreadable_model_is_named_with_the_reason() {
        let folder = tempfile::tempdir().unwrap();
        let none = list(folder.path()).unwrap_err();
        for (name, content) in [
            ("a.obj", PLY),
            ("b.ply", OBJ),
            ("c.stl", OBJ),
            ("d.glb", OBJ),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            let error = open(&path).unwrap_err();
            assert_sentence(&error);
            assert!(error.to_string().contains(name), "{error}");
        }
        assert_sentence(&none);
        assert_sentence(&open(&folder.path().join("missing.ply")).unwrap_err());
        assert_sentence(&list(&folder.path().join("missing")).unwrap_err());
    }
}
