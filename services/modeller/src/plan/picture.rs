//! Picture of a plan: the virtual views from the present pose and from the chosen one, side by
//! side, with a colour for each hypothesis.

use crate::png_file;
use geometry::{PinholeCamera, RigidTransform};
use next_best_view::{PlanningScene, RenderConfig, ViewLabel, ViewProjection, VirtualView};
use service::Failure;
use std::path::Path;
use view_planning::{PlanContent, ViewPlan};

/// Width of one view, pixels, up to which cells are enlarged.
const VIEW_WIDTH_PX: usize = 640;
/// Width of the bar between the views, pixels.
const BAR_PX: usize = 8;
/// Colours of the bar, of empty cells and of the background.
const BAR: [u8; 3] = [255; 3];
const EMPTY: [u8; 3] = [24, 26, 30];
const BACKGROUND: [u8; 3] = [150, 150, 150];
/// Colours of the hypotheses by turns, with their names.
const COLORS: [(&str, [u8; 3]); 8] = [
    ("red", [225, 70, 60]),
    ("blue", [70, 130, 230]),
    ("green", [80, 185, 75]),
    ("yellow", [235, 200, 55]),
    ("violet", [165, 95, 205]),
    ("cyan", [70, 200, 200]),
    ("orange", [240, 145, 45]),
    ("pink", [240, 140, 185]),
];
/// Brightness of a surface that is seen from its side.
const BRIGHTNESS_MIN: f32 = 0.35;

/// Image of one view, row-major.
struct Pixels {
    width: usize,
    rows: Vec<Vec<[u8; 3]>>,
}

/// Name of the colour of a hypothesis.
pub(crate) fn color_name(index: usize) -> &'static str {
    COLORS[index % COLORS.len()].0
}

/// Writes the picture; an existing file is replaced when the new one is complete.
///
/// # Errors
/// When the file cannot be written.
pub(crate) fn write(path: &Path, content: &PlanContent, plan: &ViewPlan) -> Result<(), Failure> {
    let (scene, camera) = (content.scene()?, content.virtual_camera());
    let views = [
        pixels(&scene, &plan.present.plan_from_camera, &camera)?,
        pixels(&scene, &plan.views[plan.chosen].plan_from_camera, &camera)?,
    ];
    let (width, height, rgb) = joined(&views);
    png_file::write(path, width, height, &rgb)
}

/// Virtual view in colours, as large as a person wants to see it.
fn pixels(
    scene: &PlanningScene,
    plan_from_camera: &RigidTransform,
    camera: &PinholeCamera,
) -> Result<Pixels, Failure> {
    let config = RenderConfig {
        projection: ViewProjection::Perspective(*camera),
        ..RenderConfig::default()
    };
    let mut view = VirtualView::default();
    view.render(scene, plan_from_camera, &config)
        .map_err(Failure::general)?;
    let (width, height) = (camera.width as usize, camera.height as usize);
    let scale = (VIEW_WIDTH_PX / width.max(1)).max(1);
    let enlarged = |row: usize| {
        let cells = (0..width).map(|column| color(&view, camera, column, row));
        cells.flat_map(|color| [color].repeat(scale)).collect()
    };
    let rows = (0..height).flat_map(|row| {
        let row: Vec<[u8; 3]> = enlarged(row);
        std::iter::repeat_n(row, scale)
    });
    Ok(Pixels {
        width: width * scale,
        rows: rows.collect(),
    })
}

/// Colour of a cell, darker the more its surface is turned away.
fn color(view: &VirtualView, camera: &PinholeCamera, column: usize, row: usize) -> [u8; 3] {
    let base = match view.label(column, row) {
        ViewLabel::Empty => return EMPTY,
        ViewLabel::Background => BACKGROUND,
        ViewLabel::Object(index) => COLORS[index % COLORS.len()].1,
    };
    let label = view.label(column, row);
    let depth_m = |column: usize, row: usize| {
        let is_same = view.label(column, row) == label;
        view.depth_m(column, row).filter(|_| is_same)
    };
    let middle_m = depth_m(column, row).unwrap_or(1.0);
    // Slope: depth over the width of the cells at this depth.
    let slope = |before: Option<f32>, after: Option<f32>, focal_px: f64| match (before, after) {
        (Some(before), Some(after)) => (after - before) / (2.0 * middle_m / focal_px as f32),
        _ => 0.0,
    };
    let across = slope(
        column
            .checked_sub(1)
            .and_then(|column| depth_m(column, row)),
        depth_m(column + 1, row),
        camera.fx_px,
    );
    let down = slope(
        row.checked_sub(1).and_then(|row| depth_m(column, row)),
        depth_m(column, row + 1),
        camera.fy_px,
    );
    let cosine = 1.0 / (1.0 + across * across + down * down).sqrt();
    let brightness = BRIGHTNESS_MIN + (1.0 - BRIGHTNESS_MIN) * cosine;
    base.map(|channel| (f32::from(channel) * brightness) as u8)
}

/// Two views with a bar between them: width, height and pixels, three bytes each.
fn joined([left, right]: &[Pixels; 2]) -> (usize, usize, Vec<u8>) {
    let width = left.width + BAR_PX + right.width;
    let height = left.rows.len().min(right.rows.len());
    let mut bytes = Vec::with_capacity(3 * width * height);
    for (left, right) in left.rows.iter().zip(&right.rows) {
        bytes.extend(left.iter().chain(&[BAR; BAR_PX]).chain(right).flatten());
    }
    (width, height, bytes)
}
