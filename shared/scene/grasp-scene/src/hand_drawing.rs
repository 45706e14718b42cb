//! Drawing of a grasp and of a transport: the colour image of a snapshot with the outlines of the
//! hand and the ways of the tool.

use arm_kinematics::GripperModel;
use geometry::OrientedBox;
use grasping::{Grasp, PlacedArm, hand_boxes};
use nalgebra::{Point3, Vector3};
use scene_client::{PlanningFrame, Snapshot};
use transport::{TransitPath, Transport};

/// Colours of the object's pixels, of the fingers and of the rest of the hand.
const TARGET: [u8; 3] = [90, 200, 90];
const FINGER: [u8; 3] = [230, 40, 40];
const HAND: [u8; 3] = [40, 90, 230];
/// Colours of the ways of the tool, without and with the object.
const WAY: [u8; 3] = [240, 240, 240];
const LOADED_WAY: [u8; 3] = [250, 170, 30];
/// Every so many points of the object are painted, so that it stays to be seen.
const TARGET_STEP: usize = 3;
/// Number of steps in which an edge is drawn.
const N_STEPS: usize = 300;

/// Colour image of a snapshot, three bytes a pixel, with the points of an object and the hand of a
/// grasp, where there are any.
pub fn draw_grasp(
    snapshot: &Snapshot,
    frame: &PlanningFrame,
    gripper: &GripperModel,
    object: Option<usize>,
    grasp: Option<&Grasp>,
) -> Vec<u8> {
    let colors = snapshot.points.iter().flat_map(|p| p.color.rgb());
    let mut rgb: Vec<u8> = colors.collect();
    let mut paint = |place: &Point3<f64>, color: [u8; 3]| {
        paint_place(&mut rgb, snapshot, place, color);
    };
    if let Some(object) = object.and_then(|index| snapshot.objects.get(index)) {
        for point in object.points.iter().step_by(TARGET_STEP) {
            paint(&Point3::from(*point).cast::<f64>(), TARGET);
        }
    }
    if let Some(grasp) = grasp {
        let camera_from_tool = frame.plan_from_camera.inverse() * grasp.plan_from_tool;
        for (index, body) in hand_boxes(gripper, grasp.opening_m).iter().enumerate() {
            let color = if index < 2 { FINGER } else { HAND };
            for place in edges(&body.transformed(&camera_from_tool)) {
                paint(&place, color);
            }
        }
    }
    rgb
}

/// Picture of a grasp as by [`draw_grasp`], with the way of the tool to it, that to the place, and the
/// hand at the release.
pub fn draw_transport(
    snapshot: &Snapshot,
    frame: &PlanningFrame,
    placed: &PlacedArm,
    object: usize,
    planned: Option<(&Transport, &Grasp)>,
) -> Vec<u8> {
    let gripper = placed.arm.gripper();
    let grasp = planned.map(|(_, grasp)| grasp);
    let mut rgb = draw_grasp(snapshot, frame, gripper, Some(object), grasp);
    let Some((transport, grasp)) = planned else {
        return rgb;
    };
    let camera_from_plan = frame.plan_from_camera.inverse();
    let mut paint = |place: &Point3<f64>, color: [u8; 3]| {
        paint_place(&mut rgb, snapshot, &(camera_from_plan * place), color);
    };
    for (path, color) in [
        (&transport.reached.path, WAY),
        (&transport.path, LOADED_WAY),
    ] {
        for place in tool_places(path, placed) {
            paint(&place, color);
        }
    }
    for body in hand_boxes(gripper, grasp.width_m) {
        for place in edges(&body.transformed(&transport.placement.plan_from_tool)) {
            paint(&place, LOADED_WAY);
        }
    }
    rgb
}

/// Places of the tool along a path, frame of planning.
fn tool_places(path: &TransitPath, placed: &PlacedArm) -> Vec<Point3<f64>> {
    let motions = path.waypoints_rad.windows(2);
    let places = motions.flat_map(|pair| {
        (0..=N_STEPS).map(|k| {
            let joints = pair[0] + (pair[1] - pair[0]) * (k as f64 / N_STEPS as f64);
            let tool = placed.plan_from_base * placed.arm.tool_pose(&joints);
            Point3::from(tool.translation.vector)
        })
    });
    places.collect()
}

/// Paints the pixel that shows a place in the frame of the camera.
fn paint_place(rgb: &mut [u8], snapshot: &Snapshot, place: &Point3<f64>, color: [u8; 3]) {
    let camera = &snapshot.camera;
    if let Some([column, row]) = camera.pixel_of(place) {
        let at = 3 * (row * camera.width as usize + column);
        rgb[at..at + 3].copy_from_slice(&color);
    }
}

/// Places along the twelve edges of a box.
fn edges(body: &OrientedBox) -> Vec<Point3<f64>> {
    let corner = |index: usize| {
        let sign = |bit: usize| if index & bit == 0 { -1.0 } else { 1.0 };
        let signs = Vector3::new(sign(1), sign(2), sign(4));
        body.frame_from_box * Point3::from(body.half_sides_m.component_mul(&signs))
    };
    let ends = (0..8_usize).flat_map(|from| [1, 2, 4].map(|bit| (from, from | bit)));
    let edges = ends.filter(|(from, to)| from != to);
    edges
        .flat_map(|(from, to)| {
            let (from, to) = (corner(from), corner(to));
            (0..=N_STEPS).map(move |k| from + (to - from) * (k as f64 / N_STEPS as f64))
        })
        .collect()
}
