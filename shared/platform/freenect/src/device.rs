//! Safe handle of an open Kinect.

use crate::callbacks::{FrameSink, HeldPair, SinkRegistration};
use crate::frame::KinectFrame;
use crate::messages::{self, LogMessage};
use crate::recording::check_recording;
use crate::restart::FOLDER_VARIABLE;
use crate::selector::Selector;
use crate::session::{Context, Device};
use crate::{Acceleration, Error, Library, LibraryKind, PairingStatistics, Presence, raw};
use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use std::{env, fmt};

/// `LIBUSB_ERROR_INTERRUPTED`: interrupted by a signal; no data was lost.
const INTERRUPTED: i32 = -10;

/// Open, streaming Kinect, or fakenect playing a recording.
///
/// Bound to the thread that opened it, because libfreenect calls back on the calling thread and
/// locks nothing. Dropping it stops the streams, closes the device and shuts down the library's
/// USB context; then it can be opened again. Memory: about 9 MB, all allocated when it is opened.
pub struct Kinect {
    // Fields are dropped in this order: the device first, so that the library has stopped writing
    // when the images are freed.
    device: Device,
    _registration: SinkRegistration,
    sink: Rc<RefCell<FrameSink>>,
    held: Option<HeldPair>,
    end: Option<StreamEnd>,
    _playing: Option<PlaybackLock>,
}

impl fmt::Debug for Kinect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Kinect")
            .field("statistics", &self.statistics())
            .finish_non_exhaustive()
    }
}

/// Reason for the end of the stream.
#[derive(Debug, Clone)]
enum StreamEnd {
    Gone { code: i32, said: String },
    Ended,
    Misbehaved,
}

impl Kinect {
    /// Opens a Kinect and starts both its streams.
    ///
    /// With fakenect, the recording named by the environment is checked first (see
    /// [`crate::check_recording`]), and the selector is ignored.
    ///
    /// # Errors
    /// If there is no Kinect, it cannot be opened or started, or the recording is faulty; each
    /// error names the remedy.
    pub fn open(library: Arc<Library>, selector: &Selector) -> Result<Self, Error> {
        let playback = (library.kind() == LibraryKind::Fake)
            .then(PlaybackLock::start)
            .transpose()?;
        // Earlier messages belong to another camera.
        messages::take();
        let device = open_device(library, selector)?;
        let sink = FrameSink::new(device.library().api());
        device.choose_modes()?;
        if !sink.hand_over_first_buffers(device.pointer()) {
            return Err(Error::Misbehaved);
        }
        let sink = Rc::new(RefCell::new(sink));
        let registration = SinkRegistration::new(device.pointer(), Rc::clone(&sink));
        let kinect = Self {
            device,
            _registration: registration,
            sink,
            held: None,
            end: None,
            _playing: playback,
        };
        kinect.device.set_callbacks();
        kinect.device.start_streams()?;
        Ok(kinect)
    }

    /// Newest pair of images not yet returned; waits for one up to `timeout` and returns `None`
    /// when it elapses.
    ///
    /// The images stay valid until the next call. Fakenect ignores the time-out: it
    /// may block until the recording's next entry is due.
    ///
    /// # Errors
    /// [`Error::Gone`] when the Kinect was unplugged, [`Error::Ended`] at the end
    /// of a recording, [`Error::Misbehaved`]; from then on always the same.
    pub fn next_frame(&mut self, timeout: Duration) -> Result<Option<KinectFrame<'_>>, Error> {
        let start = Instant::now();
        let mut polled = false;
        loop {
            if self.take_newest() {
                return Ok(self.held.as_ref().map(HeldPair::frame));
            }
            if let Some(end) = &self.end {
                return Err(end.clone().into_error());
            }
            let left = timeout.saturating_sub(start.elapsed());
            if polled && left.is_zero() {
                return Ok(None);
            }
            self.process_events(left);
            polled = true;
        }
    }

    /// Pair of images that [`next_frame`](Self::next_frame) returned last; `None` before the first.
    pub fn last_frame(&self) -> Option<KinectFrame<'_>> {
        self.held.as_ref().map(HeldPair::frame)
    }

    /// Reads the accelerometer. `None` if the Kinect has none, or the recording has no reading
    /// yet. Blocks for one USB transfer; may be called between frames.
    ///
    /// # Errors
    /// If the transfer fails.
    pub fn acceleration(&mut self) -> Result<Option<Acceleration>, Error> {
        Ok(self
            .device
            .tilt_state()?
            .as_ref()
            .and_then(Acceleration::of_tilt_state))
    }

    /// Switches the camera's automatic exposure and white balance on or off, so that an object
    /// keeps its colours under constant light. Returns `false` if the library does not support
    /// it, as fakenect.
    ///
    /// # Errors
    /// If the Kinect rejects the request.
    pub fn set_automatic_colors(&mut self, on: bool) -> Result<bool, Error> {
        for flag in [raw::FLAG_AUTO_EXPOSURE, raw::FLAG_AUTO_WHITE_BALANCE] {
            match self.device.set_flag(flag, on) {
                Some(result) => result?,
                None => return Ok(false),
            }
        }
        Ok(true)
    }

    /// Counts of paired and unpaired frames so far.
    pub fn statistics(&self) -> PairingStatistics {
        self.sink.borrow().statistics()
    }

    /// Log messages of the library since the last call, oldest first, at most 64 lines. Errors
    /// contain their own messages.
    pub fn take_messages(&mut self) -> Vec<LogMessage> {
        messages::take()
    }

    /// Runs the library's event loop once and records the end of the stream.
    fn process_events(&mut self, timeout: Duration) {
        let code = self.device.process_events(timeout);
        if self.sink.borrow().is_misplaced() {
            self.end = Some(StreamEnd::Misbehaved);
        } else if code != 0 && code != INTERRUPTED {
            self.end = Some(match self.device.library().kind() {
                LibraryKind::Fake => StreamEnd::Ended,
                LibraryKind::Real => StreamEnd::Gone {
                    code,
                    said: messages::take_as_clause(),
                },
            });
        }
    }

    /// Takes the newest pair, if any, and returns the previous one to the pool.
    fn take_newest(&mut self) -> bool {
        let mut sink = self.sink.borrow_mut();
        let Some(ready) = sink.take_ready() else {
            return false;
        };
        if let Some(old) = self.held.replace(ready) {
            sink.recycle(old);
        }
        true
    }
}

impl StreamEnd {
    fn into_error(self) -> Error {
        match self {
            Self::Gone { code, said } => Error::Gone { code, said },
            Self::Ended => Error::Ended,
            Self::Misbehaved => Error::Misbehaved,
        }
    }
}

fn open_device(library: Arc<Library>, selector: &Selector) -> Result<Device, Error> {
    let context = Context::new(library)?;
    if context.n_devices()? == 0 {
        return Err(Error::NoKinect {
            advice: Presence::scan().to_string(),
        });
    }
    context
        .open(selector)
        .map_err(|(context, code)| Error::CannotOpen {
            wanted: selector.to_string(),
            code,
            said: messages::take_as_clause(),
            serials: context.serials(),
            advice: Presence::scan().to_string(),
        })
}

/// Exclusive right of this process to play a recording: fakenect keeps its state in global
/// variables, which two players would share.
struct PlaybackLock;

static IS_PLAYING: AtomicBool = AtomicBool::new(false);

impl PlaybackLock {
    /// Checks the recording named by the environment and that no other player is active.
    fn start() -> Result<Self, Error> {
        let folder = env::var_os(FOLDER_VARIABLE).ok_or(Error::NoRecording)?;
        check_recording(Path::new(&folder))?;
        if IS_PLAYING.swap(true, Ordering::Acquire) {
            return Err(Error::FakeInUse);
        }
        Ok(Self)
    }
}

impl Drop for PlaybackLock {
    fn drop(&mut self) {
        IS_PLAYING.store(false, Ordering::Release);
    }
}
