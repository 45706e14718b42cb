//! Appearance descriptor: shape, size and colour of an object in one vector, compared by
//! Euclidean distance.
//!
//! Shape is described twice: in metres, which separates objects, and relative to the
//! bounding box, which generalises over the objects of a category.
//!
//! The metric shape part is a variant of GOOD. Its support is metric and centred in the
//! bounding box, bins are interpolated, the order of the projections is fixed, and the
//! signs of the axes are not decided because all axis hypotheses are compared.
//!
//! *Source*: the projections are those of Kasaei, Tomé, Seabra Lopes, Oliveira,
//! "GOOD: A global orthographic object descriptor for 3D object recognition and
//! manipulation", Pattern Recognition Letters 83, 2016.

mod axis_hypotheses;
mod box_profile;
mod color_histograms;
mod cosine_transform;
mod learned_metric;
mod local_surface;
mod soft_bins;
mod trained_metric;
mod value_order;
mod warp;
mod warped_good;

use crate::object_axes::{AxesKind, object_axes};
use crate::{Error, ObjectPoints};
use axis_hypotheses::AxisHypotheses;
use box_profile::{BoxProfile, N_PROFILE_VALUES};
use color_histograms::{ColorHistograms, N_CHROMATICITIES, N_COLORS};
use nalgebra::UnitVector3;
use std::sync::LazyLock;

pub use axis_hypotheses::N_AXIS_HYPOTHESES;
pub use learned_metric::LearnedMetric;
pub use warped_good::WarpedGood;

/// Offset of the size values in the computed order, behind the shape values. Stored
/// values follow [`value_order`].
const SIZE_OFFSET: usize = WarpedGood::DIMENSION;

/// Offset of the colour values in the computed order.
const COLOR_OFFSET: usize = SIZE_OFFSET + 3;

/// Offset of the box profile in the computed order.
const PROFILE_OFFSET: usize = COLOR_OFFSET + N_COLORS;

/// Length of an appearance descriptor, values.
const DIMENSION: usize = PROFILE_OFFSET + N_PROFILE_VALUES;

/// Offset added to a side before the logarithm, metres: the thickness that noise gives
/// to thin objects. Chosen.
const SIDE_OFFSET_M: f32 = 0.005;

/// Maximum number of points described; larger objects are thinned evenly. With 1500 the
/// accuracies of mesh categories and of scanned objects stayed within 0.3 points.
const N_POINTS_MAX: usize = 2000;

/// Weights of the parts of an appearance descriptor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AppearanceWeights {
    /// Weight of the three projections, whose squared distance is at most 6.
    pub shape: f32,
    /// Weight of the logarithms of the box sides.
    pub size: f32,
    /// Weight of chromaticity, whose squared distance is at most 2; lightness counts
    /// about half as much.
    pub color: f32,
    /// Weight of the shape relative to the bounding box, whose squared distance is at
    /// most 5.
    pub profile: f32,
}

impl Default for AppearanceWeights {
    /// Weights of the live system. Chosen.
    fn default() -> Self {
        Self {
            shape: 1.0,
            size: 1.0,
            color: 0.55,
            profile: 1.0,
        }
    }
}

impl AppearanceWeights {
    /// Descriptor weights without colour.
    pub fn shape_only() -> Self {
        Self {
            color: 0.0,
            ..Self::default()
        }
    }

    fn validated(self) -> Result<Self, Error> {
        for weight in [self.shape, self.size, self.color, self.profile] {
            if !(0.0..=100.0).contains(&weight) {
                return Err(Error::Weight(weight));
            }
        }
        Ok(self)
    }
}

/// Appearance descriptor with its scratch memory and last result.
#[derive(Debug, Clone)]
pub struct AppearanceDescriptor {
    weights: AppearanceWeights,
    shape: WarpedGood,
    colors: ColorHistograms,
    profile: BoxProfile,
    hypotheses: AxisHypotheses,
    computed: Vec<f32>,
    described: [Vec<f32>; N_AXIS_HYPOTHESES],
}

impl AppearanceDescriptor {
    /// Length of an appearance descriptor, values.
    pub const DIMENSION: usize = DIMENSION;

    /// Descriptor with weights from 0 to 100.
    ///
    /// # Errors
    /// When a weight is out of range.
    pub fn new(weights: AppearanceWeights) -> Result<Self, Error> {
        Ok(Self {
            weights: weights.validated()?,
            shape: WarpedGood::new(),
            colors: ColorHistograms::new(),
            profile: BoxProfile::new(),
            hypotheses: AxisHypotheses::new(),
            computed: Vec::with_capacity(DIMENSION),
            described: Default::default(),
        })
    }

    /// Describes the finite points of an object; `up` is the direction against gravity
    /// in their frame. Descriptors with and without `up` are not comparable.
    ///
    /// Returns the descriptor in all axis hypotheses, each with the values of largest
    /// variance first. One of them, for instance the first, is stored for a view. The
    /// distance of an object to a stored view is the least Euclidean distance over the
    /// hypotheses. It is invariant to translation, to rotation (about `up`, if given)
    /// and to the order of the points, but not to mirroring.
    ///
    /// Objects of more than 2000 points are thinned evenly. Allocates for the first
    /// objects only.
    ///
    /// # Errors
    /// When there are fewer than three finite points, or their extent is not finite.
    pub fn describe(
        &mut self,
        points: ObjectPoints<'_>,
        up: Option<&UnitVector3<f64>>,
    ) -> Result<&[Vec<f32>; N_AXIS_HYPOTHESES], Error> {
        let points = points.thinned(N_POINTS_MAX);
        let axes = object_axes(points, up).ok_or(Error::NoPoints)?;
        let computed = &mut self.computed;
        computed.clear();
        let ranges_m = self
            .shape
            .append(points, &axes.object_from_source, computed)?;
        for value in &mut *computed {
            *value *= self.weights.shape;
        }
        let log_side = |side_m: f32| self.weights.size * (side_m + SIDE_OFFSET_M).ln();
        computed.extend(ranges_m.map(|(low, high)| log_side(high - low)));
        self.colors.append(points, self.weights.color, computed);
        let profile = (axes.kind, self.weights.profile);
        self.profile
            .append(self.shape.points(), ranges_m, profile, computed);
        for (hypothesis, described) in self.described.iter_mut().enumerate() {
            self.hypotheses
                .apply(axes.kind, hypothesis, computed, described);
        }
        Ok(&self.described)
    }

    /// Parts of a stored descriptor, by value: `shape`, `size`, `color` or `profile`.
    pub fn value_parts() -> Vec<&'static str> {
        let part = |place: usize| match place {
            0..SIZE_OFFSET => "shape",
            SIZE_OFFSET..COLOR_OFFSET => "size",
            COLOR_OFFSET..PROFILE_OFFSET => "color",
            _ => "profile",
        };
        value_order::storage_order().into_iter().map(part).collect()
    }

    /// Values of a stored descriptor that change their sign when the object is mirrored: the
    /// descriptor of its mirror image, in one of the axis hypotheses, differs in these signs only.
    /// True for such a value; as many as the descriptor has.
    pub fn mirror_odd_values() -> &'static [bool] {
        static VALUES: LazyLock<Vec<bool>> = LazyLock::new(axis_hypotheses::mirror_odd_values);
        &VALUES
    }

    /// Values of a stored descriptor that change their sign between hypotheses `i` and `i + 2`,
    /// which differ in these signs only: by a half turn about the third axis. True for such a
    /// value; as many as the descriptor has.
    pub fn half_turn_odd_values() -> &'static [bool] {
        static VALUES: LazyLock<Vec<bool>> = LazyLock::new(axis_hypotheses::half_turn_odd_values);
        &VALUES
    }

    /// Descriptor of a stored view in one of the [`N_AXIS_HYPOTHESES`], of which 0 is the stored
    /// one: what [`describe`](Self::describe) gives for it. Missing values are taken as 0.
    ///
    /// # Panics
    /// When there is no such hypothesis.
    pub fn axis_hypothesis_of(stored: &[f32], kind: AxesKind, hypothesis: usize) -> Vec<f32> {
        static HYPOTHESES: LazyLock<AxisHypotheses> = LazyLock::new(AxisHypotheses::new);
        static STORAGE_ORDER: LazyLock<Vec<usize>> = LazyLock::new(value_order::storage_order);
        let mut computed = [0.0; DIMENSION];
        for (&place, &value) in STORAGE_ORDER.iter().zip(stored) {
            computed[place] = value;
        }
        let mut described = Vec::with_capacity(DIMENSION);
        HYPOTHESES.apply(kind, hypothesis, &computed, &mut described);
        described
    }
}

#[cfg(test)]
mod tests;
