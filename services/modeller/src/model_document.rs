//! Document of a model that was built.

use crate::growth::Growth;
use model_construction::BuiltView;
use object_model::{ModelMesh, ModelView, ObjectModel};

/// Model as it is kept in the memory.
pub(crate) fn object_model(growth: &Growth) -> ObjectModel {
    let mesh = growth.builder().mesh();
    let view = |(view, (new, n_points)): (&BuiltView, &(f32, u32))| ModelView {
        object_from_camera: view.object_from_camera,
        captured_ns: growth.wall_clock_ns(view.captured_ns),
        n_points: *n_points,
        new_surface_share: new.clamp(0.0, 1.0),
    };
    ObjectModel {
        mesh: ModelMesh {
            vertices: mesh.vertices,
            triangles: mesh
                .triangles
                .iter()
                .map(|triangle| triangle.vertices)
                .collect(),
        },
        views: growth
            .builder()
            .views()
            .iter()
            .zip(growth.shares())
            .map(view)
            .collect(),
        refused: growth.refused().to_vec(),
        is_closed_loop: growth.builder().is_closed(),
        unseen: growth.unseen(),
    }
}
