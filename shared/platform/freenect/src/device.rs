//! A Kinect as a safe value.

use crate::callbacks::{Registration, Shown, Sink};
use crate::messages::{self, Message};
use crate::recording::check_recording;
use crate::restart::FOLDER_VARIABLE;
use crate::session::{Context, Device};
use crate::{Acceleration, Error, Library, LibraryKind, Presence, Statistics, raw};
use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use std::{env, fmt};

/// `LIBUSB_ERROR_INTERRUPTED`: a signal came; nothing is lost.
const INTERRUPTED: i32 = -10;

/// Which of several Kinects.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Selector {
    /// By its place on the bus, from 0; may change when devices are replugged.
    Index(u32),
    /// By the serial of its camera, which stays.
    Serial(String),
}

impl fmt::Display for Selector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Index(index) => write!(f, "index {index}"),
            Self::Serial(serial) => write!(f, "serial {serial}"),
        }
    }
}

/// One image of 640x480 pixels, row by row.
#[derive(Debug, Clone, Copy)]
pub struct Image<'a, T> {
    /// Depth: one 11-bit raw value a pixel, 2047 for none. Colour: red, green,
    /// blue a pixel.
    pub pixels: &'a [T],
    /// The Kinect's stamp, ticks of 1/60 000 000 s; wraps about every 71.6 s.
    pub stamp_ticks: u32,
    /// When the image was complete in this process, monotonic.
    pub arrived: Instant,
}

/// A depth and a colour image of the same moment (see [`crate::PAIRING_WINDOW_TICKS`]).
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// Depth, raw.
    pub depth: Image<'a, u16>,
    /// Colour.
    pub video: Image<'a, u8>,
}

/// An open, streaming Kinect, or fakenect playing a recording.
///
/// It stays on the thread that opened it, because libfreenect calls back on
/// whatever thread calls it and locks nothing. Dropping it stops the streams,
/// closes the device and shuts the library's USB context down; then it can be
/// opened again. Memory: about 9 MB, all of it allocated when it is opened.
pub struct Kinect {
    // Dropped in this order: the device first, so that the library has stopped
    // writing when the images go.
    device: Device,
    _registration: Registration,
    sink: Rc<RefCell<Sink>>,
    shown: Option<Shown>,
    end: Option<End>,
    _playing: Option<Playing>,
}

impl fmt::Debug for Kinect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Kinect")
            .field("statistics", &self.statistics())
            .finish_non_exhaustive()
    }
}

/// Why no more frames come.
#[derive(Debug, Clone)]
enum End {
    Gone { code: i32, said: String },
    Ended,
    Misbehaved,
}

impl Kinect {
    /// Opens a Kinect and starts both its streams.
    ///
    /// With fakenect, the recording named by the environment is checked first
    /// (see [`crate::check_recording`]); the selector means nothing to it.
    ///
    /// # Errors
    /// When there is none, it can not be opened or started, or the recording is
    /// faulty; each says what to check.
    pub fn open(library: Arc<Library>, selector: &Selector) -> Result<Self, Error> {
        let playing = (library.kind() == LibraryKind::Fake)
            .then(Playing::start)
            .transpose()?;
        // What was said before belongs to another camera.
        messages::take();
        let device = open_device(library, selector)?;
        let sink = Sink::new(device.library().api());
        device.choose_modes()?;
        if !sink.hand_over_first_buffers(device.pointer()) {
            return Err(Error::Misbehaved);
        }
        let sink = Rc::new(RefCell::new(sink));
        let registration = Registration::new(device.pointer(), Rc::clone(&sink));
        let kinect = Self {
            device,
            _registration: registration,
            sink,
            shown: None,
            end: None,
            _playing: playing,
        };
        kinect.device.set_callbacks();
        kinect.device.start_streams()?;
        Ok(kinect)
    }

    /// The newest pair of images not yet handed out, waiting for one up to
    /// `timeout`; `None` when none came in that time.
    ///
    /// The images stay valid until the next call. Fakenect ignores the time-out:
    /// it may keep the call until the recording's next entry is due.
    ///
    /// # Errors
    /// [`Error::Gone`] when the Kinect was unplugged, [`Error::Ended`] at the end
    /// of a recording, [`Error::Misbehaved`]; from then on always the same.
    pub fn next_frame(&mut self, timeout: Duration) -> Result<Option<Frame<'_>>, Error> {
        let start = Instant::now();
        let mut polled = false;
        loop {
            if self.show_ready() {
                return Ok(self.shown.as_ref().map(Shown::frame));
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

    /// Reads the accelerometer; `None` when the Kinect has none, or the recording
    /// has not come to a reading. Blocks for one exchange over USB, and may be
    /// called between frames.
    ///
    /// # Errors
    /// When the exchange fails.
    pub fn acceleration(&mut self) -> Result<Option<Acceleration>, Error> {
        Ok(self
            .device
            .tilt_state()?
            .as_ref()
            .and_then(Acceleration::of_tilt_state))
    }

    /// Switches the camera's automatic exposure and white balance on or off, so
    /// that an object keeps its colours while the light does. Returns whether
    /// this library can; fakenect can not.
    ///
    /// # Errors
    /// When the Kinect refuses.
    pub fn set_automatic_colors(&mut self, on: bool) -> Result<bool, Error> {
        for flag in [raw::FLAG_AUTO_EXPOSURE, raw::FLAG_AUTO_WHITE_BALANCE] {
            match self.device.set_flag(flag, on) {
                Some(result) => result?,
                None => return Ok(false),
            }
        }
        Ok(true)
    }

    /// What became of the frames so far.
    pub fn statistics(&self) -> Statistics {
        self.sink.borrow().statistics()
    }

    /// What the library said since the last call, oldest first, at most 64 lines;
    /// for the caller to log. Errors carry their own part of it.
    pub fn take_messages(&mut self) -> Vec<Message> {
        messages::take()
    }

    /// Lets the library work, and notes when it can no more.
    fn process_events(&mut self, timeout: Duration) {
        let code = self.device.process_events(timeout);
        if self.sink.borrow().is_misplaced() {
            self.end = Some(End::Misbehaved);
        } else if code != 0 && code != INTERRUPTED {
            self.end = Some(match self.device.library().kind() {
                LibraryKind::Fake => End::Ended,
                LibraryKind::Real => End::Gone {
                    code,
                    said: messages::take_as_clause(),
                },
            });
        }
    }

    /// Shows the newest pair, if there is one, and frees the one shown before.
    fn show_ready(&mut self) -> bool {
        let mut sink = self.sink.borrow_mut();
        let Some(ready) = sink.take_ready() else {
            return false;
        };
        if let Some(old) = self.shown.replace(ready) {
            sink.give_back(old);
        }
        true
    }
}

impl End {
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

/// The right to play a recording. Fakenect keeps its state in plain variables
/// of the library, so that two players in one process would share it.
struct Playing;

static PLAYING: AtomicBool = AtomicBool::new(false);

impl Playing {
    /// Checks the recording named by the environment, and that nobody else plays.
    fn start() -> Result<Self, Error> {
        let folder = env::var_os(FOLDER_VARIABLE).ok_or(Error::NoRecording)?;
        check_recording(Path::new(&folder))?;
        if PLAYING.swap(true, Ordering::Acquire) {
            return Err(Error::FakeInUse);
        }
        Ok(Self)
    }
}

impl Drop for Playing {
    fn drop(&mut self) {
        PLAYING.store(false, Ordering::Release);
    }
}
