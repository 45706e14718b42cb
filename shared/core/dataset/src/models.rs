//! Folders of models, PLY or OBJ, such as a set of scanned objects.

use crate::bounded_file::{FileError, file_names};
use crate::mesh::Mesh;
use crate::{obj, ply};
use std::fmt;
use std::path::{Path, PathBuf};

/// A file of a folder of models.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Model {
    /// The file.
    pub path: PathBuf,
    /// The number its name begins with: 25 for `025_mug.ply`.
    pub number: Option<u32>,
    /// Its name without number and extension: `mug`. A letter that tells
    /// variants apart is part of the number: `cups` for `065-a_cups.ply`.
    pub name: String,
}

/// Why a folder of models or a model could not be read.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The folder could not be listed.
    File(FileError),
    /// The folder has no models.
    NoModels(PathBuf),
    /// The file is of no known format, by its extension.
    UnknownFormat(PathBuf),
    /// A PLY file can not be used.
    Ply {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: ply::Error,
    },
    /// An OBJ file can not be used.
    Obj {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: obj::Error,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => error.fmt(f),
            Self::NoModels(folder) => write!(
                f,
                "the folder {} holds no models; their names end in .ply or .obj",
                folder.display()
            ),
            Self::UnknownFormat(path) => write!(
                f,
                "the model {} is neither PLY nor OBJ by its name; it must end in .ply or .obj",
                path.display()
            ),
            Self::Ply { path, source } => {
                write!(f, "the model {} can not be used: {source}", path.display())
            }
            Self::Obj { path, source } => {
                write!(f, "the model {} can not be used: {source}", path.display())
            }
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::File(error) => Some(error),
            Self::Ply { source, .. } => Some(source),
            Self::Obj { source, .. } => Some(source),
            Self::NoModels(_) | Self::UnknownFormat(_) => None,
        }
    }
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Self {
        Self::File(error)
    }
}

/// Lists the models of a folder in the natural order of their file names, at
/// least one. They are not opened.
///
/// # Errors
/// When the folder can not be read or has no models.
pub fn list(folder: &Path) -> Result<Vec<Model>, Error> {
    let is_model = |name: &str| Format::of(Path::new(name)).is_some();
    let names = file_names(folder, is_model)?;
    if names.is_empty() {
        return Err(Error::NoModels(folder.to_owned()));
    }
    let model = |file_name: &String| {
        // A model's name has an extension of four bytes.
        let (number, name) = parse_stem(&file_name[..file_name.len() - 4]);
        Model {
            path: folder.join(file_name),
            number,
            name: name.to_owned(),
        }
    };
    Ok(names.iter().map(model).collect())
}

/// Reads a model, PLY or OBJ by its extension.
///
/// # Errors
/// When the file has another extension, can not be read, or is wrong; each
/// error names it.
pub fn open(path: &Path) -> Result<Mesh, Error> {
    match Format::of(path) {
        Some(Format::Ply) => ply::open(path).map_err(|source| Error::Ply {
            path: path.to_owned(),
            source,
        }),
        Some(Format::Obj) => obj::open(path).map_err(|source| Error::Obj {
            path: path.to_owned(),
            source,
        }),
        None => Err(Error::UnknownFormat(path.to_owned())),
    }
}

#[derive(Clone, Copy)]
enum Format {
    Ply,
    Obj,
}

impl Format {
    /// By the extension, in any case.
    fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        [("ply", Self::Ply), ("obj", Self::Obj)]
            .into_iter()
            .find_map(|(known, format)| extension.eq_ignore_ascii_case(known).then_some(format))
    }
}

/// The number and the name in `025_mug` or `065-a_cups`; any other stem is a
/// name as it is.
fn parse_stem(stem: &str) -> (Option<u32>, &str) {
    let parsed = stem.split_once('_').and_then(|(number, name)| {
        let digits = match number.split_once('-') {
            Some((digits, variant)) if is_letter(variant) => digits,
            Some(_) => return None,
            None => number,
        };
        let is_number = digits.bytes().all(|byte| byte.is_ascii_digit());
        let number = digits.parse().ok().filter(|_| is_number)?;
        (!name.is_empty()).then_some((Some(number), name))
    });
    parsed.unwrap_or((None, stem))
}

fn is_letter(text: &str) -> bool {
    matches!(text.as_bytes(), [byte] if byte.is_ascii_alphabetic())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hostile::assert_sentence;

    const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n\
        property float y\nproperty float z\nend_header\n1 2 3\n";

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
    fn a_number_is_told_from_a_name() {
        for (stem, number, name) in [
            ("025_mug", Some(25), "mug"),
            ("065-a_cups", Some(65), "cups"),
            ("002_master_chef_can", Some(2), "master_chef_can"),
            ("mug", None, "mug"),
            ("red_mug", None, "red_mug"),
            ("12", None, "12"),
            ("12_", None, "12_"),
            ("_mug", None, "_mug"),
            ("+1_mug", None, "+1_mug"),
            ("065-ab_cups", None, "065-ab_cups"),
            ("99999999999_mug", None, "99999999999_mug"),
        ] {
            assert_eq!(parse_stem(stem), (number, name), "{stem}");
        }
    }

    #[test]
    fn the_extension_chooses_the_format() {
        let folder = tempfile::tempdir().unwrap();
        for (name, content, n_triangles) in [("a.obj", OBJ, 1), ("b.PLY", PLY, 0)] {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            assert_eq!(open(&path).unwrap().triangles.len(), n_triangles, "{name}");
        }
    }

    #[test]
    fn an_unreadable_model_is_named_with_the_reason() {
        let folder = tempfile::tempdir().unwrap();
        let none = list(folder.path()).unwrap_err();
        for (name, content) in [("a.obj", PLY), ("b.ply", OBJ), ("c.stl", OBJ)] {
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
