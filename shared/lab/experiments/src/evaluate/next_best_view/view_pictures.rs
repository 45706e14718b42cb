//! Pictures of the views that a method chose, side by side.

use super::captured_view::{CAMERA, CapturedView};
use super::closed_loop::LoopCourse;
use super::loop_method::Method;
use evaluation::scene_picture::encode;
use service::Failure;

/// Number of views in a picture.
const N_SHOWN: usize = 4;
/// Gap between the views, pixels.
const GAP_PX: usize = 4;
/// Every how many-th pixel is drawn along rows and columns.
const STRIDE: usize = 2;
const BYTES_PER_PIXEL: usize = 3;

/// One picture for each method with its first views from the first start: file name and PNG.
pub(super) fn draw(
    views: &[CapturedView],
    courses: &[(Method, Vec<LoopCourse>)],
) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let mut pictures = Vec::new();
    for (method, of_method) in courses {
        if let Some(course) = of_method.first() {
            let shown: Vec<&CapturedView> = course
                .views
                .iter()
                .take(N_SHOWN)
                .map(|&view| &views[view])
                .collect();
            let (image, width, height) = beside_each_other(&shown);
            let png = encode(&image, width, height).map_err(Failure::general)?;
            pictures.push((format!("views-{}.png", method.word()), png));
        }
    }
    Ok(pictures)
}

/// Image of some views in one row, its width and height.
fn beside_each_other(views: &[&CapturedView]) -> (Vec<u8>, usize, usize) {
    let (width, height) = (CAMERA.width as usize, CAMERA.height as usize);
    let row_bytes = width * BYTES_PER_PIXEL;
    let mut image = Vec::new();
    for row in (0..height).step_by(STRIDE) {
        for (number, view) in views.iter().enumerate() {
            if number > 0 {
                image.extend([255; GAP_PX * BYTES_PER_PIXEL]);
            }
            let pixels = view.colors.chunks_exact(row_bytes).nth(row).unwrap_or(&[]);
            for pixel in pixels.chunks_exact(BYTES_PER_PIXEL).step_by(STRIDE) {
                image.extend_from_slice(pixel);
            }
        }
    }
    let n_gaps = views.len().saturating_sub(1);
    let total_width = views.len() * width.div_ceil(STRIDE) + n_gaps * GAP_PX;
    (image, total_width, height.div_ceil(STRIDE))
}
