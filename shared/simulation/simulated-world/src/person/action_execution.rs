//! Execution of an action: piecewise-linear hand path with events on the way.

use super::person_body::RESTING_HAND;
use crate::action::Action;
use crate::model_choice::ModelChoice;
use crate::world::World;
use nalgebra::{Point3, Vector3};

/// Speed of the hand, m/s. Chosen.
const HAND_SPEED_M_S: f64 = 0.45;
/// Speed of the hand while it lowers or lifts an object, m/s. Chosen.
const CAREFUL_SPEED_M_S: f64 = 0.18;
/// Height by which objects are lifted for carrying, metres. Chosen.
const CARRY_HEIGHT_M: f64 = 0.28;
/// Height of the hand's middle above the top of the held object, metres.
pub(crate) const GRIP_M: f64 = 0.035;
/// Distance between an object and the hand that hides it, towards the camera, metres. Chosen.
const HIDE_DISTANCE_M: f64 = 0.16;
/// Angle by which the hand turns an object in one step, radians, and the duration of that step,
/// seconds: 60° a second. Chosen.
const TURN_STEP_RAD: f64 = 3.0_f64.to_radians();
const TURN_STEP_S: f64 = 0.05;
/// Gap under an object that is released, metres. Chosen.
const RELEASE_GAP_M: f64 = 0.002;

/// Event of the hand on an object along its path.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum HandEvent {
    /// New object that appears in the hand.
    Brought(ModelChoice),
    /// Hand has grasped an object.
    Grasped(u16),
    /// Hand has turned the held object about the vertical by an angle, radians.
    Turned(f64),
    /// Hand has released the held object.
    Released,
    /// Held object that leaves the scene with the hand.
    Removed,
    /// Scripted action that cannot be performed.
    Impossible(Action),
}

/// Segment of a hand path.
#[derive(Debug, Clone)]
enum Segment {
    /// Moves to a point, metres, at a speed, m/s.
    MoveTo(Point3<f64>, f64),
    /// Waits for a duration, seconds.
    Wait(f64),
    /// Emits a hand event.
    Emit(HandEvent),
}

/// Action in execution: remaining path segments of the hand.
#[derive(Debug, Clone)]
pub(crate) struct ActionExecution {
    segments: std::collections::VecDeque<Segment>,
    /// Start point of the hand path's current segment.
    from: Point3<f64>,
    /// Elapsed time of the current segment, seconds.
    spent_s: f64,
}

impl ActionExecution {
    /// Plans the path of an action; `None` when it cannot be performed now.
    pub(crate) fn new(action: &Action, hand: Point3<f64>, world: &World) -> Option<Self> {
        let segments = match action {
            Action::Put { model, to_m } => put_path(model, *to_m, world)?,
            Action::Move { object, to_m } => move_path(*object, *to_m, world)?,
            Action::Slide { object, to_m } => slide_path(*object, *to_m, world)?,
            Action::Lift { object, for_s } => lifted_path(*object, [Segment::Wait(*for_s)], world)?,
            Action::Turn { object, by_rad } => turn_path(*object, *by_rad, world)?,
            Action::Hide { object, for_s } => hide_path(*object, *for_s, world)?,
            Action::Remove { object } => remove_path(*object, world)?,
        };
        Some(Self {
            segments: segments.into(),
            from: hand,
            spent_s: 0.0,
        })
    }

    pub(crate) fn has_ended(&self) -> bool {
        self.segments.is_empty()
    }

    /// Moves the hand, at `pace` times the default speed, and returns the event of this step.
    pub(crate) fn step(
        &mut self,
        dt_s: f64,
        pace: f64,
        hand: &mut Point3<f64>,
    ) -> Option<HandEvent> {
        self.spent_s += dt_s;
        let has_ended = match self.segments.front()? {
            Segment::MoveTo(to, speed) => {
                let duration_s = 1.5 * (to - self.from).norm() / (speed * pace);
                let share = if duration_s > 0.0 {
                    (self.spent_s / duration_s).min(1.0)
                } else {
                    1.0
                };
                *hand = self.from + (to - self.from) * smoothstep(share);
                share >= 1.0
            }
            Segment::Wait(duration_s) => self.spent_s >= *duration_s,
            Segment::Emit(_) => true,
        };
        if !has_ended {
            return None;
        }
        (self.from, self.spent_s) = (*hand, 0.0);
        match self.segments.pop_front()? {
            Segment::Emit(event) => Some(event),
            Segment::MoveTo(..) | Segment::Wait(_) => None,
        }
    }
}

/// Smoothstep easing; its greatest slope is 1.5.
fn smoothstep(share: f64) -> f64 {
    share * share * (3.0 - 2.0 * share)
}

/// Point above `point` at carrying height.
fn raised(point: Point3<f64>) -> Point3<f64> {
    point + Vector3::z() * CARRY_HEIGHT_M
}

/// Position of the hand that grasps an object whose top is at `top`.
fn grasping_hand(top: Point3<f64>) -> Point3<f64> {
    top + Vector3::z() * GRIP_M
}

/// Path that grasps an object and lifts it.
fn grasp_path(top: Point3<f64>, object: u16) -> Vec<Segment> {
    let held = grasping_hand(top);
    vec![
        Segment::MoveTo(raised(held), HAND_SPEED_M_S),
        Segment::MoveTo(held, CAREFUL_SPEED_M_S),
        Segment::Emit(HandEvent::Grasped(object)),
        Segment::Wait(0.2),
        Segment::MoveTo(raised(held), CAREFUL_SPEED_M_S),
    ]
}

/// Path that puts the held object down and returns to rest.
fn put_down_path(held: Point3<f64>) -> Vec<Segment> {
    vec![
        Segment::MoveTo(raised(held), HAND_SPEED_M_S),
        Segment::MoveTo(held, CAREFUL_SPEED_M_S),
        Segment::Emit(HandEvent::Released),
        Segment::Wait(0.2),
        Segment::MoveTo(raised(held), CAREFUL_SPEED_M_S),
        Segment::MoveTo(RESTING_HAND, HAND_SPEED_M_S),
    ]
}

/// Hand path of [`Action::Put`].
fn put_path(model: &ModelChoice, [x, y]: [f64; 2], world: &World) -> Option<Vec<Segment>> {
    let top = world.table_height_m() + world.height_of(model)? + RELEASE_GAP_M;
    let mut segments = vec![Segment::Emit(HandEvent::Brought(model.clone()))];
    segments.extend(put_down_path(grasping_hand(Point3::new(x, y, top))));
    Some(segments)
}

/// Hand path of [`Action::Move`].
fn move_path(object: u16, [x, y]: [f64; 2], world: &World) -> Option<Vec<Segment>> {
    let (top, underside_m) = world.object_to_grasp(object)?;
    let new_top = world.table_height_m() + (top.z - underside_m) + RELEASE_GAP_M;
    let mut segments = grasp_path(top, object);
    segments.extend(put_down_path(grasping_hand(Point3::new(x, y, new_top))));
    Some(segments)
}

/// Hand path of [`Action::Slide`].
fn slide_path(object: u16, [x, y]: [f64; 2], world: &World) -> Option<Vec<Segment>> {
    let (top, _) = world.object_to_grasp(object)?;
    let held = grasping_hand(top + Vector3::z() * RELEASE_GAP_M);
    let there = Point3::new(x, y, held.z);
    let mut segments = vec![
        Segment::MoveTo(raised(held), HAND_SPEED_M_S),
        Segment::MoveTo(grasping_hand(top), CAREFUL_SPEED_M_S),
        Segment::Emit(HandEvent::Grasped(object)),
        Segment::Wait(0.2),
        Segment::MoveTo(held, CAREFUL_SPEED_M_S),
    ];
    // It is put down from where it is, not from above.
    segments.extend(put_down_path(there).into_iter().skip(1));
    Some(segments)
}

/// Hand path of [`Action::Turn`].
fn turn_path(object: u16, by_rad: f64, world: &World) -> Option<Vec<Segment>> {
    let n_steps = (by_rad.abs() / TURN_STEP_RAD).ceil().max(1.0);
    let step = [
        Segment::Wait(TURN_STEP_S),
        Segment::Emit(HandEvent::Turned(by_rad / n_steps)),
    ];
    let steps = std::iter::repeat_n(step, n_steps as usize).flatten();
    lifted_path(object, steps, world)
}

/// Path that lifts an object, does something with it there, and puts it back.
fn lifted_path(
    object: u16,
    lifted: impl IntoIterator<Item = Segment>,
    world: &World,
) -> Option<Vec<Segment>> {
    let (top, _) = world.object_to_grasp(object)?;
    let mut segments = grasp_path(top, object);
    segments.extend(lifted);
    segments.extend(put_down_path(grasping_hand(
        top + Vector3::z() * RELEASE_GAP_M,
    )));
    Some(segments)
}

/// Hand path of [`Action::Hide`].
fn hide_path(object: u16, for_s: f64, world: &World) -> Option<Vec<Segment>> {
    let (top, underside_m) = world.object_to_grasp(object)?;
    let middle = Point3::new(top.x, top.y, f64::midpoint(top.z, underside_m));
    let to_camera = (world.camera_position() - middle).normalize();
    let before = middle + to_camera * HIDE_DISTANCE_M;
    Some(vec![
        Segment::MoveTo(raised(before), HAND_SPEED_M_S),
        Segment::MoveTo(before, HAND_SPEED_M_S),
        Segment::Wait(for_s),
        Segment::MoveTo(raised(before), HAND_SPEED_M_S),
        Segment::MoveTo(RESTING_HAND, HAND_SPEED_M_S),
    ])
}

/// Hand path of [`Action::Remove`].
fn remove_path(object: u16, world: &World) -> Option<Vec<Segment>> {
    let (top, _) = world.object_to_grasp(object)?;
    let mut segments = grasp_path(top, object);
    segments.push(Segment::MoveTo(RESTING_HAND, HAND_SPEED_M_S));
    segments.push(Segment::Emit(HandEvent::Removed));
    Some(segments)
}
