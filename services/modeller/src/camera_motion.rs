//! Motion of the camera while a model grows: what a person can be told to move.

use nalgebra::Isometry3;
use serde::Serialize;

/// Move of a camera that counts as none, metres and radians. Chosen.
const STILL_CAMERA_M: f64 = 0.01;
const STILL_CAMERA_RAD: f64 = 1.0_f64.to_radians();

/// Thing to move for another view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Mover {
    /// The camera, which has moved already.
    Camera,
    /// The object, before a camera that has not moved.
    Object,
    /// The camera or the object: the pose of the camera is not known.
    Either,
}

/// Motion of the camera since the first view.
#[derive(Debug, Default)]
pub(crate) struct CameraMotion {
    first: Option<Isometry3<f64>>,
    has_moved: bool,
}

impl CameraMotion {
    /// Takes the pose of the next view; `None` where it is not known.
    pub(crate) fn note(&mut self, pose: Option<Isometry3<f64>>) {
        if let Some(pose) = pose {
            let first = self.first.get_or_insert(pose);
            self.has_moved |= has_moved(first, &pose);
        }
    }

    /// Thing that a person can move.
    pub(crate) fn mover(&self) -> Mover {
        match self.first {
            None => Mover::Either,
            Some(_) if self.has_moved => Mover::Camera,
            Some(_) => Mover::Object,
        }
    }
}

/// `true` if two poses of a camera are further apart than a camera that stands still is measured.
pub(crate) fn has_moved(then: &Isometry3<f64>, now: &Isometry3<f64>) -> bool {
    let moved = then.inverse() * now;
    moved.translation.vector.norm() > STILL_CAMERA_M || moved.rotation.angle() > STILL_CAMERA_RAD
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn camera_that_has_not_moved_has_its_object_moved() {
        let at = |x_m| Isometry3::translation(x_m, 0.0, 1.0);
        let mover = |poses: &[Option<Isometry3<f64>>]| {
            let mut motion = CameraMotion::default();
            for pose in poses {
                motion.note(*pose);
            }
            motion.mover()
        };
        assert_eq!(mover(&[]), Mover::Either);
        assert_eq!(mover(&[None, None]), Mover::Either);
        assert_eq!(mover(&[Some(at(0.0)), Some(at(0.005))]), Mover::Object);
        // Slowly, and back again.
        let moved = [0.0, 0.006, 0.012, 0.0].map(|x_m| Some(at(x_m)));
        assert_eq!(mover(&moved), Mover::Camera);
        let turned = Isometry3::rotation(nalgebra::Vector3::z() * 0.1);
        assert!(has_moved(&Isometry3::identity(), &turned));
    }
}
