//! States of a track, as a word in [`ObjectDocument::state`](crate::ObjectDocument::state).

coded_enum::coded_enum! {
    /// State of a track, with its code in shared memory and on disk.
    pub enum TrackState: u32 {
        /// Measured in too few frames; of earlier recordings, since such an object is no track yet.
        Tentative, "tentative";
        /// Object measured in this frame.
        Tracked, "tracked";
        /// Not measured in this frame and expected to return; neither occluded nor outside the image.
        Missing, "missing";
        /// Object not measured in this frame because it is occluded.
        Occluded, "occluded";
        /// Object not measured in this frame because it is outside the image.
        OutOfView, "out-of-view";
    }
}

impl TrackState {
    /// Word in place of the state in reports of a scene that no longer shows the present.
    pub const STALE_WORD: &str = "stale";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_those_of_states_and_others_are_none() {
        for state in TrackState::ALL {
            assert_eq!(TrackState::from_code(state.code()), Some(state));
        }
        assert_eq!(TrackState::from_code(77), None);
        let words = TrackState::ALL.map(TrackState::word);
        assert!(words.contains(&"occluded") && words.contains(&"out-of-view"));
    }
}
