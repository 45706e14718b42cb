//! Evidence for a part of a body in a connected component.

/// Least number of samples at the entry at 1 m; divided by z at depth z. An arm is broader.
/// Chosen.
const ENTRY_MIN_AT_1M: f32 = 3.0;

/// Least number of samples of the lower contour with free space beneath at 1 m; divided by z at
/// depth z. Chosen.
const FREE_MIN_AT_1M: f32 = 6.0;

/// Least number of samples of the lower contour that meet a tracked object at 1 m, for a hand
/// that holds it; divided by z at depth z. Chosen.
const HOLDING_MIN_AT_1M: f32 = 3.0;

/// Least share of the lower contour with free space beneath, of what is not hidden. Chosen.
const FREE_SHARE_MIN: f32 = 0.5;

/// Least share of a component's samples that showed a body in the previous frame, for one that
/// goes on. Chosen.
const CONTINUED_SHARE_MIN: f32 = 0.5;

/// Greatest number of frames for which a body goes on without evidence of its own: an arm that
/// puts something down is connected with what stands. Chosen.
const CONTINUED_FRAMES_MAX: u8 = 60;

/// Least share of the samples at places that were seen free, of those whose places were seen.
/// Chosen.
const ARRIVED_SHARE_MIN: f32 = 0.2;

/// Evidence for a part of a body in one component, as numbers of samples.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Evidence {
    /// Samples at the entry.
    pub(super) n_entry: u32,
    /// Samples of the lower contour with free space beneath.
    pub(super) n_free: u32,
    /// Samples of the lower contour that meet a surface beneath.
    pub(super) n_standing: u32,
    /// Samples of the lower contour that meet a tracked object beneath.
    pub(super) n_holding: u32,
    /// Samples of the lower contour that a body hides.
    pub(super) n_behind_body: u32,
    /// Samples at places that were seen free some frames ago.
    pub(super) n_arrived: u32,
    /// Samples at places where a surface was seen some frames ago.
    pub(super) n_still: u32,
    /// Samples that showed a body in the previous frame.
    pub(super) n_continued: u32,
    /// Least age of these, frames; 0 without any.
    pub(super) age: u8,
}

impl Evidence {
    /// Adds the age of a body that a sample showed in the previous frame; 0 for none.
    pub(super) fn continue_from(&mut self, age: u8) {
        if age > 0 {
            self.n_continued += 1;
            self.age = if self.age == 0 {
                age
            } else {
                self.age.min(age)
            };
        }
    }

    /// `true` when the component moves, or showed a body in the previous frame.
    pub(super) fn moves(&self) -> bool {
        let [arrived, still] = [self.n_arrived, self.n_still].map(|n| n as f32);
        self.n_continued > 0 || arrived > ARRIVED_SHARE_MIN * (arrived + still)
    }

    /// `true` when the component enters over a border with the width of an arm.
    pub(super) fn enters(&self, depth_m: f32) -> bool {
        self.n_entry as f32 * depth_m >= ENTRY_MIN_AT_1M
    }

    /// `true` when enough of the lower contour is visible.
    pub(super) fn shows_contour(&self, depth_m: f32) -> bool {
        (self.n_free + self.n_standing) as f32 * depth_m >= FREE_MIN_AT_1M
    }

    /// `true` when most of the visible lower contour is over free space.
    pub(super) fn floats(&self, depth_m: f32) -> bool {
        let [free, standing] = [self.n_free, self.n_standing].map(|n| n as f32);
        free * depth_m >= FREE_MIN_AT_1M && free >= FREE_SHARE_MIN * (free + standing)
    }

    /// `true` when bodies hide most of the lower contour.
    pub(super) fn is_behind_body(&self) -> bool {
        self.n_behind_body > self.n_free + self.n_standing + self.n_holding
    }

    /// `true` when the component meets a tracked object and nothing else to stand on.
    pub(super) fn holds(&self, depth_m: f32) -> bool {
        let [holding, standing] = [self.n_holding, self.n_standing].map(|n| n as f32);
        holding * depth_m >= HOLDING_MIN_AT_1M && standing <= FREE_SHARE_MIN * holding
    }

    /// Age of a component that goes on as a body without evidence of its own.
    pub(super) fn continued_age(&self, n_samples: u32) -> Option<u8> {
        let is_continued = self.n_continued > 0
            && self.n_continued as f32 >= CONTINUED_SHARE_MIN * n_samples as f32;
        (is_continued && self.age < CONTINUED_FRAMES_MAX).then_some(self.age + 1)
    }
}
