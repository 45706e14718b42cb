//! Time synchronisation of depth and colour images by their stamps.
//!
//! The Kinect stamps both streams with one 60 MHz counter of 32 bits, which wraps about every
//! 71.6 seconds. Frames of a stream are a thirtieth of a second apart, 2 000 000 ticks. A depth
//! and a colour image are paired if their stamps differ by less than half of that: at most one
//! image of a stream is that near, so it is the nearest, and waiting for a better one would only
//! add delay.
//!
//! Pure: frames and their arrival times come from the caller.

use std::collections::VecDeque;
use std::time::Instant;

/// Frequency of the Kinect's clock, hertz.
pub const CLOCK_HZ: u32 = 60_000_000;
/// Maximum difference of the stamps of a pair, ticks (exclusive): half a frame period.
pub const PAIRING_WINDOW_TICKS: u32 = CLOCK_HZ / 30 / 2;

/// Maximum number of unpaired frames kept per stream. Two, because the streams may lag behind
/// each other by more than one period but never by two.
const MAX_UNPAIRED: usize = 2;

/// Number of frame buffers per stream: one being written, two unpaired, one just arrived, one in
/// the pair not yet taken, and one in the pair held by the caller.
pub(crate) const N_FRAMES: usize = MAX_UNPAIRED + 4;

/// Camera image with its time stamps.
#[derive(Debug)]
pub(crate) struct StampedFrame<T> {
    /// Device stamp of the image, ticks of [`CLOCK_HZ`].
    pub(crate) stamp_ticks: u32,
    /// Arrival time of the image.
    pub(crate) arrived: Instant,
    /// Stamped image.
    pub(crate) frame: T,
}

/// Synchronised pair of depth and colour images.
#[derive(Debug)]
pub(crate) struct Pair<D, V> {
    pub(crate) depth: StampedFrame<D>,
    pub(crate) video: StampedFrame<V>,
}

/// Unpaired frames and free buffers of one stream.
#[derive(Debug)]
struct UnpairedFrames<T> {
    frames: VecDeque<StampedFrame<T>>,
    spare: Vec<T>,
    n_unpaired: u64,
}

/// Pairs frames as they arrive, keeps the newest pair and counts losses.
#[derive(Debug)]
pub(crate) struct Pairing<D, V> {
    depth: UnpairedFrames<D>,
    video: UnpairedFrames<V>,
    ready: Option<Pair<D, V>>,
    n_pairs: u64,
    n_superseded: u64,
}

/// Counts of paired and lost frames since the camera was opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PairingStatistics {
    /// Number of synchronised pairs.
    pub n_pairs: u64,
    /// Number of pairs replaced by a newer one before they were taken.
    pub n_superseded: u64,
    /// Number of depth images without a colour image.
    pub n_unpaired_depth: u64,
    /// Number of colour images without a depth image.
    pub n_unpaired_video: u64,
}

/// `true` if two stamps are within the pairing window, across the counter's wrap.
fn within_window(a: u32, b: u32) -> bool {
    (a.wrapping_sub(b) as i32).unsigned_abs() < PAIRING_WINDOW_TICKS
}

impl<T> UnpairedFrames<T> {
    fn new(spare: Vec<T>) -> Self {
        Self {
            frames: VecDeque::with_capacity(MAX_UNPAIRED + 1),
            spare,
            n_unpaired: 0,
        }
    }

    /// Takes the frame within the pairing window. Older frames remain unpaired, since the other
    /// stream never goes back.
    fn take_partner(&mut self, stamp_ticks: u32) -> Option<StampedFrame<T>> {
        let position = self
            .frames
            .iter()
            .position(|frame| within_window(frame.stamp_ticks, stamp_ticks))?;
        self.free_unpaired(position);
        self.frames.pop_front()
    }

    /// Frees the oldest `n` frames as unpaired.
    fn free_unpaired(&mut self, n: usize) {
        for lone in self.frames.drain(..n.min(self.frames.len())) {
            self.spare.push(lone.frame);
            self.n_unpaired += 1;
        }
    }

    fn push_unpaired(&mut self, frame: StampedFrame<T>) {
        self.frames.push_back(frame);
        self.free_unpaired(self.frames.len().saturating_sub(MAX_UNPAIRED));
    }
}

impl<D, V> Pairing<D, V> {
    /// Pairing with [`N_FRAMES`] buffers per stream, less the one being written.
    pub(crate) fn new(spare_depth: Vec<D>, spare_video: Vec<V>) -> Self {
        let (depth, video) = (
            UnpairedFrames::new(spare_depth),
            UnpairedFrames::new(spare_video),
        );
        Self {
            depth,
            video,
            ready: None,
            n_pairs: 0,
            n_superseded: 0,
        }
    }

    /// Free depth buffer to be written next.
    pub(crate) fn spare_depth(&mut self) -> Option<D> {
        self.depth.spare.pop()
    }

    /// Free colour buffer to be written next.
    pub(crate) fn spare_video(&mut self) -> Option<V> {
        self.video.spare.pop()
    }

    /// Returns an unused depth buffer for reuse.
    pub(crate) fn return_depth(&mut self, frame: D) {
        self.depth.spare.push(frame);
    }

    /// Returns an unused colour buffer for reuse.
    pub(crate) fn return_video(&mut self, frame: V) {
        self.video.spare.push(frame);
    }

    /// Adds a complete depth image.
    pub(crate) fn depth_arrived(&mut self, depth: StampedFrame<D>) {
        match self.video.take_partner(depth.stamp_ticks) {
            Some(video) => {
                self.depth.free_unpaired(MAX_UNPAIRED);
                self.pair_up(Pair { depth, video });
            }
            None => self.depth.push_unpaired(depth),
        }
    }

    /// Adds a complete colour image.
    pub(crate) fn video_arrived(&mut self, video: StampedFrame<V>) {
        match self.depth.take_partner(video.stamp_ticks) {
            Some(depth) => {
                self.video.free_unpaired(MAX_UNPAIRED);
                self.pair_up(Pair { depth, video });
            }
            None => self.video.push_unpaired(video),
        }
    }

    /// Takes the newest pair that was not taken yet.
    pub(crate) fn take_ready(&mut self) -> Option<Pair<D, V>> {
        self.ready.take()
    }

    /// Returns the buffers of a pair for reuse.
    pub(crate) fn recycle(&mut self, pair: Pair<D, V>) {
        self.return_depth(pair.depth.frame);
        self.return_video(pair.video.frame);
    }

    /// Counts of paired and lost frames so far.
    pub(crate) fn statistics(&self) -> PairingStatistics {
        PairingStatistics {
            n_pairs: self.n_pairs,
            n_superseded: self.n_superseded,
            n_unpaired_depth: self.depth.n_unpaired,
            n_unpaired_video: self.video.n_unpaired,
        }
    }

    fn pair_up(&mut self, pair: Pair<D, V>) {
        self.n_pairs += 1;
        if let Some(older) = self.ready.replace(pair) {
            self.n_superseded += 1;
            self.recycle(older);
        }
    }
}

#[cfg(test)]
mod tests;
