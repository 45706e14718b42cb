//! Side-by-side picture of a scene: colour, ground truth, result, as PNG.

use crate::hypothesis_image::HypothesisImages;
use crate::labelled_scenes::LabelledScene;
use crate::segmentation_score::{FIRST_OBJECT_LABEL, Overlaps};
use detection::{SurfaceRole, Table};
use geometry::PinholeCamera;
use png::{BitDepth, ColorType, EncodingError};
use point_cloud::Point;

/// Distance from the table plane, within its polygon, painted as table, metres.
const TABLE_BAND_M: f64 = 0.01;
/// Gap between the panels, pixels.
const GAP_PX: usize = 4;
/// Width of the stripes on hypotheses that ψ ignores, pixels.
const STRIPE_PX: usize = 5;
const GAP_COLOR: [u8; 3] = [255; 3];
/// Colour of hypotheses too small to count.
const UNSCORED_COLOR: [u8; 3] = [150; 3];
/// Camera model for drawing unorganised clouds.
const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;

/// Overlay colour of a pixel in a scene picture.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Paint {
    Nothing,
    Surface(SurfaceRole),
    /// Object or hypothesis, painted in its own colour.
    Object([u8; 3]),
    /// Hypothesis that the metric ψ ignores, drawn striped.
    Ignored([u8; 3]),
}

/// Draws a scene as PNG in three panels: the colour image, the labelled objects if there are any,
/// and the hypotheses in the colours of their matched objects.
///
/// The table (in the ground truth: whatever is labelled and no object) is green, a further level
/// blue, and a surface without objects brown; hypotheses that
/// ψ ignores are striped, those too small to count are grey, and points without depth are dark.
/// An unorganised cloud is projected into a Kinect's image.
///
/// # Errors
/// If the PNG encoder fails.
pub fn draw(
    scene: &LabelledScene,
    surfaces: &[Table],
    found: &HypothesisImages,
    overlaps: &Overlaps,
) -> Result<Vec<u8>, EncodingError> {
    let truth: Vec<Paint> = scene
        .labels
        .iter()
        .map(|&label| paint_of_label(label, overlaps))
        .collect();
    let has_truth = truth.iter().any(|paint| *paint != Paint::Nothing);
    let result = paint_result(scene, surfaces, found, overlaps);
    let panels = [
        Some(None),
        has_truth.then_some(Some(&truth)),
        Some(Some(&result)),
    ];
    let n_panels = panels.iter().flatten().count();
    let grid = PixelGrid::of(scene);
    let width = n_panels * (grid.width + GAP_PX) - GAP_PX;
    let mut image = Vec::with_capacity(3 * width * grid.height);
    for row in 0..grid.height {
        for (i, paint_of) in panels.into_iter().flatten().enumerate() {
            if i > 0 {
                image.extend(GAP_COLOR.repeat(GAP_PX));
            }
            for column in 0..grid.width {
                let is_stripe = ((row + column) / STRIPE_PX).is_multiple_of(2);
                let color = grid.point_at(row, column).map_or([0; 3], |point_idx| {
                    let paint = paint_of.map_or(Paint::Nothing, |paint_of| paint_of[point_idx]);
                    painted(&scene.points[point_idx], paint, is_stripe)
                });
                image.extend(color);
            }
        }
    }
    encode(&image, width, grid.height)
}

/// RGB image as PNG; `image` holds three bytes a pixel, row-major.
///
/// # Errors
/// If the PNG encoder fails.
pub fn encode(image: &[u8], width: usize, height: usize) -> Result<Vec<u8>, EncodingError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(image)?;
    writer.finish()?;
    Ok(file)
}

fn paint_of_label(label: u16, overlaps: &Overlaps) -> Paint {
    match overlaps.labels().binary_search(&label) {
        Ok(object) => Paint::Object(object_color(object)),
        Err(_) if (1..FIRST_OBJECT_LABEL).contains(&label) => Paint::Surface(SurfaceRole::Table),
        Err(_) => Paint::Nothing,
    }
}

fn paint_result(
    scene: &LabelledScene,
    surfaces: &[Table],
    found: &HypothesisImages,
    overlaps: &Overlaps,
) -> Vec<Paint> {
    let matches = overlaps.matches();
    let object_of = |h: usize| matches.iter().position(|matched| *matched == Some(h));
    // Unmatched hypotheses get the colours after those of the objects.
    let colors: Vec<[u8; 3]> = (0..overlaps.numbers().len())
        .map(|h| object_color(object_of(h).unwrap_or(matches.len() + h)))
        .collect();
    let surface_of = |point: &Point| {
        let is_on = |surface: &&Table| {
            let p = surface.table_from_camera * point.position();
            p.z.abs() < TABLE_BAND_M && surface.polygon.contains(&p.xy())
        };
        surfaces.iter().find(is_on).map(|surface| surface.role)
    };
    let numbers = found.before_psi.iter().zip(&found.after_psi);
    let paint = |(point, (&before, &after)): (&Point, (&u16, &u16))| {
        let color = || {
            let hypothesis = overlaps.numbers().binary_search(&before);
            hypothesis.map_or(UNSCORED_COLOR, |hypothesis| colors[hypothesis])
        };
        match (before, after) {
            (0, _) => surface_of(point).map_or(Paint::Nothing, Paint::Surface),
            (_, 0) => Paint::Ignored(color()),
            _ => Paint::Object(color()),
        }
    };
    scene.points.iter().zip(numbers).map(paint).collect()
}

fn surface_color(role: SurfaceRole) -> [u8; 3] {
    match role {
        SurfaceRole::Table => [70, 190, 90],
        SurfaceRole::Level => [60, 120, 255],
        SurfaceRole::NewLevel | SurfaceRole::Floor => [170, 100, 40],
    }
}

fn painted(point: &Point, paint: Paint, is_stripe: bool) -> [u8; 3] {
    let rgb = point.color.rgb();
    let mixed = |color: [u8; 3], share: u32| {
        let channel =
            |i: usize| ((u32::from(rgb[i]) * (8 - share) + u32::from(color[i]) * share) / 8) as u8;
        [channel(0), channel(1), channel(2)]
    };
    match paint {
        Paint::Nothing if point.is_finite() => rgb,
        Paint::Nothing => mixed([0; 3], 5),
        Paint::Surface(role) => mixed(surface_color(role), 3),
        Paint::Ignored(_) if is_stripe => mixed([0; 3], 6),
        Paint::Object(color) | Paint::Ignored(color) => mixed(color, 6),
    }
}

/// Qualitative palette that differs from the table's colour, without a repetition among 24 objects.
pub(crate) fn object_color(index: usize) -> [u8; 3] {
    const COLORS: [[u8; 3]; 24] = [
        [230, 25, 35],
        [30, 90, 255],
        [255, 200, 0],
        [240, 50, 220],
        [0, 220, 240],
        [255, 120, 10],
        [110, 20, 170],
        [190, 255, 60],
        [140, 70, 20],
        [255, 175, 200],
        [10, 20, 110],
        [245, 245, 245],
        [150, 0, 30],
        [100, 170, 255],
        [130, 110, 0],
        [140, 90, 255],
        [0, 110, 130],
        [255, 160, 120],
        [60, 0, 60],
        [255, 250, 160],
        [190, 0, 110],
        [130, 130, 130],
        [120, 30, 0],
        [200, 255, 250],
    ];
    COLORS[index % COLORS.len()]
}

/// Index of the point seen in each pixel.
struct PixelGrid {
    width: usize,
    height: usize,
    /// Nearest point of each pixel; `None` for an organised cloud.
    nearest: Option<Vec<Option<usize>>>,
}

impl PixelGrid {
    fn of(scene: &LabelledScene) -> Self {
        if scene.width > 1 && scene.height > 1 {
            let (width, height) = (scene.width, scene.height);
            return Self {
                width,
                height,
                nearest: None,
            };
        }
        let (width, height) = (CAMERA.width as usize, CAMERA.height as usize);
        let mut nearest: Vec<Option<usize>> = vec![None; width * height];
        for (point_idx, point) in scene.points.iter().enumerate() {
            if let Some([column, row]) = CAMERA.pixel_of(&point.position()) {
                let seen = &mut nearest[row * width + column];
                if seen.is_none_or(|other| point.z < scene.points[other].z) {
                    *seen = Some(point_idx);
                }
            }
        }
        Self {
            width,
            height,
            nearest: Some(nearest),
        }
    }

    fn point_at(&self, row: usize, column: usize) -> Option<usize> {
        let pixel = row * self.width + column;
        self.nearest
            .as_ref()
            .map_or(Some(pixel), |nearest| nearest[pixel])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::Rgba;
    use std::io::Cursor;

    /// Columns of 120 points: invalid, table, object, object.
    fn scene(width: usize, height: usize) -> LabelledScene {
        let labels: Vec<u16> = (0..480).map(|i| [0, 1, 20, 30][i % 4]).collect();
        let point = |(i, &label): (usize, &u16)| {
            let color = Rgba::opaque(100, 100, 100);
            let seen = CAMERA.back_project((i % 40) as f64, (i / 40) as f64, 1.0);
            match label {
                0 => Point::without_depth(color),
                _ => Point {
                    x: seen.x as f32,
                    y: seen.y as f32,
                    z: 1.0,
                    color,
                },
            }
        };
        LabelledScene {
            points: labels.iter().enumerate().map(point).collect(),
            labels,
            has_part_labels: false,
            width,
            height,
            up_in_camera: None,
        }
    }

    /// Size of the picture, and a pixel's colour in each of the three panels.
    fn pixels(scene: &LabelledScene, column: usize) -> ((u32, u32), [[u8; 3]; 3]) {
        // Swapped hypothesis numbers; the second hypothesis is ignored.
        let before_psi: Vec<u16> = scene
            .labels
            .iter()
            .map(|&l| [0, 0, 2, 1][l as usize / 10])
            .collect();
        let after_psi = before_psi
            .iter()
            .map(|&h| if h == 2 { 0 } else { h })
            .collect();
        let found = HypothesisImages {
            before_psi,
            after_psi,
        };
        let overlaps = Overlaps::count(&found.before_psi, &scene.labels);
        let file = draw(scene, &[], &found, &overlaps).unwrap();
        let mut reader = png::Decoder::new(Cursor::new(file)).read_info().unwrap();
        let mut image = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut image).unwrap();
        let panel = (info.width as usize - 2 * GAP_PX) / 3 + GAP_PX;
        let at = |i: usize| {
            let pixel = i * panel + column;
            [image[3 * pixel], image[3 * pixel + 1], image[3 * pixel + 2]]
        };
        ((info.width, info.height), [at(0), at(1), at(2)])
    }

    #[test]
    fn a_matched_hypothesis_has_the_colour_of_its_object() {
        let scene = scene(40, 12);
        for column in [3, 11] {
            let (size, [color, truth, result]) = pixels(&scene, column);
            assert_eq!(size, (3 * 40 + 2 * GAP_PX as u32, 12));
            assert_eq!(color, [100; 3]);
            assert_eq!(truth, result);
            assert_ne!(truth, color);
        }
    }

    #[test]
    fn ignored_hypotheses_are_striped() {
        let scene = scene(40, 12);
        let (_, [_, truth, stripe]) = pixels(&scene, 2);
        let (_, [_, _, between]) = pixels(&scene, 6);
        assert_eq!(between, truth);
        assert_ne!(stripe, truth);
    }

    #[test]
    fn pixels_without_depth_are_dark_and_the_table_is_green() {
        let (_, [dark, _, _]) = pixels(&scene(40, 12), 0);
        assert_eq!(dark, [37; 3]);
        let (_, [_, [red, green, blue], _]) = pixels(&scene(40, 12), 1);
        assert!(green > red && green > blue);
    }

    #[test]
    fn an_unorganised_cloud_is_projected() {
        let (organised, unorganised) = (scene(40, 12), scene(480, 1));
        for column in [1, 2, 3] {
            let (size, colors) = pixels(&unorganised, column);
            assert_eq!(size, (3 * 640 + 2 * GAP_PX as u32, 480));
            assert_eq!(colors, pixels(&organised, column).1);
        }
        // Points without depth are not projected.
        assert_eq!(pixels(&unorganised, 0).1, [[0; 3]; 3]);
    }

    #[test]
    fn neighbouring_colours_differ() {
        for index in 0..40 {
            let (a, b) = (object_color(index), object_color(index + 1));
            let difference: i32 = (0..3)
                .map(|i| (i32::from(a[i]) - i32::from(b[i])).abs())
                .sum();
            assert!(difference > 100, "{index}: {a:?} {b:?}");
        }
    }
}
