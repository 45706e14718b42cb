//! Parallel-jaw gripper: dimensions, force, state and motion.

use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;

use crate::Error;
use serde::Deserialize;
use value_range::check_range;

/// Dimensions, speed and force of a parallel-jaw gripper. Lengths are along z of the tool, widths
/// along y, thicknesses along x.
///
/// It is read from the section `[gripper]` of the configuration, whose key reference has the ranges;
/// keys that are not given are those of the JACO.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GripperModel {
    /// Stroke of the gripper: greatest distance between the pads.
    pub max_opening_m: f64,
    /// Length of a pad. The middle of the pad is at the tool's origin; the fingertips are half a
    /// pad length ahead of it.
    pub pad_length_m: f64,
    /// Width of a finger pad, metres.
    pub pad_width_m: f64,
    /// Thickness of a finger pad, metres.
    pub pad_thickness_m: f64,
    /// Thickness of the finger that carries the pad.
    pub finger_thickness_m: f64,
    /// Distance of the palm behind the tool's origin: an object whose middle is between the pads
    /// must not extend farther towards the hand.
    pub palm_m: f64,
    /// Greatest rate of change of the opening, m/s.
    pub opening_speed_m_s: f64,
    /// Force with which each finger presses, newtons.
    pub closing_force_n: f64,
    /// Coulomb friction coefficient of the pads.
    pub pad_friction: f64,
}

impl GripperModel {
    /// Dimensions of the JACO's hand: stroke of about 0.15 m, closing in 1.25 s with up to 25 N
    /// (Kinova's data sheet). Parallel fingers replace its curling ones; their pads are of rubber.
    pub const JACO_LIKE: Self = Self {
        max_opening_m: 0.15,
        pad_length_m: 0.050,
        pad_width_m: 0.022,
        pad_thickness_m: 0.006,
        finger_thickness_m: 0.012,
        palm_m: 0.080,
        opening_speed_m_s: 0.12,
        closing_force_n: 25.0,
        pad_friction: 0.8,
    };

    /// Bounding box of the pad, finger frame.
    pub fn pad_in_finger(&self) -> OrientedBox {
        let half = Vector3::new(self.pad_thickness_m, self.pad_width_m, self.pad_length_m) / 2.0;
        OrientedBox {
            frame_from_box: Isometry3::translation(half.x, 0.0, 0.0),
            half_sides_m: half,
        }
    }

    /// Box of the finger without its pad, from the palm to the fingertip, finger frame.
    pub fn finger_body_in_finger(&self) -> OrientedBox {
        let (back, tip) = (-self.palm_m, 0.5 * self.pad_length_m);
        let half = Vector3::new(self.finger_thickness_m, self.pad_width_m, tip - back) / 2.0;
        OrientedBox {
            frame_from_box: Isometry3::translation(
                self.pad_thickness_m + half.x,
                0.0,
                0.5 * (back + tip),
            ),
            half_sides_m: half,
        }
    }

    /// Bounding box of the finger with its pad, finger frame.
    pub fn finger_and_pad_in_finger(&self) -> OrientedBox {
        let mut body = self.finger_body_in_finger();
        body.half_sides_m.x += 0.5 * self.pad_thickness_m;
        body.frame_from_box.translation.x = body.half_sides_m.x;
        body
    }

    /// Box of the rail on which the fingers slide, behind the palm, tool frame.
    pub fn rail_in_tool(&self) -> OrientedBox {
        let reach = 0.5 * self.max_opening_m + self.pad_thickness_m + self.finger_thickness_m;
        let half = Vector3::new(reach, 0.025, 0.015);
        OrientedBox {
            frame_from_box: Isometry3::translation(0.0, 0.0, -self.palm_m - half.z),
            half_sides_m: half,
        }
    }

    /// Boxes of both pads in the tool frame, in the order of [`tool_from_fingers`].
    pub fn pads_in_tool(&self, opening_m: f64) -> [OrientedBox; 2] {
        tool_from_fingers(opening_m)
            .map(|tool_from_finger| self.pad_in_finger().transformed(&tool_from_finger))
    }

    /// Checks that an opening, metres, is within the gripper's stroke.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`].
    pub fn check_opening(&self, opening_m: f64) -> Result<(), Error> {
        Ok(check_range(
            "the opening of the hand in metres",
            opening_m,
            0.0,
            self.max_opening_m,
        )?)
    }
}

impl Default for GripperModel {
    fn default() -> Self {
        Self::JACO_LIKE
    }
}

/// Poses of the fingers at +x and at -x of the tool for an opening between the pads, metres.
/// Finger frame: origin in the middle of the pad's face, x into the pad (away from the grasped
/// object), z forward.
pub fn tool_from_fingers(opening_m: f64) -> [RigidTransform; 2] {
    let half = 0.5 * opening_m;
    [
        Translation3::new(half, 0.0, 0.0).into(),
        RigidTransform::from_parts(
            Translation3::new(-half, 0.0, 0.0),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), PI),
        ),
    ]
}

/// Share of their speed with which fingers press on what both touch. Chosen.
const PRESSING_SHARE: f64 = 0.1;

/// Contact of both fingers with what is between them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FingerContact {
    /// At most one pad touches something.
    Free,
    /// Both pads touch something.
    Touching,
    /// Both pads press on something that still moves between them.
    Pressing,
    /// Both pads press with the closing force on something at rest.
    Pressed,
}

/// Motion state of the fingers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GripperMotion {
    /// Fingers are not moving.
    Still,
    /// Fingers are moving apart.
    Opening,
    /// Fingers are moving together.
    Closing,
}

/// Gripper state: opening, target and motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Gripper {
    geometry: GripperModel,
    opening_m: f64,
    target_m: f64,
    motion: GripperMotion,
    is_holding: bool,
}

impl Gripper {
    /// Gripper that is wide open and not moving.
    pub fn new(geometry: GripperModel) -> Self {
        Self {
            opening_m: geometry.max_opening_m,
            target_m: geometry.max_opening_m,
            motion: GripperMotion::Still,
            is_holding: false,
            geometry,
        }
    }

    /// Present distance between the finger pads, metres.
    pub fn opening_m(&self) -> f64 {
        self.opening_m
    }

    /// Motion state of the fingers.
    pub fn motion(&self) -> GripperMotion {
        self.motion
    }

    /// True if the fingers stopped on an object and have not moved since.
    pub fn is_holding(&self) -> bool {
        self.is_holding
    }

    /// Starts a motion to an opening, metres; 0 closes the gripper.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`]; the running motion then continues.
    pub fn move_to(&mut self, opening_m: f64) -> Result<(), Error> {
        self.geometry.check_opening(opening_m)?;
        self.target_m = opening_m;
        self.is_holding = false;
        self.motion = if opening_m < self.opening_m {
            GripperMotion::Closing
        } else {
            GripperMotion::Opening
        };
        Ok(())
    }

    /// Stops the fingers at once.
    pub fn halt(&mut self) {
        self.motion = GripperMotion::Still;
    }

    /// Advances the fingers by `dt_s` seconds. Closing fingers become slow when both pads touch
    /// something, so that it can turn between them, wait while both press and it moves, and then
    /// hold.
    pub fn step(&mut self, dt_s: f64, contact: FingerContact) {
        let way = self.geometry.opening_speed_m_s * dt_s;
        match self.motion {
            GripperMotion::Still => return,
            GripperMotion::Opening => self.opening_m = (self.opening_m + way).min(self.target_m),
            GripperMotion::Closing if contact == FingerContact::Pressed => {
                self.is_holding = true;
                self.motion = GripperMotion::Still;
                return;
            }
            GripperMotion::Closing => {
                let share = match contact {
                    FingerContact::Touching => PRESSING_SHARE,
                    FingerContact::Pressing => 0.0,
                    FingerContact::Free | FingerContact::Pressed => 1.0,
                };
                self.opening_m = (self.opening_m - share * way).max(self.target_m);
            }
        }
        if self.opening_m == self.target_m {
            self.motion = GripperMotion::Still;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pads_face_each_other_across_the_opening() {
        let hand = GripperModel::JACO_LIKE;
        for opening in [0.0, 0.07, hand.max_opening_m] {
            let [right, left] = hand.pads_in_tool(opening);
            let thickness = hand.pad_thickness_m;
            let expected = Vector3::new(0.5 * (opening + thickness), 0.0, 0.0);
            assert!((right.centre().coords - expected).norm() < 1e-12);
            assert!((left.centre().coords + expected).norm() < 1e-12);
            let inside = 0.5 * opening + 0.1 * thickness;
            assert!(right.contains(&[inside, 0.0, 0.0].into(), 0.0));
            assert!(left.contains(&[-inside, 0.0, 0.0].into(), 0.0));
        }
    }

    #[test]
    fn fingers_close_at_their_speed_and_slowly_from_the_touch_to_the_press() {
        let mut gripper = Gripper::new(GripperModel::JACO_LIKE);
        gripper.move_to(0.0).unwrap();
        for _ in 0..50 {
            gripper.step(0.01, FingerContact::Free);
        }
        assert_eq!(gripper.motion(), GripperMotion::Closing);
        assert!((gripper.opening_m() - (0.15 - 0.5 * 0.12)).abs() < 1e-12);
        gripper.step(0.01, FingerContact::Touching);
        assert!((gripper.opening_m() - (0.15 - 0.501 * 0.12)).abs() < 1e-12);
        let at_contact = gripper.opening_m();
        gripper.step(0.01, FingerContact::Pressing);
        assert_eq!(gripper.motion(), GripperMotion::Closing);
        gripper.step(0.01, FingerContact::Pressed);
        assert_eq!(gripper.opening_m(), at_contact);
        assert!(gripper.is_holding() && gripper.motion() == GripperMotion::Still);
        gripper.move_to(0.15).unwrap();
        gripper.step(10.0, FingerContact::Pressed);
        assert!(!gripper.is_holding() && gripper.opening_m() == 0.15);
    }

    #[test]
    fn fingers_that_meet_hold_nothing() {
        let mut gripper = Gripper::new(GripperModel::JACO_LIKE);
        gripper.move_to(0.0).unwrap();
        gripper.step(100.0, FingerContact::Free);
        assert!(gripper.opening_m() == 0.0 && !gripper.is_holding());
        assert_eq!(gripper.motion(), GripperMotion::Still);
    }

    #[test]
    fn invalid_opening_is_rejected() {
        let mut gripper = Gripper::new(GripperModel::JACO_LIKE);
        for opening in [f64::NAN, -0.01, 0.151] {
            assert!(matches!(
                gripper.move_to(opening),
                Err(Error::OutOfRange { .. })
            ));
        }
        assert_eq!(gripper.motion(), GripperMotion::Still);
    }
}
