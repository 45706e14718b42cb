//! Writer of Washington views.

use super::cloud::write_cloud;
use super::location::format_location;
use super::view::CroppedView;
use super::view_name::ViewName;
use super::{CLOUD_SUFFIX, COLOR_SUFFIX, DEPTH_SUFFIX, LOCATION_SUFFIX, MASK_SUFFIX};
use crate::Error;
use crate::png_image::{PixelKind, encode, to_big_endian_samples};
use file_access::{create_folder, write_atomic};
use geometry::PinholeCamera;
use std::path::Path;

/// Writes a view into `<category>/<category>_<instance>/` of a folder, creating these folders
/// if necessary; with its points if the camera of the whole image is given.
///
/// Each file gets its name when it is complete, the colour image last: a view
/// that was interrupted is not listed, and may be written again.
///
/// # Errors
/// When the view is already there, its vectors do not fill the cut-out, or a
/// file cannot be written.
pub fn write_view(
    root: &Path,
    name: &ViewName,
    view: &CroppedView,
    camera: Option<&PinholeCamera>,
) -> Result<(), Error> {
    view.check()?;
    let (category, instance) = (name.category(), name.instance());
    let folder = root.join(category).join(format!("{category}_{instance}"));
    create_folder(&folder)?;
    let path = |suffix| folder.join(format!("{name}{suffix}"));
    let color_path = path(COLOR_SUFFIX);
    if color_path.exists() {
        return Err(Error::ViewExists(color_path));
    }
    if let Some(camera) = camera {
        write_atomic(&path(CLOUD_SUFFIX), &write_cloud(view, camera)?)?;
    }
    write_atomic(
        &path(LOCATION_SUFFIX),
        format_location(view.top_left).as_bytes(),
    )?;
    let mut depth = Vec::new();
    to_big_endian_samples(&view.depth_mm, &mut depth);
    let mask: Vec<u8> = view
        .mask
        .iter()
        .map(|&value| if value == 0 { 0 } else { 255 })
        .collect();
    for (path, kind, samples) in [
        (path(DEPTH_SUFFIX), PixelKind::Depth, &depth),
        (path(MASK_SUFFIX), PixelKind::Silhouette, &mask),
        (color_path, PixelKind::Color, &view.color),
    ] {
        let mut file = Vec::new();
        encode(kind, view.size, samples, &mut file)
            .map_err(|error| Error::content(&path)(error.into()))?;
        write_atomic(&path, &file)?;
    }
    Ok(())
}
