//! Age and staleness of a scene. Pure functions of passed-in times.

/// Times of a scene from which its age follows, nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SceneTime {
    /// Capture time of the frame: monotonic clock, or the recording's own in lockstep.
    pub capture_ns: u64,
    /// Time at which perception received the frame, monotonic clock.
    pub received_ns: u64,
    /// Age above which the scene is stale.
    pub stale_after_ns: u64,
    /// True if the source waits for its followers, with a clock of its own.
    pub is_lockstep: bool,
}

impl SceneTime {
    /// Age at a time of the monotonic clock: the time since the capture of the frame, in
    /// lockstep since its reception.
    pub fn age_ns(&self, now_ns: u64) -> u64 {
        let from_ns = if self.is_lockstep {
            self.received_ns
        } else {
            self.capture_ns
        };
        now_ns.saturating_sub(from_ns)
    }

    /// Age in seconds.
    pub fn age_s(&self, now_ns: u64) -> f64 {
        self.age_ns(now_ns) as f64 * 1e-9
    }

    /// True if the scene no longer shows the present. In lockstep the world stands still
    /// between two frames, so that its scene is never stale.
    pub fn is_stale(&self, now_ns: u64) -> bool {
        !self.is_lockstep && self.age_ns(now_ns) > self.stale_after_ns
    }

    /// The present on the clock of the capture stamps.
    pub fn present_ns(&self, now_ns: u64) -> u64 {
        if self.is_lockstep {
            self.capture_ns
        } else {
            now_ns.max(self.capture_ns)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scene_is_stale_when_it_is_older_than_its_limit() {
        let scene = SceneTime {
            capture_ns: 1_000,
            received_ns: 1_040,
            stale_after_ns: 100,
            is_lockstep: false,
        };
        assert_eq!((scene.age_ns(1_100), scene.is_stale(1_100)), (100, false));
        assert_eq!((scene.age_ns(1_101), scene.is_stale(1_101)), (101, true));
        assert_eq!(scene.present_ns(1_101), 1_101);
        // A source may predict the exposure.
        assert_eq!((scene.age_ns(999), scene.present_ns(999)), (0, 1_000));
    }

    #[test]
    fn scene_in_lockstep_ages_on_our_clock_and_is_never_stale() {
        let scene = SceneTime {
            capture_ns: 1_000_000,
            received_ns: 1_040,
            stale_after_ns: 100,
            is_lockstep: true,
        };
        assert_eq!((scene.age_ns(5_040), scene.is_stale(5_040)), (4_000, false));
        assert_eq!(scene.present_ns(5_040), 1_000_000);
    }
}
