//! The same object, its axes read in another way.

use super::cosine_transform::{N_COEFFICIENTS, frequencies};
use super::{COLOR_AT, DIMENSION, SIZE_AT, layout};
use crate::AxesKind;

/// In how many ways the axes of an object can be read.
pub const N_READINGS: usize = 4;

/// For each kind of axes the four readings of a descriptor: since turning an
/// axis round changes only signs of coefficients, and a quarter turn only their
/// places, no reading needs the points again.
#[derive(Debug, Clone)]
pub(super) struct Readings {
    principal: [Reading; N_READINGS],
    upright: [Reading; N_READINGS],
}

/// Where each value of a reading comes from, and its sign.
#[derive(Debug, Clone)]
struct Reading {
    source: Vec<u16>,
    sign: Vec<f32>,
}

/// A right-handed change of axes that keeps their lines: new axis `i` is old axis
/// `axis[i]`, turned round where `sign[i]` is negative.
#[derive(Debug, Clone, Copy)]
struct Turn {
    axis: [usize; 3],
    sign: [i8; 3],
}

/// The axes of the three projections: rows and columns.
const PLANES: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

impl Readings {
    pub(super) fn new() -> Self {
        let keep = [0, 1, 2];
        let principal = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
            .map(|sign| Reading::new(Turn { axis: keep, sign }));
        let swap = [1, 0, 2];
        let upright = [
            (keep, [1, 1, 1]),
            (swap, [1, -1, 1]),
            (keep, [-1, -1, 1]),
            (swap, [-1, 1, 1]),
        ]
        .map(|(axis, sign)| Reading::new(Turn { axis, sign }));
        Self { principal, upright }
    }

    /// Replaces the content of `out` by one reading of a descriptor's values as they
    /// are computed.
    pub(super) fn read(
        &self,
        kind: AxesKind,
        reading: usize,
        descriptor: &[f32],
        out: &mut Vec<f32>,
    ) {
        let readings = match kind {
            AxesKind::Principal => &self.principal,
            AxesKind::Upright => &self.upright,
        };
        let Reading { source, sign } = &readings[reading];
        let values = source.iter().zip(sign);
        out.clear();
        out.extend(values.map(|(&i, sign)| sign * descriptor[usize::from(i)]));
    }
}

impl Reading {
    fn new(turn: Turn) -> Self {
        let mut source: Vec<u16> = Vec::with_capacity(DIMENSION);
        let mut sign = Vec::with_capacity(DIMENSION);
        for (row, column) in PLANES {
            for (k, l) in frequencies() {
                source.push(coefficient([turn.axis[row], turn.axis[column]], [k, l]) as u16);
                sign.push(parity(turn.sign[row], k) * parity(turn.sign[column], l));
            }
        }
        source.extend(turn.axis.map(|axis| (SIZE_AT + axis) as u16));
        source.extend(COLOR_AT as u16..DIMENSION as u16);
        sign.resize(DIMENSION, 1.0);
        let places = layout::places();
        Self {
            source: places.iter().map(|&place| source[place]).collect(),
            sign: places.iter().map(|&place| sign[place]).collect(),
        }
    }
}

/// Place of the coefficient with these frequencies along these two axes.
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

/// Sign of a function of this frequency when its axis is turned round.
fn parity(sign: i8, frequency: usize) -> f32 {
    if sign < 0 && frequency % 2 == 1 {
        -1.0
    } else {
        1.0
    }
}
