//! Load in the hand: the box around the object that the gripper holds.

use geometry::{BoundingRectangle, ConvexPolygon, OrientedBox, RigidTransform};
use grasping::ContactPoint;
use nalgebra::{Point2, Translation3, UnitQuaternion, Vector3};

/// Object in the hand.
#[derive(Debug, Clone, PartialEq)]
pub struct CarriedLoad {
    /// Box around it, tool frame, metres.
    pub body_in_tool: OrientedBox,
    /// Index of the object in the scene; `None` when the scene does not have it.
    pub object: Option<usize>,
}

/// Upright box around points: least area seen from above. `None` without points.
pub(crate) fn upright_box(contacts: &[ContactPoint]) -> Option<OrientedBox> {
    let mut places: Vec<Point2<f64>> = contacts.iter().map(|c| c.position.xy()).collect();
    let hull = ConvexPolygon::convex_hull_of(&mut places);
    let rectangle = BoundingRectangle::of_outline(hull.corners())?;
    let heights = contacts.iter().map(|c| c.position.z);
    let (low_m, high_m) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| {
        (low.min(z), high.max(z))
    });
    let middle = Vector3::new(
        rectangle.centre.x,
        rectangle.centre.y,
        0.5 * (low_m + high_m),
    );
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rectangle.yaw_rad);
    Some(OrientedBox {
        frame_from_box: RigidTransform::from_parts(Translation3::from(middle), turn),
        half_sides_m: Vector3::new(
            rectangle.half_sides_m.x,
            rectangle.half_sides_m.y,
            0.5 * (high_m - low_m),
        ),
    })
}

impl CarriedLoad {
    /// Load of an object with its surface, as it stood when the tool was at a pose. `None` for an
    /// object of which nothing is known.
    pub fn of(
        contacts: &[ContactPoint],
        plan_from_tool: &RigidTransform,
        object: Option<usize>,
    ) -> Option<Self> {
        let body = upright_box(contacts)?;
        Some(Self {
            body_in_tool: body.transformed(&plan_from_tool.inverse()),
            object,
        })
    }
}
