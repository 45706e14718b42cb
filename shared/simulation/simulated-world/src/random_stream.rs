//! Independent random streams by seed and purpose, and random rotations.

use nalgebra::{Quaternion, UnitQuaternion};
use random::Random;
use std::f64::consts::TAU;

/// Random stream of a seed for one purpose; streams of different purposes are independent.
pub fn random_stream(seed: u64, purpose: u64) -> Random {
    let mut random = Random::from_seed(seed ^ purpose.wrapping_mul(0xd134_2543_de82_ef95));
    random.next_u64();
    random
}

/// Uniform random rotation (Shoemake 1992).
pub(crate) fn random_rotation(random: &mut Random) -> UnitQuaternion<f64> {
    let (u, v, w) = (random.unit(), random.unit() * TAU, random.unit() * TAU);
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    let (sin_v, cos_v) = v.sin_cos();
    let (sin_w, cos_w) = w.sin_cos();
    let (b_cos, a_sin, a_cos, b_sin) = (b * cos_w, a * sin_v, a * cos_v, b * sin_w);
    UnitQuaternion::new_normalize(Quaternion::new(b_cos, a_sin, a_cos, b_sin))
}
