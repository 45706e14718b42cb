//! One object as the frame loop knows it.

use crate::frame::Measured;
use geometry::OrientedBox;
use learning::{CategoryName, N_NEAREST, Neighbour};
use nalgebra::{Matrix3, Vector3};
use tracking::{Appearance, MotionFilter, Sight, TrackLife, TrackPhase};

/// One object as the frame loop knows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// The track-id.
    pub id: u64,
    /// Capture stamp of the first sighting.
    pub first_seen_ns: u64,
    /// Capture stamp of the last sighting.
    pub last_seen_ns: u64,
    /// What the last sighting measured.
    pub measured: Measured,
    /// Views described.
    pub n_views: u32,
    /// The learned category; `None` when unknown.
    pub label: Option<CategoryName>,
    /// Distance to the nearest stored view; infinite when nothing was taught.
    pub distance: f32,
    /// Probability that it belongs to the nearest category; `None` when nothing was
    /// taught.
    pub probability: Option<f32>,
    /// The nearest stored view of each of the nearest categories, nearest first.
    pub nearest: [Option<Neighbour>; N_NEAREST],
    /// Key views described.
    pub n_key_views: u32,
    /// The lost track whose object this one is taken to be, by its looks.
    pub linked_to: Option<u64>,
    pub(crate) life: TrackLife,
    /// After the last measurement.
    pub(crate) posterior: MotionFilter,
    /// The same, predicted to the last step.
    pub(crate) filter: MotionFilter,
    pub(crate) appearance: Appearance,
    /// Capture stamp of the last sighting in a hand; 0 for never.
    pub(crate) last_handled_ns: u64,
    /// Frames in which it had no candidate and lay in what another track saw.
    pub(crate) n_swallowed: u32,
}

impl Track {
    /// How far the track is to be believed.
    pub fn phase(&self) -> TrackPhase {
        self.life.phase()
    }

    /// Whether its object was seen in the last frame, and if not, why.
    pub fn sight(&self) -> Sight {
        self.life.sight()
    }

    /// The box at the last step's capture stamp, world frame.
    pub fn box_in_world(&self) -> OrientedBox {
        self.filter.box_in_world()
    }

    /// Velocity of the box's centre, world frame, metres a second.
    pub fn velocity_m_s(&self) -> Vector3<f64> {
        self.filter.velocity_m_s()
    }

    /// Angular velocity, world frame, radians a second.
    pub fn angular_velocity_rad_s(&self) -> Vector3<f64> {
        self.filter.angular_velocity_rad_s()
    }

    /// Covariance of the box's centre, world axes, square metres.
    pub fn position_covariance_m2(&self) -> Matrix3<f64> {
        self.filter.position_covariance_m2()
    }

    /// Covariance of a small turn about the world's axes, square radians.
    pub fn rotation_covariance_rad2(&self) -> Matrix3<f64> {
        self.filter.rotation_covariance_rad2()
    }

    /// Whether a hand has had the object within a time before a capture stamp.
    pub(crate) fn was_handled(&self, now_ns: u64, within_ns: u64) -> bool {
        self.last_handled_ns > 0 && now_ns.saturating_sub(self.last_handled_ns) < within_ns
    }

    /// Takes another look into what is remembered of the object's looks. What a
    /// hand, the border of the image or another object hides a part of says
    /// nothing of size, and its colours may be another thing's.
    pub(crate) fn remember(&mut self, looks: &Appearance, is_whole: bool) {
        if self.appearance.is_cut {
            // What is smaller than a part is a smaller part, cut or not.
            if looks.volume_m3 >= AS_LARGE_SHARE * self.appearance.volume_m3 {
                self.appearance = *looks;
            }
        } else if is_whole {
            let colors = &self.appearance.colors;
            self.appearance.colors = colors.blended(&looks.colors, COLOR_RATE);
            self.appearance.volume_m3 = looks.volume_m3;
        }
    }
}

/// A view shows an object whole with this share of its box.
pub(crate) const WHOLE_SHARE: f64 = 0.9;

/// What has this share of a volume is about as large.
const AS_LARGE_SHARE: f64 = 0.8;

/// Share of a frame's colours in what is remembered.
const COLOR_RATE: f32 = 0.05;
