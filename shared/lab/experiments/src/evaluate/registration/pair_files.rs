//! Files of point pairs: `NAME_src.f32` and `NAME_tgt.f32`.

use super::trials::ViewPair;
use crate::output_files::{create_folder, write};
use service::Failure;
use std::path::Path;

/// Bytes of a point: three little-endian single-precision numbers.
const POINT_BYTES: usize = 12;

/// Endings of the names of sources and targets.
const SOURCE: &str = "_src.f32";
const TARGET: &str = "_tgt.f32";

/// Reads all pairs of a folder, ordered by name. Both views of a pair are in one frame, metres.
pub(super) fn read(folder: &Path) -> Result<Vec<ViewPair>, Failure> {
    let is_source = |name: &str| name.ends_with(SOURCE);
    let mut names = file_access::file_names(folder, is_source).map_err(Failure::usage)?;
    if names.is_empty() {
        return Err(Failure::usage(format!(
            "the folder {} has no pairs of views, which are files NAME{SOURCE} and NAME{TARGET}",
            folder.display()
        )));
    }
    names.sort_unstable();
    let pair = |file: String| {
        let name = file.strip_suffix(SOURCE).unwrap_or(&file).to_owned();
        Ok(ViewPair {
            target: points(&folder.join(format!("{name}{TARGET}")))?,
            source: points(&folder.join(format!("{name}{SOURCE}")))?,
            viewpoints: None,
            name,
        })
    };
    names.into_iter().map(pair).collect()
}

/// Writes pairs into a folder, for other programs to compare with.
pub(super) fn write_all(pairs: &[ViewPair], folder: &Path) -> Result<(), Failure> {
    create_folder(folder)?;
    for pair in pairs {
        for (points, ending) in [(&pair.target, TARGET), (&pair.source, SOURCE)] {
            let values = points.as_flattened().iter();
            let bytes: Vec<u8> = values.flat_map(|value| value.to_le_bytes()).collect();
            write(&folder.join(format!("{}{ending}", pair.name)), &bytes)?;
        }
    }
    Ok(())
}

fn points(file: &Path) -> Result<Vec<[f32; 3]>, Failure> {
    let bytes = std::fs::read(file).map_err(|error| {
        Failure::usage(format!(
            "the view {} cannot be read: {error}",
            file.display()
        ))
    })?;
    let (points, rest) = bytes.as_chunks::<POINT_BYTES>();
    if !rest.is_empty() {
        return Err(Failure::usage(format!(
            "the view {} has {} bytes, which is no multiple of the {POINT_BYTES} bytes of a point",
            file.display(),
            bytes.len()
        )));
    }
    let point = |bytes: &[u8; POINT_BYTES]| {
        let (values, _) = bytes.as_chunks::<4>();
        std::array::from_fn(|axis| f32::from_le_bytes(values[axis]))
    };
    Ok(points.iter().map(point).collect())
}
