//! A small seeded generator.

/// `SplitMix64` (Steele, Lea and Flood 2014): one word of state, the same on
/// every machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Random {
    state: u64,
}

impl Random {
    /// A stream for one use of a seed; different uses are independent.
    pub(crate) fn new(seed: u64, purpose: u64) -> Self {
        let mut random = Self {
            state: seed ^ purpose.wrapping_mul(0xd134_2543_de82_ef95),
        };
        random.next_u64();
        random
    }

    pub(crate) fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From 0 up to, not including, 1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From `low` to `high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A number below `bound`; 0 when the bound is 0.
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        ((u128::from(self.next_u64()) * bound as u128) >> 64) as usize
    }

    /// One of the choices; `None` of none.
    pub(crate) fn choice<'a, T>(&mut self, choices: &'a [T]) -> Option<&'a T> {
        choices.get(self.below(choices.len()))
    }

    /// A rotation, uniform over all rotations (Shoemake 1992).
    pub(crate) fn rotation(&mut self) -> nalgebra::UnitQuaternion<f64> {
        use std::f64::consts::TAU;
        let (u, v, w) = (self.unit(), self.unit() * TAU, self.unit() * TAU);
        let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
        let (sin_v, cos_v) = v.sin_cos();
        let (sin_w, cos_w) = w.sin_cos();
        nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(
            b * cos_w,
            a * sin_v,
            a * cos_v,
            b * sin_w,
        ))
    }
}
