//! Headers of the newest frames, by which what perception says later about a frame is placed.

use message::FrameHeader;
use std::collections::VecDeque;

/// Number of frames whose headers are kept: perception is at most a second behind.
const N_FRAMES_MAX: usize = 64;

/// Headers of the newest frames with the numbers of their points.
#[derive(Debug, Default)]
pub(crate) struct FrameHeaders(VecDeque<(FrameHeader, usize)>);

impl FrameHeaders {
    /// Keeps the header of a new frame.
    pub(crate) fn push(&mut self, header: &FrameHeader, n_points: usize) {
        if self.0.len() == N_FRAMES_MAX {
            self.0.pop_front();
        }
        self.0.push_back((*header, n_points));
    }

    /// Header of a frame and the number of its points; `None` if it is not known any more.
    pub(crate) fn find(&self, session: u64, sequence: u64) -> Option<&(FrameHeader, usize)> {
        let is_frame = |(header, _): &&(FrameHeader, usize)| {
            (header.session, header.sequence) == (session, sequence)
        };
        self.0.iter().find(is_frame)
    }
}
