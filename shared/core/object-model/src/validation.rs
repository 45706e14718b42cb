//! Validation of object models: the values that a stored one may have.

use crate::error::Error;
use crate::model::{ModelMesh, ModelView, ObjectModel, RefusedView};
use geometry::RigidTransform;

/// Maximum absolute coordinate of a vertex, metres. Chosen: far more than any object that stands on
/// a table, and small enough for every computation in `f32`.
pub const MAX_COORDINATE_M: f32 = 100.0;
/// Maximum length of the reason of a refused view, bytes.
pub const MAX_REASON_BYTES: usize = 256;
/// Deviation of a normal from unit length that rounding to 8 or more bits explains. Chosen.
const NORMAL_TOLERANCE: f64 = 1e-2;
/// Deviation of a quaternion from unit length that a long product of poses explains. Chosen.
const ROTATION_TOLERANCE: f64 = 1e-6;

impl ObjectModel {
    /// Validates all values.
    pub(crate) fn check(&self) -> Result<(), Error> {
        self.mesh.check()?;
        for (number, view) in self.views.iter().enumerate() {
            let wrong = view.wrong();
            wrong.map_or(Ok(()), |wrong| invalid(&format!("view {number} {wrong}")))?;
        }
        for (number, view) in self.refused.iter().enumerate() {
            let wrong = view.wrong();
            wrong.map_or(Ok(()), |wrong| {
                invalid(&format!("refused view {number} {wrong}"))
            })?;
        }
        Ok(())
    }
}

fn invalid<T>(wrong: &str) -> Result<T, Error> {
    Err(Error::Invalid(wrong.to_owned()))
}

impl ModelMesh {
    fn check(&self) -> Result<(), Error> {
        for (number, vertex) in self.vertices.iter().enumerate() {
            // Not-a-number is within no range.
            let is_near = |coordinate: &f32| coordinate.abs() <= MAX_COORDINATE_M;
            if !vertex.position.iter().all(is_near) {
                return invalid(&format!(
                    "vertex {number} is not within {MAX_COORDINATE_M} m of the origin"
                ));
            }
            if !is_unit(f64::from(vertex.normal.norm()), NORMAL_TOLERANCE) {
                return invalid(&format!("the normal of vertex {number} is no unit vector"));
            }
        }
        let n_vertices = self.vertices.len();
        for (number, &[a, b, c]) in self.triangles.iter().enumerate() {
            if [a, b, c]
                .iter()
                .any(|&corner| corner as usize >= n_vertices)
            {
                return invalid(&format!(
                    "triangle {number} names a vertex that is not there, of {n_vertices}"
                ));
            }
            if a == b || b == c || c == a {
                return invalid(&format!("triangle {number} names a vertex twice"));
            }
        }
        Ok(())
    }
}

fn is_unit(norm: f64, tolerance: f64) -> bool {
    (norm - 1.0).abs() <= tolerance
}

impl ModelView {
    fn wrong(&self) -> Option<&'static str> {
        let RigidTransform {
            rotation,
            translation,
        } = self.object_from_camera;
        if !translation
            .vector
            .iter()
            .all(|coordinate| coordinate.is_finite())
        {
            return Some("has a camera at a place that is not finite");
        }
        if !is_unit(rotation.norm(), ROTATION_TOLERANCE) {
            return Some("has a rotation that is no unit quaternion");
        }
        let is_share = (0.0..=1.0).contains(&self.new_surface_share);
        (!is_share).then_some("has a share of new surface that is not between 0 and 1")
    }
}

impl RefusedView {
    fn wrong(&self) -> Option<&'static str> {
        if self.reason.len() > MAX_REASON_BYTES {
            return Some("has a reason that is too long");
        }
        let is_printable = !self.reason.chars().any(char::is_control);
        (!is_printable).then_some("has a reason with a control character")
    }
}
