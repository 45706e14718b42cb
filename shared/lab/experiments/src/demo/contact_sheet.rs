//! Contact sheet: what the camera saw and the robot believed, at the events of a demonstration.

use super::demo_stage::DemoStage;
use evaluation::box_picture::{NumberedBox, rgb};
use evaluation::scene_picture::encode;
use geometry::OrientedBox;
use message::{SceneObject, points};
use nalgebra::Vector3;
use service::{Failure, monotonic_ns};

/// Number of pictures beside each other.
const N_COLUMNS: usize = 4;
/// Factor by which the pictures are smaller than the camera's.
const SCALE: usize = 2;

/// Picture of one event, reduced.
struct Tile {
    rgb: Vec<u8>,
    width: usize,
    height: usize,
    caption: String,
}

/// Pictures of a demonstration, in the order of its events.
#[derive(Default)]
pub(super) struct ContactSheet {
    tiles: Vec<Tile>,
}

impl ContactSheet {
    /// Adds the newest frame with the boxes of the tracks.
    pub(super) fn add(&mut self, stage: &DemoStage, caption: String) {
        let Some(cloud) = &stage.cloud else { return };
        let Ok(header) = cloud.header().checked(cloud.items().len(), monotonic_ns()) else {
            return;
        };
        let Some(world_from_camera) = header.world_from_camera else {
            return;
        };
        let camera_from_world = world_from_camera.inverse();
        let numbered = |object: &SceneObject| {
            let world_from_object = object.pose.checked()?;
            Some(NumberedBox {
                number: object.track_id,
                box_in_camera: OrientedBox {
                    frame_from_box: camera_from_world * world_from_object,
                    half_sides_m: 0.5 * Vector3::from(object.size_m.map(f64::from)),
                },
            })
        };
        let boxes: Vec<NumberedBox> = stage.objects.iter().filter_map(numbered).collect();
        let image = rgb(points(cloud.items()), &header.camera, &boxes);
        let size = [header.camera.width as usize, header.camera.height as usize];
        self.tiles.push(Tile {
            rgb: reduced(&image, size),
            width: size[0] / SCALE,
            height: size[1] / SCALE,
            caption,
        });
    }

    /// Captions of the pictures, numbered row by row.
    pub(super) fn captions(&self) -> Vec<String> {
        let captions = self.tiles.iter().enumerate();
        captions
            .map(|(number, tile)| format!("{}: {}", number + 1, tile.caption))
            .collect()
    }

    /// All pictures as one PNG; `None` without one.
    ///
    /// # Errors
    /// If the PNG encoder fails.
    pub(super) fn png(&self) -> Result<Option<Vec<u8>>, Failure> {
        let Some(first) = self.tiles.first() else {
            return Ok(None);
        };
        let (width, height) = (first.width, first.height);
        let n_columns = self.tiles.len().min(N_COLUMNS);
        let n_rows = self.tiles.len().div_ceil(N_COLUMNS);
        let row_bytes = 3 * n_columns * width;
        let mut sheet = vec![255; row_bytes * n_rows * height];
        for (number, tile) in self.tiles.iter().enumerate() {
            let (row, column) = (number / N_COLUMNS, number % N_COLUMNS);
            for (line, pixels) in tile.rgb.chunks_exact(3 * width).enumerate().take(height) {
                let at = (row * height + line) * row_bytes + 3 * column * width;
                sheet[at..at + pixels.len()].copy_from_slice(pixels);
            }
        }
        let file = encode(&sheet, n_columns * width, n_rows * height);
        file.map(Some).map_err(Failure::general)
    }
}

/// Image reduced by the mean over squares of pixels.
fn reduced(image: &[u8], [width, height]: [usize; 2]) -> Vec<u8> {
    let mut small = Vec::with_capacity(image.len() / (SCALE * SCALE));
    for row in 0..height / SCALE {
        for column in 0..width / SCALE {
            for channel in 0..3 {
                let square = (0..SCALE).flat_map(|down| (0..SCALE).map(move |right| (down, right)));
                let sum: usize = square
                    .map(|(down, right)| {
                        let pixel = (SCALE * row + down) * width + SCALE * column + right;
                        usize::from(image[3 * pixel + channel])
                    })
                    .sum();
                small.push((sum / (SCALE * SCALE)) as u8);
            }
        }
    }
    small
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reduction_is_the_mean_of_squares() {
        let image = [0, 4, 8, 12].map(|value| [value; 3]).concat();
        assert_eq!(reduced(&image, [2, 2]), [6, 6, 6]);
    }
}
