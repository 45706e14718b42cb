//! Trials of registration: the source of a pair is moved away and registered again.

use crate::arguments::RegistrationArguments;
use indicatif::ProgressBar;
use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use random::{Random, mix64};
use registration::{Prior, ViewOrigin, ViewSurface, register};
use service::Failure;
use std::time::Instant;

/// Rotations of the source about its centroid, degrees.
pub(super) const ROTATIONS_DEG: [f64; 4] = [5.0, 10.0, 15.0, 20.0];
/// Translations of the source, centimetres.
pub(super) const TRANSLATIONS_CM: [f64; 3] = [1.0, 3.0, 5.0];

/// Two views of an object in one frame: the right registration is the identity.
pub(super) struct ViewPair {
    pub(super) name: String,
    /// Points, metres.
    pub(super) target: Vec<[f32; 3]>,
    pub(super) source: Vec<[f32; 3]>,
    /// Places of the cameras of target and source, if known.
    pub(super) viewpoints: Option<[Point3<f64>; 2]>,
}

/// Trial with its errors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trial {
    pub(super) rotation_error_deg: f64,
    /// Error of the source's centroid, millimetres.
    pub(super) translation_error_mm: f64,
    /// Time with all preparation, milliseconds.
    pub(super) ms: f64,
    pub(super) is_rotation_weak: bool,
}

impl Trial {
    /// `true` for an error below 2° and 5 mm.
    pub(super) fn is_success(&self) -> bool {
        self.rotation_error_deg < 2.0 && self.translation_error_mm < 5.0
    }
}

/// Runs all trials of a pair: every rotation with every translation, about and along random
/// directions. A pair that cannot be registered fails by half a turn.
pub(super) fn run(
    pair: &ViewPair,
    arguments: &RegistrationArguments,
    bar: &ProgressBar,
) -> Result<Vec<Trial>, Failure> {
    let mut trials = Vec::new();
    for rotation_deg in ROTATIONS_DEG {
        for translation_cm in TRANSLATIONS_CM {
            for start in 0..u64::from(arguments.starts) {
                let number = trials.len() as u64 ^ (start << 32);
                let mut random = Random::substream(arguments.seed, mix64(number));
                let moved = motion(&pair.source, (rotation_deg, translation_cm), &mut random);
                trials.push(trial(pair, &moved)?);
                bar.inc(1);
            }
        }
    }
    Ok(trials)
}

/// Motion about the centroid of points.
fn motion(
    points: &[[f32; 3]],
    (rotation_deg, translation_cm): (f64, f64),
    random: &mut Random,
) -> Isometry3<f64> {
    let axis = direction(random);
    let rotation = UnitQuaternion::from_axis_angle(&axis, rotation_deg.to_radians());
    let centre = centroid(points).coords;
    let shift = 0.01 * translation_cm * direction(random).into_inner();
    Isometry3::from_parts(
        Translation3::from(centre + shift - rotation * centre),
        rotation,
    )
}

/// Uniformly distributed direction.
fn direction(random: &mut Random) -> Unit<Vector3<f64>> {
    loop {
        let vector = Vector3::from_fn(|_, _| random.between(-1.0, 1.0));
        let length = vector.norm();
        if (0.1..1.0).contains(&length) {
            return Unit::new_unchecked(vector / length);
        }
    }
}

/// Mean of points.
pub(super) fn centroid(points: &[[f32; 3]]) -> Point3<f64> {
    let sum: Vector3<f64> = points.iter().map(|p| Vector3::from(*p).cast::<f64>()).sum();
    Point3::from(sum / points.len().max(1) as f64)
}

fn trial(pair: &ViewPair, moved: &Isometry3<f64>) -> Result<Trial, Failure> {
    let source: Vec<[f32; 3]> = pair
        .source
        .iter()
        .map(|point| {
            (moved * Point3::from(*point).cast::<f64>())
                .cast::<f32>()
                .into()
        })
        .collect();
    let [of_target, of_source] = match pair.viewpoints {
        Some([target, source]) => [target, moved * source].map(|at| Some(ViewOrigin::Camera(at))),
        None => [None; 2],
    };
    let unusable = |error: registration::Error| {
        Failure::usage(format!("the pair {} is unusable: {error}", pair.name))
    };
    let begin = Instant::now();
    let target = ViewSurface::new(&pair.target, of_target).map_err(unusable)?;
    let source = ViewSurface::new(&source, of_source).map_err(unusable)?;
    let found = register(&target, &source, &Prior::at(Isometry3::identity()));
    let ms = begin.elapsed().as_secs_f64() * 1e3;
    let Ok(found) = found else {
        return Ok(Trial {
            rotation_error_deg: 180.0,
            translation_error_mm: f64::INFINITY,
            ms,
            is_rotation_weak: false,
        });
    };
    let off = found.target_from_source * moved;
    let centre = centroid(&pair.source);
    Ok(Trial {
        rotation_error_deg: off.rotation.angle().to_degrees(),
        translation_error_mm: 1e3 * (off * centre - centre).norm(),
        ms,
        is_rotation_weak: found.is_rotation_weak,
    })
}
