//! Body mask (self-filter): pixels of people and the robot.
//!
//! They are removed from the objects' pixels before clustering, so that an object does not
//! merge with the hand or gripper that touches it.

use crate::RawConfig;
use crate::input::{ExpectedTrack, ScenePriors};
use crate::table::Table;
use geometry::Capsule;
use nalgebra::{Point3, Vector3};
use point_cloud::{OrganizedCloud, Point};

/// Core margin around a capsule, metres: nearer points always belong to the body. The rest
/// of the configured margin covers the inaccuracy of the capsules. Chosen.
const BODY_MARGIN_M: f32 = 0.012;

/// Tolerance around a track's predicted box, metres. Chosen.
const TRACK_MARGIN_M: f64 = 0.008;

/// Number of pixels tested together against the capsules' bounds.
const BLOCK: usize = 16;

/// Owner of a capsule: a person or the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum BodyKind {
    Person,
    Robot,
}

/// Axis-aligned bounding box; [`NOTHING`](Self::NOTHING) is empty.
#[derive(Debug, Clone, Copy)]
struct Aabb {
    low: Vector3<f32>,
    high: Vector3<f32>,
}

impl Aabb {
    const NOTHING: Self = Self {
        low: Vector3::new(f32::INFINITY, f32::INFINITY, f32::INFINITY),
        high: Vector3::new(f32::NEG_INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY),
    };

    fn of<'a>(points: impl Iterator<Item = &'a Point>) -> Self {
        points.fold(Self::NOTHING, |bounds, point| {
            let point = Vector3::new(point.x, point.y, point.z);
            Self {
                low: bounds.low.inf(&point),
                high: bounds.high.sup(&point),
            }
        })
    }

    fn meets(&self, other: &Self) -> bool {
        (0..3).all(|i| self.low[i] <= other.high[i] && other.low[i] <= self.high[i])
    }

    #[inline]
    fn contains(&self, point: &Point) -> bool {
        (self.low.x..=self.high.x).contains(&point.x)
            && (self.low.y..=self.high.y).contains(&point.y)
            && (self.low.z..=self.high.z).contains(&point.z)
    }
}

/// Capsule grown by its margin, prepared for the inner loop.
#[derive(Debug, Clone, Copy)]
struct MarginCapsule {
    kind: BodyKind,
    from: Vector3<f32>,
    axis: Vector3<f32>,
    per_length2: f32,
    /// Radius of the capsule with the margin, metres.
    radius: f32,
    /// Radius of the capsule without the margin, metres.
    body_radius: f32,
    bounds: Aabb,
}

impl MarginCapsule {
    fn new(capsule: &Capsule, margin_m: f64, kind: BodyKind) -> Self {
        let [from, to] = [capsule.from, capsule.to].map(|end| end.coords.cast::<f32>());
        let radius = (capsule.radius_m + margin_m) as f32;
        let (axis, reach) = (to - from, Vector3::repeat(radius));
        Self {
            kind,
            from,
            axis,
            per_length2: 1.0 / axis.norm_squared().max(1e-12),
            radius,
            body_radius: capsule.radius_m as f32,
            bounds: Aabb {
                low: from.inf(&to) - reach,
                high: from.sup(&to) + reach,
            },
        }
    }

    /// Capsule with its margin increased by `by_m`, metres.
    fn grown(&self, by_m: f32) -> Self {
        let reach = Vector3::repeat(by_m);
        Self {
            radius: self.radius + by_m,
            bounds: Aabb {
                low: self.bounds.low - reach,
                high: self.bounds.high + reach,
            },
            ..*self
        }
    }

    #[inline]
    fn contains(&self, point: &Point) -> bool {
        self.bounds.contains(point) && self.squared_distance(point) <= self.radius * self.radius
    }

    /// `true` when a point belongs to the body itself and not only to the margin.
    fn is_core(&self, point: &Point) -> bool {
        let own = self.radius.min(self.body_radius + BODY_MARGIN_M);
        self.squared_distance(point) <= own * own
    }

    /// Squared distance from the capsule's axis, square metres.
    #[inline]
    fn squared_distance(&self, point: &Point) -> f32 {
        let away = Vector3::new(point.x, point.y, point.z) - self.from;
        let along = (away.dot(&self.axis) * self.per_length2).clamp(0.0, 1.0);
        (away - self.axis * along).norm_squared()
    }
}

/// `true` when a point is inside the predicted box of a live track.
pub(crate) fn is_expected(tracks: &[ExpectedTrack], point: &Point3<f64>) -> bool {
    let mut shapes = tracks.iter().map(|track| &track.oriented_box);
    shapes.any(|shape| shape.contains(point, TRACK_MARGIN_M))
}

/// Body mask: the capsules of people and the robot above the table. Reused from frame to
/// frame.
#[derive(Debug, Default)]
pub(crate) struct BodyMask {
    capsules: Vec<MarginCapsule>,
}

impl BodyMask {
    /// Collect the capsules that reach into the prism above the table.
    pub(crate) fn refill(&mut self, priors: &ScenePriors<'_>, table: &Table, config: &RawConfig) {
        self.capsules.clear();
        let ScenePriors {
            instructor, robot, ..
        } = priors;
        for (capsules, margin_m, kind) in [
            (instructor, config.person_margin_m, BodyKind::Person),
            (robot, config.robot_margin_m, BodyKind::Robot),
        ] {
            for capsule in capsules.unwrap_or_default() {
                if reaches_into_prism(capsule, margin_m, table, config) {
                    self.capsules
                        .push(MarginCapsule::new(capsule, margin_m, kind));
                }
            }
        }
    }

    /// Move the body pixels out of `pixels` into `masked`, both in image order. A pixel
    /// only in the margin of a capsule stays when it is in the predicted box of a live
    /// track: a hand holds that object.
    pub(crate) fn extract(
        &self,
        cloud: &OrganizedCloud<'_>,
        tracks: &[ExpectedTrack],
        pixels: &mut Vec<u32>,
        masked: &mut Vec<u32>,
    ) {
        masked.clear();
        if self.capsules.is_empty() {
            return;
        }
        let is_masked = |point: &Point| {
            self.capsules.iter().any(|capsule| capsule.contains(point))
                && (self.capsules.iter().any(|capsule| capsule.is_core(point))
                    || !is_expected(tracks, &point.position()))
        };
        // Neighbours in the list are usually neighbours in space and far from all capsules.
        let mut n_kept = 0;
        for first in (0..pixels.len()).step_by(BLOCK) {
            let block = first..pixels.len().min(first + BLOCK);
            let point_of = |pixel: u32| &cloud.points()[pixel as usize];
            let bounds = Aabb::of(pixels[block.clone()].iter().map(|&pixel| point_of(pixel)));
            let is_far = !self
                .capsules
                .iter()
                .any(|capsule| capsule.bounds.meets(&bounds));
            for i in block {
                let pixel = pixels[i];
                if is_far || !is_masked(point_of(pixel)) {
                    pixels[n_kept] = pixel;
                    n_kept += 1;
                } else {
                    masked.push(pixel);
                }
            }
        }
        pixels.truncate(n_kept);
    }

    /// `true` when no capsule reaches above the table.
    pub(crate) fn is_empty(&self) -> bool {
        self.capsules.is_empty()
    }

    /// Shares of points near a person and near the robot, 0 to 1, with margins increased by
    /// `extra_margin_m`, metres.
    pub(crate) fn shares<'a>(
        &self,
        points: &(impl Iterator<Item = &'a Point> + Clone),
        extra_margin_m: f64,
    ) -> [f32; 2] {
        [BodyKind::Person, BodyKind::Robot].map(|kind| {
            let own = self.capsules.iter().filter(|capsule| capsule.kind == kind);
            let own = own.map(|capsule| capsule.grown(extra_margin_m as f32));
            let (mut n, mut n_own) = (0_u32, 0_u32);
            for point in points.clone() {
                n += 1;
                n_own += u32::from(own.clone().any(|capsule| capsule.contains(point)));
            }
            n_own as f32 / n.max(1) as f32
        })
    }
}

/// Bounding-box test of a grown capsule against the prism; `false` for a capsule that is
/// not finite.
fn reaches_into_prism(capsule: &Capsule, margin_m: f64, table: &Table, config: &RawConfig) -> bool {
    let [from, to] = [capsule.from, capsule.to].map(|end| table.table_from_camera * end);
    let reach = capsule.radius_m + margin_m;
    let (low, high) = (from.inf(&to), from.sup(&to));
    let corners = table.polygon.corners();
    let nothing = (
        Point3::new(f64::INFINITY, f64::INFINITY, 0.0),
        Point3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, config.height_max_m),
    );
    let (first, last) = corners.iter().fold(nothing, |(first, last), corner| {
        (
            Point3::new(first.x.min(corner.x), first.y.min(corner.y), first.z),
            Point3::new(last.x.max(corner.x), last.y.max(corner.y), last.z),
        )
    });
    (0..3).all(|i| low[i] - reach <= last[i] && first[i] <= high[i] + reach)
}
