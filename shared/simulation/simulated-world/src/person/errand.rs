//! One action while it is carried out: a path of the hand with what it does on
//! the way.

use super::{Action, body};
use crate::scene::ModelChoice;
use nalgebra::{Point3, Vector3};

/// How fast a hand moves, metres a second.
const HAND_SPEED_M_S: f64 = 0.45;
/// How fast it moves when it lowers or lifts an object.
const CAREFUL_SPEED_M_S: f64 = 0.18;
/// How high objects are carried over where they stood, metres.
const CARRY_HEIGHT_M: f64 = 0.28;
/// The hand's middle over the top of the object it holds, metres.
pub(crate) const GRIP_M: f64 = 0.035;
/// How far from an object the hand that hides it is, towards the camera, metres.
const HIDE_DISTANCE_M: f64 = 0.16;
/// Gap under an object that is let go, metres.
const LET_GO_M: f64 = 0.002;

/// What a person knows of the world.
pub(crate) trait Surroundings {
    /// Middle of an object's top and height of its underside, world frame; `None`
    /// when it is not there or not free.
    fn object(&self, object: u16) -> Option<(Point3<f64>, f64)>;
    /// Objects that are free, at rest and on the table.
    fn free_objects(&self) -> Vec<u16>;
    /// Height of an object that is not there yet, metres.
    fn height_of(&self, model: &ModelChoice) -> Option<f64>;
    /// Height of the table's surface, metres.
    fn table_height_m(&self) -> f64;
    /// Position of the camera, world frame.
    fn camera(&self) -> Point3<f64>;
    /// A free place for an object, or for a new one of the given model.
    fn free_spot(&self, object: Option<u16>, draw: u64) -> Option<[f64; 2]>;
    /// A model that could be brought.
    fn another_model(&self, draw: u64) -> Option<ModelChoice>;
}

/// What the hand does to an object at a point of its path.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum HandEvent {
    /// A new object is in the hand.
    Brings(ModelChoice),
    /// The hand has taken hold of an object.
    Takes(u16),
    /// The hand lets go of what it holds.
    LetsGo,
    /// What the hand holds is gone with it.
    TakesAway,
    /// What the script asks for can not be done.
    CanNot(Action),
}

#[derive(Debug, Clone)]
enum Leg {
    To(Point3<f64>, f64),
    Wait(f64),
    Do(HandEvent),
}

/// A path of the hand, leg by leg.
#[derive(Debug, Clone)]
pub(crate) struct Errand {
    legs: std::collections::VecDeque<Leg>,
    /// Where the present leg began, and for how long it has gone on.
    from: Point3<f64>,
    spent_s: f64,
}

impl Errand {
    /// The path of an action; `None` when it can not be done now.
    pub(crate) fn new(
        action: &Action,
        hand: Point3<f64>,
        around: &dyn Surroundings,
    ) -> Option<Self> {
        let legs = match action {
            Action::Put { model, to_m } => put(model, *to_m, around)?,
            Action::Move { object, to_m } => relocate(*object, *to_m, around)?,
            Action::Slide { object, to_m } => slide(*object, *to_m, around)?,
            Action::Lift { object, for_s } => lift(*object, *for_s, around)?,
            Action::Hide { object, for_s } => hide(*object, *for_s, around)?,
            Action::Remove { object } => remove(*object, around)?,
        };
        Some(Self {
            legs: legs.into(),
            from: hand,
            spent_s: 0.0,
        })
    }

    pub(crate) fn has_ended(&self) -> bool {
        self.legs.is_empty()
    }

    /// Moves the hand, `pace` times as fast as usual; the event of this step, if any.
    pub(crate) fn step(
        &mut self,
        dt_s: f64,
        pace: f64,
        hand: &mut Point3<f64>,
    ) -> Option<HandEvent> {
        self.spent_s += dt_s;
        let has_ended = match self.legs.front()? {
            Leg::To(to, speed) => {
                let duration_s = 1.5 * (to - self.from).norm() / (speed * pace);
                let share = if duration_s > 0.0 {
                    (self.spent_s / duration_s).min(1.0)
                } else {
                    1.0
                };
                *hand = self.from + (to - self.from) * smooth(share);
                share >= 1.0
            }
            Leg::Wait(duration_s) => self.spent_s >= *duration_s,
            Leg::Do(_) => true,
        };
        if !has_ended {
            return None;
        }
        (self.from, self.spent_s) = (*hand, 0.0);
        match self.legs.pop_front()? {
            Leg::Do(event) => Some(event),
            Leg::To(..) | Leg::Wait(_) => None,
        }
    }
}

/// Smooth start and stop; its steepest slope is 1.5.
fn smooth(share: f64) -> f64 {
    share * share * (3.0 - 2.0 * share)
}

fn above(point: Point3<f64>) -> Point3<f64> {
    point + Vector3::z() * CARRY_HEIGHT_M
}

/// Where the hand holds an object whose top is at `top`.
fn grip(top: Point3<f64>) -> Point3<f64> {
    top + Vector3::z() * GRIP_M
}

fn take(top: Point3<f64>, object: u16) -> Vec<Leg> {
    let held = grip(top);
    vec![
        Leg::To(above(held), HAND_SPEED_M_S),
        Leg::To(held, CAREFUL_SPEED_M_S),
        Leg::Do(HandEvent::Takes(object)),
        Leg::Wait(0.2),
        Leg::To(above(held), CAREFUL_SPEED_M_S),
    ]
}

fn put_down(held: Point3<f64>) -> Vec<Leg> {
    vec![
        Leg::To(above(held), HAND_SPEED_M_S),
        Leg::To(held, CAREFUL_SPEED_M_S),
        Leg::Do(HandEvent::LetsGo),
        Leg::Wait(0.2),
        Leg::To(above(held), CAREFUL_SPEED_M_S),
        Leg::To(body::RESTING_HAND, HAND_SPEED_M_S),
    ]
}

fn put(model: &ModelChoice, [x, y]: [f64; 2], around: &dyn Surroundings) -> Option<Vec<Leg>> {
    let top = around.table_height_m() + around.height_of(model)? + LET_GO_M;
    let mut legs = vec![Leg::Do(HandEvent::Brings(model.clone()))];
    legs.extend(put_down(grip(Point3::new(x, y, top))));
    Some(legs)
}

fn relocate(object: u16, [x, y]: [f64; 2], around: &dyn Surroundings) -> Option<Vec<Leg>> {
    let (top, underside_m) = around.object(object)?;
    let new_top = around.table_height_m() + (top.z - underside_m) + LET_GO_M;
    let mut legs = take(top, object);
    legs.extend(put_down(grip(Point3::new(x, y, new_top))));
    Some(legs)
}

fn slide(object: u16, [x, y]: [f64; 2], around: &dyn Surroundings) -> Option<Vec<Leg>> {
    let (top, _) = around.object(object)?;
    let held = grip(top + Vector3::z() * LET_GO_M);
    let there = Point3::new(x, y, held.z);
    Some(vec![
        Leg::To(above(held), HAND_SPEED_M_S),
        Leg::To(grip(top), CAREFUL_SPEED_M_S),
        Leg::Do(HandEvent::Takes(object)),
        Leg::Wait(0.2),
        Leg::To(held, CAREFUL_SPEED_M_S),
        Leg::To(there, CAREFUL_SPEED_M_S),
        Leg::Do(HandEvent::LetsGo),
        Leg::Wait(0.2),
        Leg::To(above(there), CAREFUL_SPEED_M_S),
        Leg::To(body::RESTING_HAND, HAND_SPEED_M_S),
    ])
}

fn lift(object: u16, for_s: f64, around: &dyn Surroundings) -> Option<Vec<Leg>> {
    let (top, _) = around.object(object)?;
    let mut legs = take(top, object);
    legs.push(Leg::Wait(for_s));
    legs.extend(put_down(grip(top + Vector3::z() * LET_GO_M)));
    Some(legs)
}

fn hide(object: u16, for_s: f64, around: &dyn Surroundings) -> Option<Vec<Leg>> {
    let (top, underside_m) = around.object(object)?;
    let middle = Point3::new(top.x, top.y, f64::midpoint(top.z, underside_m));
    let to_camera = (around.camera() - middle).normalize();
    let before = middle + to_camera * HIDE_DISTANCE_M;
    Some(vec![
        Leg::To(above(before), HAND_SPEED_M_S),
        Leg::To(before, HAND_SPEED_M_S),
        Leg::Wait(for_s),
        Leg::To(above(before), HAND_SPEED_M_S),
        Leg::To(body::RESTING_HAND, HAND_SPEED_M_S),
    ])
}

fn remove(object: u16, around: &dyn Surroundings) -> Option<Vec<Leg>> {
    let (top, _) = around.object(object)?;
    let mut legs = take(top, object);
    legs.push(Leg::To(body::RESTING_HAND, HAND_SPEED_M_S));
    legs.push(Leg::Do(HandEvent::TakesAway));
    Some(legs)
}
