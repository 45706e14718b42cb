//! Settings of the planning of grasps.

/// Settings of the planning of grasps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GraspSettings {
    /// Length of the straight approach, metres.
    pub approach_m: f64,
    /// Length of the straight way up with the object, metres.
    pub lift_m: f64,
    /// Cost of a way of which nobody has seen anything, as a share of the score, 0 to 1.
    pub unseen_cost: f64,
    /// Share of the hand's way that may be unseen, 0 to 1; a grasp with more is rejected.
    pub unseen_max: f64,
    /// Density by which the mass of an object is estimated, kg/m³: full packages (behaviour of
    /// the simulation).
    pub density_kg_m3: f64,
    /// Score below which a grasp is none, 0 to 1.
    pub score_min: f64,
    /// Number of grasps after which the search ends.
    pub n_wanted: usize,
    /// Number of grasps that are tested for collisions and reach, at most.
    pub n_tested_max: usize,
}

impl Default for GraspSettings {
    fn default() -> Self {
        Self {
            approach_m: 0.10,
            lift_m: 0.15,
            unseen_cost: 0.5,
            unseen_max: 0.9,
            density_kg_m3: 300.0,
            score_min: 0.02,
            n_wanted: 8,
            n_tested_max: 120,
        }
    }
}
