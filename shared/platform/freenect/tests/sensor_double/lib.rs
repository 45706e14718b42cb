//! Test double of libfreenect: the same functions without a Kinect.
//!
//! The behaviour of a device is selected by the serial it is opened with (see
//! [`Scenario::of_serial`]); index 0 is a steady one, every other index does not exist. Frame
//! number n is filled with the value n, and the stamps of a pair are 100 000 ticks apart.

#![expect(unsafe_code, reason = "plays the part of a C library")]
#![expect(
    clippy::not_unsafe_ptr_arg_deref,
    reason = "the signatures are the C library's"
)]
#![expect(clippy::missing_panics_doc, reason = "a panic here is a failed test")]
#![expect(missing_docs, reason = "the functions are libfreenect's")]

use std::ffi::{CStr, CString, c_char, c_int, c_long, c_void};
use std::ptr;

const N_PIXELS: usize = 640 * 480;
const PERIOD_TICKS: u32 = 2_000_000;

type FrameCallback = extern "C" fn(*mut Device, *mut c_void, u32);
type LogCallback = extern "C" fn(*mut Context, c_int, *const c_char);

#[derive(Clone, Copy, PartialEq)]
enum Scenario {
    /// One pair of images per call.
    Steady,
    /// Camera unplugged after three pairs.
    Unplugged,
    /// Every second call is interrupted by a signal.
    Interrupted,
    /// Three pairs of images per call.
    Burst,
    /// Depth images only.
    Colourless,
    /// No frames at all.
    Silent,
    /// Frames in the library's own memory instead of the given buffer.
    Misplaced,
    /// Video stream that fails to start.
    NoVideo,
    /// Frame that arrives while the accelerometer is read.
    FrameDuringTilt,
    /// No motor: can only be opened as a camera.
    NoMotor,
}

impl Scenario {
    fn of_serial(serial: &[u8]) -> Option<Self> {
        Some(match serial {
            b"steady" => Self::Steady,
            b"unplugged" => Self::Unplugged,
            b"interrupted" => Self::Interrupted,
            b"burst" => Self::Burst,
            b"colourless" => Self::Colourless,
            b"silent" => Self::Silent,
            b"misplaced" => Self::Misplaced,
            b"no video" => Self::NoVideo,
            b"frame during tilt" => Self::FrameDuringTilt,
            b"no motor" => Self::NoMotor,
            _ => return None,
        })
    }
}

pub struct Context {
    log: Option<LogCallback>,
    parts: c_int,
    device: *mut Device,
}

#[repr(C)]
pub struct TiltState {
    accelerometer: [i16; 3],
    tilt_angle: i8,
    tilt_status: c_int,
}

pub struct Device {
    context: *mut Context,
    scenario: Scenario,
    depth_buffer: *mut u16,
    video_buffer: *mut u8,
    depth_callback: Option<FrameCallback>,
    video_callback: Option<FrameCallback>,
    depth_runs: bool,
    video_runs: bool,
    n_calls: u32,
    n_frames: u32,
    tilt: TiltState,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct FrameMode {
    reserved: u32,
    resolution: c_int,
    format: c_int,
    bytes: i32,
    size: [i16; 2],
    details: [i8; 4],
}

#[repr(C)]
pub struct TimeVal {
    seconds: c_long,
    microseconds: c_long,
}

#[repr(C)]
pub struct DeviceAttributes {
    next: *mut DeviceAttributes,
    camera_serial: *const c_char,
}

/// Context behind a pointer from `freenect_init`.
fn context<'a>(pointer: *mut Context) -> &'a mut Context {
    // SAFETY: the tests pass only pointers made by `freenect_init`, from one thread.
    unsafe { &mut *pointer }
}

/// Device behind a pointer from an open function.
fn device<'a>(pointer: *mut Device) -> &'a mut Device {
    // SAFETY: the tests pass only pointers made by `open`, from one thread.
    unsafe { &mut *pointer }
}

fn log(at: *mut Context, level: c_int, text: &CStr) {
    if let Some(log) = context(at).log {
        log(at, level, text.as_ptr());
    }
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_init(result: *mut *mut Context, _usb: *mut c_void) -> c_int {
    let made = Box::new(Context {
        log: None,
        parts: 3,
        device: ptr::null_mut(),
    });
    // SAFETY: the caller gives a place for the pointer.
    unsafe { *result = Box::into_raw(made) };
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_shutdown(at: *mut Context) -> c_int {
    assert!(
        context(at).device.is_null(),
        "shut down with an open device"
    );
    // SAFETY: made by `freenect_init`, not used again.
    drop(unsafe { Box::from_raw(at) });
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_set_log_level(_at: *mut Context, _level: c_int) {}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_set_log_callback(at: *mut Context, callback: LogCallback) {
    context(at).log = Some(callback);
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_num_devices(_at: *mut Context) -> c_int {
    1
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_select_subdevices(at: *mut Context, parts: c_int) {
    context(at).parts = parts;
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_list_device_attributes(
    _at: *mut Context,
    result: *mut *mut DeviceAttributes,
) -> c_int {
    let mut first = ptr::null_mut();
    for serial in [c"silent", c"steady"] {
        let camera_serial = CString::from(serial).into_raw();
        first = Box::into_raw(Box::new(DeviceAttributes {
            next: first,
            camera_serial,
        }));
    }
    // SAFETY: the caller gives a place for the pointer.
    unsafe { *result = first };
    2
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_free_device_attributes(mut entry: *mut DeviceAttributes) {
    while !entry.is_null() {
        // SAFETY: made by `freenect_list_device_attributes`, freed once.
        let owned = unsafe { Box::from_raw(entry) };
        // SAFETY: as above.
        drop(unsafe { CString::from_raw(owned.camera_serial.cast_mut()) });
        entry = owned.next;
    }
}

fn open(at: *mut Context, result: *mut *mut Device, scenario: Option<Scenario>) -> c_int {
    let with_motor = context(at).parts & 1 != 0;
    let scenario = scenario.filter(|s| !(*s == Scenario::NoMotor && with_motor));
    let Some(scenario) = scenario else {
        log(at, 1, c"Could not open camera: -3\n");
        return -1;
    };
    let made = Box::into_raw(Box::new(Device {
        context: at,
        scenario,
        depth_buffer: ptr::null_mut(),
        video_buffer: ptr::null_mut(),
        depth_callback: None,
        video_callback: None,
        depth_runs: false,
        video_runs: false,
        n_calls: 0,
        n_frames: 0,
        tilt: TiltState {
            accelerometer: [0; 3],
            tilt_angle: 0,
            tilt_status: 0,
        },
    }));
    context(at).device = made;
    // SAFETY: the caller gives a place for the pointer.
    unsafe { *result = made };
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_open_device(
    at: *mut Context,
    result: *mut *mut Device,
    index: c_int,
) -> c_int {
    open(at, result, (index == 0).then_some(Scenario::Steady))
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_open_device_by_camera_serial(
    at: *mut Context,
    result: *mut *mut Device,
    serial: *const c_char,
) -> c_int {
    // SAFETY: the caller gives a null-terminated text.
    let serial = unsafe { CStr::from_ptr(serial) };
    open(at, result, Scenario::of_serial(serial.to_bytes()))
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_close_device(at: *mut Device) -> c_int {
    assert!(
        !device(at).depth_runs && !device(at).video_runs,
        "closed while streaming"
    );
    context(device(at).context).device = ptr::null_mut();
    // SAFETY: made by `open`, not used again.
    drop(unsafe { Box::from_raw(at) });
    0
}

fn mode(bytes_per_pixel: i32) -> FrameMode {
    let bytes = bytes_per_pixel * N_PIXELS as i32;
    let details = [11, 5, 30, 1];
    FrameMode {
        reserved: 256,
        resolution: 1,
        format: 0,
        bytes,
        size: [640, 480],
        details,
    }
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_find_depth_mode(resolution: c_int, format: c_int) -> FrameMode {
    assert_eq!((resolution, format), (1, 0), "fakenect would abort");
    mode(2)
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_find_video_mode(resolution: c_int, format: c_int) -> FrameMode {
    assert_eq!((resolution, format), (1, 0), "fakenect would abort");
    mode(3)
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_set_depth_mode(_at: *mut Device, mode: FrameMode) -> c_int {
    if mode.reserved == 256 { 0 } else { -1 }
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_set_video_mode(_at: *mut Device, mode: FrameMode) -> c_int {
    if mode.reserved == 256 { 0 } else { -1 }
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_set_depth_buffer(at: *mut Device, buffer: *mut u16) -> c_int {
    device(at).depth_buffer = buffer;
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_set_video_buffer(at: *mut Device, buffer: *mut u8) -> c_int {
    device(at).video_buffer = buffer;
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_set_depth_callback(at: *mut Device, callback: FrameCallback) {
    device(at).depth_callback = Some(callback);
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_set_video_callback(at: *mut Device, callback: FrameCallback) {
    device(at).video_callback = Some(callback);
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_start_depth(at: *mut Device) -> c_int {
    device(at).depth_runs = true;
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_start_video(at: *mut Device) -> c_int {
    if device(at).scenario == Scenario::NoVideo {
        log(device(at).context, 1, c"send_cmd failed");
        return -1;
    }
    device(at).video_runs = true;
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_stop_depth(at: *mut Device) -> c_int {
    device(at).depth_runs = false;
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_stop_video(at: *mut Device) -> c_int {
    device(at).video_runs = false;
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_process_events_timeout(at: *mut Context, time: *mut TimeVal) -> c_int {
    let pointer = context(at).device;
    device(pointer).n_calls += 1;
    let n_calls = device(pointer).n_calls;
    match device(pointer).scenario {
        Scenario::Unplugged if n_calls > 3 => {
            log(at, 1, c"USB camera marked dead, stopping streams\n");
            device(pointer).depth_runs = false;
            device(pointer).video_runs = false;
            return -1;
        }
        Scenario::Interrupted if n_calls % 2 == 1 => return -10,
        Scenario::Silent => wait(time),
        Scenario::Burst => (0..3).for_each(|_| emit_pair(pointer)),
        Scenario::Colourless => emit_depth(pointer),
        _ => emit_pair(pointer),
    }
    0
}

fn wait(time: *const TimeVal) {
    // SAFETY: the caller gives a time.
    let time = unsafe { &*time };
    let microseconds = time.seconds * 1_000_000 + time.microseconds;
    std::thread::sleep(std::time::Duration::from_micros(microseconds as u64));
}

fn emit_pair(at: *mut Device) {
    emit_depth(at);
    emit_video(at);
}

/// Writes and announces the next depth frame.
fn emit_depth(at: *mut Device) {
    let it = device(at);
    it.n_frames += 1;
    let (number, callback) = (it.n_frames, it.depth_callback);
    let mut own = vec![
        0_u16;
        if it.scenario == Scenario::Misplaced {
            N_PIXELS
        } else {
            0
        }
    ];
    let buffer = if own.is_empty() {
        it.depth_buffer
    } else {
        own.as_mut_ptr()
    };
    // SAFETY: the caller handed over a buffer of this mode's size.
    unsafe { std::slice::from_raw_parts_mut(buffer, N_PIXELS) }.fill(number as u16);
    if let Some(callback) = callback {
        callback(at, buffer.cast(), number.wrapping_mul(PERIOD_TICKS));
    }
}

/// Writes and announces the colour frame of the last depth frame.
fn emit_video(at: *mut Device) {
    let it = device(at);
    let (number, callback, buffer) = (it.n_frames, it.video_callback, it.video_buffer);
    // SAFETY: the caller handed over a buffer of this mode's size.
    unsafe { std::slice::from_raw_parts_mut(buffer, 3 * N_PIXELS) }.fill(number as u8);
    if let Some(callback) = callback {
        callback(
            at,
            buffer.cast(),
            number.wrapping_mul(PERIOD_TICKS).wrapping_add(100_000),
        );
    }
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_update_tilt_state(at: *mut Device) -> c_int {
    // As in the real library, which does nothing and succeeds without a motor.
    if context(device(at).context).parts & 1 != 0 {
        device(at).tilt.accelerometer = [0, 819, -819];
    }
    if device(at).scenario == Scenario::FrameDuringTilt {
        emit_pair(at);
    }
    0
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_get_tilt_state(at: *mut Device) -> *mut TiltState {
    &raw mut device(at).tilt
}

#[unsafe(no_mangle)]
pub extern "C" fn freenect_set_flag(at: *mut Device, flag: c_int, _value: c_int) -> c_int {
    let known = flag == 1 << 14 || flag == 1 << 1;
    if known && device(at).scenario == Scenario::Steady {
        0
    } else {
        -1
    }
}
