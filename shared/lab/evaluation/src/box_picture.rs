//! Overlay of tracked bounding boxes on the camera's colour image, as PNG.

use crate::scene_picture::{encode, object_color};
use geometry::{OrientedBox, PinholeCamera};
use nalgebra::Point2;
use png::EncodingError;
use point_cloud::Point;

/// Size of a dot of the digit font, pixels.
const DOT_PX: i64 = 3;
/// Bitmap font of the ten digits: five rows of three dots, highest bit leftmost.
const DIGITS: [[u8; 5]; 10] = [
    [7, 5, 5, 5, 7],
    [2, 6, 2, 2, 7],
    [7, 1, 7, 4, 7],
    [7, 1, 7, 1, 7],
    [5, 5, 7, 1, 1],
    [7, 4, 7, 1, 7],
    [7, 4, 7, 5, 7],
    [7, 1, 2, 2, 2],
    [7, 5, 7, 5, 7],
    [7, 5, 7, 1, 7],
];

/// Bounding box with its drawn number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NumberedBox {
    /// Number drawn at the centre, such as the track-id.
    pub number: u64,
    /// Bounding box in the camera frame.
    pub box_in_camera: OrientedBox,
}

/// Colour image of an organised cloud with wire-frame boxes, as PNG. Boxes that reach behind the
/// camera are omitted.
///
/// # Errors
/// If the PNG encoder fails.
pub fn draw(
    points: &[Point],
    camera: &PinholeCamera,
    boxes: &[NumberedBox],
) -> Result<Vec<u8>, EncodingError> {
    let rgb = rgb(points, camera, boxes);
    encode(&rgb, camera.width as usize, camera.height as usize)
}

/// The same image as its pixels: red, green and blue of each, row-major, of the camera's size.
pub fn rgb(points: &[Point], camera: &PinholeCamera, boxes: &[NumberedBox]) -> Vec<u8> {
    let mut canvas = Canvas::of(points, camera);
    for numbered in boxes {
        let color = object_color(numbered.number as usize);
        canvas.draw_box(camera, numbered, color);
    }
    for numbered in boxes {
        let color = object_color(numbered.number as usize);
        let centre = camera.project(&numbered.box_in_camera.centre());
        if let Some(centre) = centre {
            canvas.write(numbered.number, &centre, color);
        }
    }
    canvas.rgb
}

struct Canvas {
    rgb: Vec<u8>,
    width: usize,
    height: usize,
}

impl Canvas {
    fn of(points: &[Point], camera: &PinholeCamera) -> Self {
        Self {
            rgb: points.iter().flat_map(|point| point.color.rgb()).collect(),
            width: camera.width as usize,
            height: camera.height as usize,
        }
    }

    fn set(&mut self, column: i64, row: i64, color: [u8; 3]) {
        let is_inside =
            (0..self.width as i64).contains(&column) && (0..self.height as i64).contains(&row);
        if is_inside {
            let pixel = row as usize * self.width + column as usize;
            if let Some(rgb) = self.rgb.get_mut(3 * pixel..3 * pixel + 3) {
                rgb.copy_from_slice(&color);
            }
        }
    }

    fn draw_box(&mut self, camera: &PinholeCamera, numbered: &NumberedBox, color: [u8; 3]) {
        let corners = numbered.box_in_camera.corners();
        let corners: Option<Vec<Point2<f64>>> = corners
            .iter()
            .map(|corner| camera.project(corner))
            .collect();
        let Some(corners) = corners else { return };
        for i in 0..8_usize {
            for axis in 0..3 {
                let other = i | 1 << axis;
                if other != i {
                    self.line(&corners[i], &corners[other], color);
                }
            }
        }
    }

    /// Draws a line two pixels wide.
    fn line(&mut self, from: &Point2<f64>, to: &Point2<f64>, color: [u8; 3]) {
        // Lines far outside the image need no more steps.
        let most = 4.0 * (self.width + self.height) as f64;
        let n_steps = (to - from).amax().min(most).ceil().max(1.0);
        for step in 0..=n_steps as usize {
            let at = from + (to - from) * (step as f64 / n_steps);
            let (column, row) = (at.x.round() as i64, at.y.round() as i64);
            self.set(column, row, color);
            self.set(column + 1, row, color);
            self.set(column, row + 1, color);
        }
    }

    /// Draws a number centred at a point, on black.
    fn write(&mut self, number: u64, at: &Point2<f64>, color: [u8; 3]) {
        let text = number.to_string();
        let width_px = (4 * text.len() as i64 + 1) * DOT_PX;
        let (left, top) = (at.x as i64 - width_px / 2, at.y as i64 - 4 * DOT_PX);
        self.fill(left, top, width_px, 7 * DOT_PX, [0; 3]);
        for (place, digit) in text.bytes().enumerate() {
            let rows = DIGITS[usize::from(digit - b'0') % 10];
            for (row, dots) in rows.into_iter().enumerate() {
                for column in (0..3).filter(|column| dots >> (2 - column) & 1 == 1) {
                    let x = left + (4 * place as i64 + column + 1) * DOT_PX;
                    self.fill(x, top + (row as i64 + 1) * DOT_PX, DOT_PX, DOT_PX, color);
                }
            }
        }
    }

    fn fill(&mut self, left: i64, top: i64, width: i64, height: i64, color: [u8; 3]) {
        for row in top..top.saturating_add(height) {
            for column in left..left.saturating_add(width) {
                self.set(column, row, color);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::RigidTransform;
    use nalgebra::Vector3;
    use point_cloud::Rgba;
    use std::io::Cursor;

    const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;

    fn boxed(z: f64) -> NumberedBox {
        NumberedBox {
            number: 120,
            box_in_camera: OrientedBox {
                frame_from_box: RigidTransform::translation(0.0, 0.0, z),
                half_sides_m: Vector3::repeat(0.1),
            },
        }
    }

    fn pixels(boxes: &[NumberedBox]) -> Vec<u8> {
        let grey = Point::without_depth(Rgba::opaque(90, 90, 90));
        let file = draw(&vec![grey; CAMERA.n_pixels()], &CAMERA, boxes).unwrap();
        let mut reader = png::Decoder::new(Cursor::new(file)).read_info().unwrap();
        let mut image = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut image).unwrap();
        image
    }

    fn at(image: &[u8], column: usize, row: usize) -> &[u8] {
        let pixel = row * CAMERA.width as usize + column;
        &image[3 * pixel..3 * pixel + 3]
    }

    #[test]
    fn corners_are_projected_and_other_pixels_unchanged() {
        let image = pixels(&[boxed(1.0)]);
        // Projection: 585 px * 0.1 m / 0.9 m = 65 px from the principal point.
        assert_eq!(at(&image, 385, 305), object_color(120));
        assert_eq!(at(&image, 400, 305), [90; 3]);
        // The number's background is black.
        assert_eq!(at(&image, 319 - 18, 239 - 11), [0; 3]);
    }

    #[test]
    fn boxes_behind_the_camera_are_omitted() {
        assert!(pixels(&[boxed(-1.0), boxed(0.05)]).len() == 3 * CAMERA.n_pixels());
        let near = boxed(0.101);
        assert!(pixels(&[near]).len() == 3 * CAMERA.n_pixels());
    }
}
