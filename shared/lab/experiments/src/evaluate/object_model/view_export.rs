//! Export of the views of an orbit with their poses and the truth, for other programs to compare
//! with.

use super::orbit::{Orbit, Path};
use super::trial::{PoseNoise, Trial};
use super::true_surface::TrueSurface;
use crate::output_files::{create_folder, write};
use nalgebra::Isometry3;
use serde::Serialize;
use service::Failure;
use std::path::Path as FilePath;

/// Name of the document of an orbit.
const VIEWS: &str = "views.json";

/// Rigid transform as the rows of a matrix.
type Rows = [[f64; 4]; 4];

#[derive(Debug, Serialize)]
struct ExportedOrbit {
    camera: ExportedCamera,
    views: Vec<ExportedView>,
    levels: Vec<ExportedLevel>,
}

#[derive(Debug, Serialize)]
struct ExportedCamera {
    width: u32,
    height: u32,
    fx_px: f64,
    fy_px: f64,
    cx_px: f64,
    cy_px: f64,
}

#[derive(Debug, Serialize)]
struct ExportedView {
    points: String,
    object_from_camera: Rows,
}

/// Poses of all views at a noise level, in the frame of the true object.
#[derive(Debug, Serialize)]
struct ExportedLevel {
    sigma_translation_mm: f64,
    sigma_rotation_deg: f64,
    reported: Vec<Rows>,
    /// Registered poses, in the frame of the model; null for refused views.
    registered: Vec<Option<Rows>>,
}

/// Writes the views of an orbit with its trials at all levels, and the visible samples of the true
/// surface.
pub(super) fn write_orbit(
    folder: &FilePath,
    orbit: &Orbit,
    (truth, visible): (&TrueSurface, &[bool]),
    trials: &[(Path, PoseNoise, Trial)],
) -> Result<(), Failure> {
    create_folder(folder)?;
    let object_from_world = orbit.world_from_object.inverse();
    let mut views = Vec::new();
    for (index, view) in orbit.views.iter().enumerate() {
        let points = format!("{index:03}.f32");
        let values = view.points.iter().flat_map(|point| {
            let [red, green, blue] = point.color.rgb().map(f32::from);
            [point.x, point.y, point.z, red, green, blue]
        });
        write(&folder.join(&points), &bytes(values))?;
        views.push(ExportedView {
            points,
            object_from_camera: rows(&(object_from_world * view.world_from_camera)),
        });
    }
    let samples = truth.oriented_samples().zip(visible);
    let samples = samples.filter_map(|(sample, is_visible)| is_visible.then_some(sample));
    write(&folder.join("visible.f32"), &bytes(samples.flatten()))?;
    let document = ExportedOrbit {
        camera: exported_camera(orbit),
        views,
        levels: trials
            .iter()
            .map(|(_, noise, trial)| exported_level(orbit, *noise, trial))
            .collect(),
    };
    let json = serde_json::to_string_pretty(&document).map_err(Failure::general)?;
    write(&folder.join(VIEWS), json.as_bytes())
}

/// Writes all samples of the true surface: place and normal.
pub(super) fn write_surface(folder: &FilePath, truth: &TrueSurface) -> Result<(), Failure> {
    create_folder(folder)?;
    let samples = truth.oriented_samples().flatten();
    write(&folder.join("surface.f32"), &bytes(samples))
}

fn exported_camera(orbit: &Orbit) -> ExportedCamera {
    let camera = &orbit.camera;
    ExportedCamera {
        width: camera.width,
        height: camera.height,
        fx_px: camera.fx_px,
        fy_px: camera.fy_px,
        cx_px: camera.cx_px,
        cy_px: camera.cy_px,
    }
}

fn exported_level(orbit: &Orbit, noise: PoseNoise, trial: &Trial) -> ExportedLevel {
    let object_from_world = orbit.world_from_object.inverse();
    let registered = |captured_ns: u64| {
        let fused = trial.fused.iter();
        let mut of_view = fused.filter(|view| view.captured_ns == captured_ns);
        of_view.next().map(|view| rows(&view.object_from_camera))
    };
    ExportedLevel {
        sigma_translation_mm: noise.translation_mm,
        sigma_rotation_deg: noise.rotation_deg,
        reported: trial
            .reported
            .iter()
            .map(|pose| rows(&(object_from_world * pose)))
            .collect(),
        registered: orbit
            .views
            .iter()
            .map(|view| registered(view.captured_ns))
            .collect(),
    }
}

fn rows(pose: &Isometry3<f64>) -> Rows {
    pose.to_homogeneous().transpose().into()
}

/// Little-endian bytes of numbers.
fn bytes(values: impl Iterator<Item = f32>) -> Vec<u8> {
    values.flat_map(f32::to_le_bytes).collect()
}
