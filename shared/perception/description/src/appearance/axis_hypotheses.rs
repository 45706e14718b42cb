//! Axis hypotheses: a descriptor under all ambiguous choices of the object axes.

use super::box_profile::BoxProfile;
use super::cosine_transform::{N_COEFFICIENTS, frequencies};
use super::{COLOR_OFFSET, DIMENSION, PROFILE_OFFSET, SIZE_OFFSET, value_order};
use crate::AxesKind;

/// Number of axis hypotheses of a descriptor.
pub const N_AXIS_HYPOTHESES: usize = 4;

/// Signed permutations of the four axis hypotheses, for each kind of axes. Reversing an
/// axis only changes signs of coefficients, and a quarter turn only permutes them, so no
/// hypothesis needs the points again. The last two are the first two after a half turn about
/// the third axis.
#[derive(Debug, Clone)]
pub(super) struct AxisHypotheses {
    principal: [SignedPermutation; N_AXIS_HYPOTHESES],
    upright: [SignedPermutation; N_AXIS_HYPOTHESES],
}

/// Signed permutation of descriptor values: source index and sign of each value.
#[derive(Debug, Clone)]
struct SignedPermutation {
    source: Vec<u16>,
    sign: Vec<f32>,
}

/// Right-handed permutation of axes: new axis `i` is old axis `axis[i]`, reversed where
/// `sign[i]` is negative.
#[derive(Debug, Clone, Copy)]
struct AxisPermutation {
    axis: [usize; 3],
    sign: [i8; 3],
}

/// Row and column axes of the three projections.
const PLANES: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

impl AxisHypotheses {
    pub(super) fn new() -> Self {
        let keep = [0, 1, 2];
        let principal = [[1, 1, 1], [1, -1, -1], [-1, -1, 1], [-1, 1, -1]]
            .map(|sign| SignedPermutation::new(AxisPermutation { axis: keep, sign }));
        let swap = [1, 0, 2];
        let upright = [
            (keep, [1, 1, 1]),
            (swap, [1, -1, 1]),
            (keep, [-1, -1, 1]),
            (swap, [-1, 1, 1]),
        ]
        .map(|(axis, sign)| SignedPermutation::new(AxisPermutation { axis, sign }));
        Self { principal, upright }
    }

    /// Writes one axis hypothesis of the computed descriptor to `out`, replacing its
    /// content.
    pub(super) fn apply(
        &self,
        kind: AxesKind,
        hypothesis: usize,
        descriptor: &[f32],
        out: &mut Vec<f32>,
    ) {
        let hypotheses = match kind {
            AxesKind::Principal => &self.principal,
            AxesKind::Upright => &self.upright,
        };
        let SignedPermutation { source, sign } = &hypotheses[hypothesis];
        let values = source.iter().zip(sign);
        out.clear();
        out.extend(values.map(|(&i, sign)| sign * descriptor[usize::from(i)]));
    }
}

impl SignedPermutation {
    fn new(permutation: AxisPermutation) -> Self {
        let mut source: Vec<u16> = Vec::with_capacity(DIMENSION);
        let mut sign = Vec::with_capacity(DIMENSION);
        for (row, column) in PLANES {
            for (k, l) in frequencies() {
                source.push(
                    coefficient([permutation.axis[row], permutation.axis[column]], [k, l]) as u16,
                );
                sign.push(parity(permutation.sign[row], k) * parity(permutation.sign[column], l));
            }
        }
        source.extend(permutation.axis.map(|axis| (SIZE_OFFSET + axis) as u16));
        source.extend(COLOR_OFFSET as u16..PROFILE_OFFSET as u16);
        if permutation.sign[2] < 0 {
            let mirrored = BoxProfile::mirrored();
            source.extend(mirrored.map(|i| (PROFILE_OFFSET + i) as u16));
        } else {
            source.extend(PROFILE_OFFSET as u16..DIMENSION as u16);
        }
        sign.resize(DIMENSION, 1.0);
        let places = value_order::storage_order();
        Self {
            source: places.iter().map(|&place| source[place]).collect(),
            sign: places.iter().map(|&place| sign[place]).collect(),
        }
    }
}

/// Values of a stored descriptor that change their sign when these axes are reversed, where only
/// coefficients change.
fn odd_values(is_reversed: [bool; 3]) -> Vec<bool> {
    let is_odd = |axis: usize, frequency: usize| is_reversed[axis] && frequency % 2 == 1;
    let mut computed = Vec::with_capacity(DIMENSION);
    for (row, column) in PLANES {
        computed.extend(frequencies().map(|(k, l)| is_odd(row, k) != is_odd(column, l)));
    }
    computed.resize(DIMENSION, false);
    let places = value_order::storage_order();
    places.iter().map(|&place| computed[place]).collect()
}

/// Values of a stored descriptor that change their sign when the object is mirrored at the plane
/// across its second axis; all others stay as they are.
pub(super) fn mirror_odd_values() -> Vec<bool> {
    odd_values([false, true, false])
}

/// Values of a stored descriptor that change their sign when the object is turned by half about
/// its third axis; all others stay as they are.
pub(super) fn half_turn_odd_values() -> Vec<bool> {
    odd_values([true, true, false])
}

/// Index of the coefficient with two frequencies along two axes.
fn coefficient(axes: [usize; 2], frequencies_wanted: [usize; 2]) -> usize {
    let is_plane = |plane: &(usize, usize)| {
        (plane.0 == axes[0] && plane.1 == axes[1]) || (plane.0 == axes[1] && plane.1 == axes[0])
    };
    let plane = PLANES.iter().position(is_plane).unwrap_or(0);
    let is_as_stored = PLANES[plane].0 == axes[0];
    let [k, l] = frequencies_wanted;
    let wanted = if is_as_stored { (k, l) } else { (l, k) };
    let within = frequencies().position(|pair| pair == wanted).unwrap_or(0);
    plane * N_COEFFICIENTS + within
}

/// Sign of a cosine basis function when its axis is reversed.
fn parity(sign: i8, frequency: usize) -> f32 {
    if sign < 0 && frequency % 2 == 1 {
        -1.0
    } else {
        1.0
    }
}
