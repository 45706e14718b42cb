//! Foreign function interface of libfreenect 0.5: types, constants and function pointers.
//!
//! Written from the facts of `libfreenect.h` 0.5.3. C enumerations are plain integers here,
//! because an unexpected value must not be undefined behaviour on our side.

#![expect(
    unsafe_code,
    reason = "function pointers of a C library are looked up by name"
)]

use std::ffi::{c_char, c_int, c_long, c_void};

/// Number of columns of both images.
pub const WIDTH: usize = 640;
/// Number of rows of both images.
pub const HEIGHT: usize = 480;
/// Number of pixels of either image.
pub const N_PIXELS: usize = WIDTH * HEIGHT;

/// Bytes of a depth image: one little-endian `u16` a pixel.
pub(crate) const DEPTH_BYTES: usize = N_PIXELS * 2;
/// Bytes of a colour image: red, green, blue.
pub(crate) const VIDEO_BYTES: usize = N_PIXELS * 3;

/// `FREENECT_RESOLUTION_MEDIUM`, 640x480.
pub(crate) const RESOLUTION_MEDIUM: c_int = 1;
/// `FREENECT_DEPTH_11BIT`, unpacked to 16 bits a pixel.
pub(crate) const DEPTH_11BIT: c_int = 0;
/// `FREENECT_VIDEO_RGB`, demosaiced by the library.
pub(crate) const VIDEO_RGB: c_int = 0;
/// `FREENECT_DEVICE_MOTOR`, which also holds the accelerometer.
pub(crate) const DEVICE_MOTOR: c_int = 1;
/// `FREENECT_DEVICE_CAMERA`.
pub(crate) const DEVICE_CAMERA: c_int = 2;
/// `FREENECT_LOG_WARNING`: messages up to this level are kept.
pub(crate) const LOG_WARNING: c_int = 2;
/// `FREENECT_AUTO_EXPOSURE`.
pub(crate) const FLAG_AUTO_EXPOSURE: c_int = 1 << 14;
/// `FREENECT_AUTO_WHITE_BALANCE`.
pub(crate) const FLAG_AUTO_WHITE_BALANCE: c_int = 1 << 1;

/// Opaque USB context of the library; only used behind a pointer.
#[repr(C)]
pub(crate) struct Context {
    _opaque: [u8; 0],
}

/// Opaque device of the library; only used behind a pointer. With fakenect the pointer is the
/// number 1234.
#[repr(C)]
pub(crate) struct Device {
    _opaque: [u8; 0],
}

/// `freenect_frame_mode`: format of a stream. Passed and returned by value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub(crate) struct FrameMode {
    reserved: u32,
    resolution: c_int,
    format: c_int,
    pub(crate) bytes: i32,
    pub(crate) width: i16,
    pub(crate) height: i16,
    data_bits_per_pixel: i8,
    padding_bits_per_pixel: i8,
    framerate: i8,
    pub(crate) is_valid: i8,
}

/// `freenect_raw_tilt_state`: the accelerometer in counts, 819 per g.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub(crate) struct TiltState {
    pub(crate) accelerometer_x: i16,
    pub(crate) accelerometer_y: i16,
    pub(crate) accelerometer_z: i16,
    tilt_angle: i8,
    tilt_status: c_int,
}

/// `struct freenect_device_attributes`: one entry of the list of serials.
#[repr(C)]
pub(crate) struct DeviceAttributes {
    pub(crate) next: *mut DeviceAttributes,
    pub(crate) camera_serial: *const c_char,
}

/// C structure `struct timeval` of Linux.
#[repr(C)]
pub(crate) struct TimeVal {
    pub(crate) seconds: c_long,
    pub(crate) microseconds: c_long,
}

// The layout is a contract with the C compiler that built the library.
const _: () = {
    assert!(size_of::<FrameMode>() == 24 && align_of::<FrameMode>() == 4);
    assert!(std::mem::offset_of!(FrameMode, bytes) == 12);
    assert!(std::mem::offset_of!(FrameMode, width) == 16);
    assert!(std::mem::offset_of!(FrameMode, is_valid) == 23);
    assert!(size_of::<TiltState>() == 12 && align_of::<TiltState>() == 4);
    assert!(std::mem::offset_of!(TiltState, tilt_angle) == 6);
    assert!(std::mem::offset_of!(TiltState, tilt_status) == 8);
    assert!(size_of::<DeviceAttributes>() == 2 * size_of::<*const ()>());
    assert!(size_of::<TimeVal>() == 2 * size_of::<c_long>());
};

/// `freenect_depth_cb` and `freenect_video_cb`: device, pixels, device stamp.
pub(crate) type FrameCallback = extern "C" fn(*mut Device, *mut c_void, u32);
/// `freenect_log_cb`: context, level, text.
pub(crate) type LogCallback = extern "C" fn(*mut Context, c_int, *const c_char);

/// Declares [`Api`] and its look-up: each field is the C function
/// `freenect_<field>` with the signature written here.
macro_rules! api {
    (
        required { $($required:ident: fn($($argument:ty),*) $(-> $result:ty)?;)* }
        optional { $($optional:ident: fn($($optional_argument:ty),*) $(-> $optional_result:ty)?;)* }
    ) => {
        /// Functions of a loaded library; valid as long as it stays loaded.
        #[derive(Clone, Copy)]
        pub(crate) struct Api {
            $(pub(crate) $required: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
            $(pub(crate) $optional:
                Option<unsafe extern "C" fn($($optional_argument),*) $(-> $optional_result)?>,)*
        }

        impl Api {
            /// Looks up all library functions by name.
            ///
            /// # Errors
            /// The name of the first required function the library lacks, with
            /// the loader's reason.
            ///
            /// # Safety
            /// The library's functions of these names must have the signatures
            /// of libfreenect 0.5.
            pub(crate) unsafe fn look_up(
                library: &libloading::Library,
            ) -> Result<Self, (&'static str, libloading::Error)> {
                Ok(Self {
                    $($required: {
                        let name = concat!("freenect_", stringify!($required));
                        // SAFETY: the caller vouches for the signature.
                        let found = unsafe { library.get(name) };
                        *found.map_err(|error| (name, error))?
                    },)*
                    $($optional: {
                        let name = concat!("freenect_", stringify!($optional));
                        // SAFETY: the caller vouches for the signature.
                        let found = unsafe { library.get(name) };
                        found.ok().map(|symbol| *symbol)
                    },)*
                })
            }

            /// Optional functions with their availability.
            pub(crate) fn optional_symbols(&self) -> Vec<(&'static str, bool)> {
                vec![$((concat!("freenect_", stringify!($optional)), self.$optional.is_some()),)*]
            }
        }
    };
}

api! {
    required {
        init: fn(*mut *mut Context, *mut c_void) -> c_int;
        shutdown: fn(*mut Context) -> c_int;
        set_log_level: fn(*mut Context, c_int);
        set_log_callback: fn(*mut Context, LogCallback);
        num_devices: fn(*mut Context) -> c_int;
        select_subdevices: fn(*mut Context, c_int);
        open_device: fn(*mut Context, *mut *mut Device, c_int) -> c_int;
        open_device_by_camera_serial: fn(*mut Context, *mut *mut Device, *const c_char) -> c_int;
        close_device: fn(*mut Device) -> c_int;
        find_depth_mode: fn(c_int, c_int) -> FrameMode;
        find_video_mode: fn(c_int, c_int) -> FrameMode;
        set_depth_mode: fn(*mut Device, FrameMode) -> c_int;
        set_video_mode: fn(*mut Device, FrameMode) -> c_int;
        set_depth_buffer: fn(*mut Device, *mut c_void) -> c_int;
        set_video_buffer: fn(*mut Device, *mut c_void) -> c_int;
        set_depth_callback: fn(*mut Device, FrameCallback);
        set_video_callback: fn(*mut Device, FrameCallback);
        start_depth: fn(*mut Device) -> c_int;
        start_video: fn(*mut Device) -> c_int;
        stop_depth: fn(*mut Device) -> c_int;
        stop_video: fn(*mut Device) -> c_int;
        process_events_timeout: fn(*mut Context, *mut TimeVal) -> c_int;
        update_tilt_state: fn(*mut Device) -> c_int;
        get_tilt_state: fn(*mut Device) -> *mut TiltState;
    }
    optional {
        set_flag: fn(*mut Device, c_int, c_int) -> c_int;
        list_device_attributes: fn(*mut Context, *mut *mut DeviceAttributes) -> c_int;
        free_device_attributes: fn(*mut DeviceAttributes);
    }
}

impl FrameMode {
    /// `true` if a 640x480 frame of this mode has exactly `n_bytes` bytes, so that it fits the
    /// buffers passed to the library.
    pub(crate) fn fills(&self, n_bytes: usize) -> bool {
        self.is_valid != 0
            && usize::try_from(self.bytes) == Ok(n_bytes)
            && usize::try_from(self.width) == Ok(WIDTH)
            && usize::try_from(self.height) == Ok(HEIGHT)
    }
}
