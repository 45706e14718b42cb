//! Our own descriptor: shape, size and colour of an object as one vector whose
//! Euclidean distances say how unlike two views are.
//!
//! Its shape is GOOD with the weak places mended: the support is metric and
//! centred in the box, bins are soft and share one fixed order, and no sign is
//! decided, since all readings of the axes are compared.
//!
//! *Source*: the projections are those of Kasaei, Tomé, Seabra Lopes, Oliveira,
//! "GOOD: A global orthographic object descriptor for 3D object recognition and
//! manipulation", Pattern Recognition Letters 83, 2016.

mod color;
mod cosine_transform;
mod layout;
mod readings;
mod soft_bins;
mod warp;
mod warped_good;

use crate::object_axes::{AxesKind, object_axes};
use crate::{Error, ObjectPoints};
use color::{Colors, N_CHROMATICITIES, N_COLORS};
use nalgebra::UnitVector3;
use readings::Readings;
use std::sync::LazyLock;

pub use readings::N_READINGS;
pub use warped_good::WarpedGood;

/// Where the sides and the colours stand behind the shape as they are computed, and
/// the length of a descriptor. Stored values stand in the order of [`layout`].
const SIZE_AT: usize = WarpedGood::DIMENSION;
const COLOR_AT: usize = SIZE_AT + 3;
const DIMENSION: usize = COLOR_AT + N_COLORS;

/// Added to a side before its logarithm is taken, metres: thin things are as thick
/// as noise makes them.
const THICKNESS_M: f32 = 0.005;

/// How much each part of a descriptor says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AppearanceWeights {
    /// Of the three projections, whose squared distance is at most 6.
    pub shape: f32,
    /// Of the logarithms of the box's sides.
    pub size: f32,
    /// Of chromaticity, whose squared distance is at most 2; lightness says about
    /// half as much.
    pub color: f32,
}

impl Default for AppearanceWeights {
    fn default() -> Self {
        Self {
            shape: 1.0,
            size: 1.0,
            color: 0.55,
        }
    }
}

impl AppearanceWeights {
    /// Without colour.
    pub fn shape_only() -> Self {
        Self {
            color: 0.0,
            ..Self::default()
        }
    }

    fn validated(self) -> Result<Self, Error> {
        for weight in [self.shape, self.size, self.color] {
            if !(0.0..=100.0).contains(&weight) {
                return Err(Error::Weight(weight));
            }
        }
        Ok(self)
    }
}

/// Describes objects; owns its scratch memory and the last description.
#[derive(Debug, Clone)]
pub struct Appearance {
    weights: AppearanceWeights,
    shape: WarpedGood,
    colors: Colors,
    readings: Readings,
    computed: Vec<f32>,
    described: [Vec<f32>; N_READINGS],
}

impl Appearance {
    /// Values of a descriptor.
    pub const DIMENSION: usize = DIMENSION;

    /// A descriptor with these weights, each from 0 to 100.
    ///
    /// # Errors
    /// When a weight is out of range.
    pub fn new(weights: AppearanceWeights) -> Result<Self, Error> {
        Ok(Self {
            weights: weights.validated()?,
            shape: WarpedGood::new(),
            colors: Colors::new(),
            readings: Readings::new(),
            computed: Vec::with_capacity(DIMENSION),
            described: Default::default(),
        })
    }

    /// Describes the finite points of an object; `up` is the direction against
    /// gravity in their frame. Descriptions with and without `up` can not be
    /// compared with each other.
    ///
    /// The result are all readings of the object's axes, in each first the values
    /// that differ most between objects. One of them, say the
    /// first, is stored for a view; the distance of an object to a stored view is
    /// the least of its readings' Euclidean distances. That distance does not
    /// change when the object is moved or turned (about `up`, if it is given), nor
    /// with the order of its points; a mirrored object is another one.
    ///
    /// No allocation but for the first objects.
    ///
    /// # Errors
    /// When there are fewer than three finite points, or their extent is not finite.
    pub fn describe(
        &mut self,
        points: ObjectPoints<'_>,
        up: Option<&UnitVector3<f64>>,
    ) -> Result<&[Vec<f32>; N_READINGS], Error> {
        let axes = object_axes(points, up).ok_or(Error::NoPoints)?;
        let computed = &mut self.computed;
        computed.clear();
        let sides_m = self
            .shape
            .append(points, &axes.object_from_source, computed)?;
        for value in &mut *computed {
            *value *= self.weights.shape;
        }
        let log_side = |side_m: f32| self.weights.size * (side_m + THICKNESS_M).ln();
        computed.extend(sides_m.map(log_side));
        self.colors.append(points, self.weights.color, computed);
        for (reading, described) in self.described.iter_mut().enumerate() {
            self.readings.read(axes.kind, reading, computed, described);
        }
        Ok(&self.described)
    }

    /// All readings of a stored description, itself the first: what
    /// [`describe`](Self::describe) would have given, had it begun with that reading.
    /// Values that are missing are taken for 0.
    pub fn readings_of(stored: &[f32], kind: AxesKind) -> [Vec<f32>; N_READINGS] {
        static READINGS: LazyLock<Readings> = LazyLock::new(Readings::new);
        static PLACES: LazyLock<Vec<usize>> = LazyLock::new(layout::places);
        let mut computed = vec![0.0; DIMENSION];
        for (&place, &value) in PLACES.iter().zip(stored) {
            computed[place] = value;
        }
        std::array::from_fn(|reading| {
            let mut described = Vec::with_capacity(DIMENSION);
            READINGS.read(kind, reading, &computed, &mut described);
            described
        })
    }
}

#[cfg(test)]
mod tests;
