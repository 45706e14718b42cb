//! Frame callbacks of the library.
//!
//! The library calls back with a device pointer, the pixels' address and a stamp, always from
//! inside one of its own functions and so on the thread that owns the camera. A thread-local
//! table maps the device pointer to the camera's [`FrameSink`]. The library stores no address of
//! ours except the image buffers themselves: a late callback finds no entry and does nothing.
//!
//! Nothing here panics; a panic would abort the process rather than unwind into C, which is the
//! contract of `extern "C"`.

#![expect(unsafe_code, reason = "buffers are handed to C and images read back")]

use crate::frame::{Image, KinectFrame};
use crate::frame_buffer::FrameBuffer;
use crate::pairing::{N_FRAMES, Pair, Pairing, PairingStatistics, StampedFrame};
use crate::raw::{Api, Device, N_PIXELS};
use std::cell::RefCell;
use std::ffi::c_void;
use std::mem;
use std::rc::Rc;
use std::time::Instant;

/// Entry of the table: device and sink of a camera on this thread.
type SinkEntry = (*mut Device, Rc<RefCell<FrameSink>>);

thread_local! {
    static SINKS: RefCell<Vec<SinkEntry>> = const { RefCell::new(Vec::new()) };
}

/// Receiver of one camera's frames; owns all its image memory.
pub(crate) struct FrameSink {
    api: Api,
    depth_filling: FrameBuffer<u16>,
    video_filling: FrameBuffer<u8>,
    pairing: Pairing<FrameBuffer<u16>, FrameBuffer<u8>>,
    misplaced: bool,
}

/// Image pair held by the caller; the library no longer writes to it.
pub(crate) struct HeldPair(Pair<FrameBuffer<u16>, FrameBuffer<u8>>);

/// Entry of a sink in its thread's table, removed on drop.
pub(crate) struct SinkRegistration {
    device: *mut Device,
}

impl SinkRegistration {
    /// Routes the frames of `device` to `sink` until dropped.
    pub(crate) fn new(device: *mut Device, sink: Rc<RefCell<FrameSink>>) -> Self {
        SINKS.with_borrow_mut(|sinks| sinks.push((device, sink)));
        Self { device }
    }
}

impl Drop for SinkRegistration {
    fn drop(&mut self) {
        // At thread exit the table may already be destroyed, and the entry with it.
        let _ = SINKS.try_with(|sinks| {
            if let Ok(mut sinks) = sinks.try_borrow_mut() {
                sinks.retain(|(device, _)| *device != self.device);
            }
        });
    }
}

/// Callback of libfreenect for depth images.
pub(crate) extern "C" fn on_depth(device: *mut Device, pixels: *mut c_void, stamp_ticks: u32) {
    let arrived = Instant::now();
    with_sink(device, |sink| {
        sink.depth_arrived(device, pixels, stamp_ticks, arrived);
    });
}

/// Callback of libfreenect for colour images.
pub(crate) extern "C" fn on_video(device: *mut Device, pixels: *mut c_void, stamp_ticks: u32) {
    let arrived = Instant::now();
    with_sink(device, |sink| {
        sink.video_arrived(device, pixels, stamp_ticks, arrived);
    });
}

fn with_sink(device: *mut Device, act: impl FnOnce(&mut FrameSink)) {
    let sink = SINKS.try_with(|sinks| {
        let sinks = sinks.try_borrow().ok()?;
        sinks
            .iter()
            .find(|(known, _)| *known == device)
            .map(|(_, sink)| Rc::clone(sink))
    });
    if let Ok(Some(sink)) = sink
        && let Ok(mut sink) = sink.try_borrow_mut()
    {
        act(&mut sink);
    }
}

impl FrameSink {
    /// Sink with all image memory of one camera, about 9 MB.
    pub(crate) fn new(api: &Api) -> Self {
        let depth = || FrameBuffer::new(N_PIXELS);
        let video = || FrameBuffer::new(3 * N_PIXELS);
        Self {
            api: *api,
            depth_filling: depth(),
            video_filling: video(),
            pairing: Pairing::new(
                (1..N_FRAMES).map(|_| depth()).collect(),
                (1..N_FRAMES).map(|_| video()).collect(),
            ),
            misplaced: false,
        }
    }

    /// Passes the first buffers to the library; `false` if it rejects one.
    pub(crate) fn hand_over_first_buffers(&self, device: *mut Device) -> bool {
        self.hand_over_depth(device, &self.depth_filling)
            && self.hand_over_video(device, &self.video_filling)
    }

    fn depth_arrived(
        &mut self,
        device: *mut Device,
        pixels: *mut c_void,
        stamp_ticks: u32,
        arrived: Instant,
    ) {
        if pixels != self.depth_filling.address() {
            self.misplaced = true;
            return;
        }
        // There is always one; without it, this frame would be overwritten.
        let Some(next) = self.pairing.spare_depth() else {
            return;
        };
        if !self.hand_over_depth(device, &next) {
            self.misplaced = true;
            self.pairing.return_depth(next);
            return;
        }
        let frame = mem::replace(&mut self.depth_filling, next);
        self.pairing.depth_arrived(StampedFrame {
            stamp_ticks,
            arrived,
            frame,
        });
    }

    fn video_arrived(
        &mut self,
        device: *mut Device,
        pixels: *mut c_void,
        stamp_ticks: u32,
        arrived: Instant,
    ) {
        if pixels != self.video_filling.address() {
            self.misplaced = true;
            return;
        }
        let Some(next) = self.pairing.spare_video() else {
            return;
        };
        if !self.hand_over_video(device, &next) {
            self.misplaced = true;
            self.pairing.return_video(next);
            return;
        }
        let frame = mem::replace(&mut self.video_filling, next);
        self.pairing.video_arrived(StampedFrame {
            stamp_ticks,
            arrived,
            frame,
        });
    }

    fn hand_over_depth(&self, device: *mut Device, buffer: &FrameBuffer<u16>) -> bool {
        let set_depth_buffer = self.api.set_depth_buffer;
        // SAFETY: the device is open; the buffer holds one 640x480 frame of the
        // chosen mode and outlives the device; the library calls nothing back.
        let code = unsafe { set_depth_buffer(device, buffer.address()) };
        code >= 0
    }

    fn hand_over_video(&self, device: *mut Device, buffer: &FrameBuffer<u8>) -> bool {
        let set_video_buffer = self.api.set_video_buffer;
        // SAFETY: as for depth, with three bytes a pixel.
        let code = unsafe { set_video_buffer(device, buffer.address()) };
        code >= 0
    }

    /// Takes the newest pair that was not taken yet.
    pub(crate) fn take_ready(&mut self) -> Option<HeldPair> {
        self.pairing.take_ready().map(HeldPair)
    }

    /// Returns a pair to the library's pool.
    pub(crate) fn recycle(&mut self, held: HeldPair) {
        self.pairing.recycle(held.0);
    }

    /// `true` if the library wrote outside the given buffer or rejected a buffer.
    pub(crate) fn is_misplaced(&self) -> bool {
        self.misplaced
    }

    pub(crate) fn statistics(&self) -> PairingStatistics {
        self.pairing.statistics()
    }
}

impl HeldPair {
    /// Depth and colour images of the held pair.
    pub(crate) fn frame(&self) -> KinectFrame<'_> {
        let Pair { depth, video } = &self.0;
        KinectFrame {
            depth: Image {
                // SAFETY: the library got another buffer before this one was paired,
                // and gets it again only after `recycle` took this value.
                pixels: unsafe { depth.frame.pixels() },
                stamp_ticks: depth.stamp_ticks,
                arrived: depth.arrived,
            },
            video: Image {
                // SAFETY: as for depth.
                pixels: unsafe { video.frame.pixels() },
                stamp_ticks: video.stamp_ticks,
                arrived: video.arrived,
            },
        }
    }
}
