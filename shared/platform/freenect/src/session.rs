//! Owned context and device of the C library.
//!
//! Each method is one library call. Both values stay on the thread that made them: libfreenect
//! does not lock its state, and its callbacks run on the calling thread.

#![expect(unsafe_code, reason = "every method calls a C function")]

use crate::raw::{self, Api, DeviceAttributes, FrameMode, TiltState, TimeVal};
use crate::{Error, Library, Selector, callbacks, messages};
use std::ffi::{CStr, CString, c_int};
use std::ptr;
use std::sync::Arc;
use std::time::Duration;

/// Initialised library: a USB context, shut down on drop.
pub(crate) struct Context {
    library: Arc<Library>,
    pointer: *mut raw::Context,
}

/// Open Kinect; dropping it stops its streams and closes it.
pub(crate) struct Device {
    context: Context,
    pointer: *mut raw::Device,
}

/// Converts a negative return code of the library into an error.
fn checked(function: &'static str, code: c_int) -> Result<c_int, Error> {
    if code < 0 {
        let said = messages::take_as_clause();
        return Err(Error::CallFailed {
            function,
            code,
            said,
        });
    }
    Ok(code)
}

impl Context {
    /// Initialises libfreenect.
    pub(crate) fn new(library: Arc<Library>) -> Result<Self, Error> {
        let api = *library.api();
        let mut pointer = ptr::null_mut();
        // SAFETY: `pointer` may be written; a null USB context asks for an own one.
        let code = unsafe { (api.init)(&raw mut pointer, ptr::null_mut()) };
        if code < 0 || pointer.is_null() {
            return Err(Error::UsbUnavailable { code });
        }
        let context = Self { library, pointer };
        // SAFETY: the context is open.
        unsafe { (api.set_log_level)(context.pointer, raw::LOG_WARNING) };
        // SAFETY: the context is open; the callback is a plain function that never unwinds.
        unsafe { (api.set_log_callback)(context.pointer, messages::on_message) };
        Ok(context)
    }

    pub(crate) fn n_devices(&self) -> Result<c_int, Error> {
        // SAFETY: the context is open.
        checked("freenect_num_devices", unsafe {
            (self.api().num_devices)(self.pointer)
        })
    }

    /// Opens the selected Kinect, with its accelerometer if it has one.
    ///
    /// # Errors
    /// Error code of the library, with the context for another attempt.
    pub(crate) fn open(self, selector: &Selector) -> Result<Device, (Self, c_int)> {
        let parts = [raw::DEVICE_CAMERA | raw::DEVICE_MOTOR, raw::DEVICE_CAMERA];
        let mut last_code = -1;
        // Some models have no motor of their own, and opening fails if it is requested.
        for parts in parts {
            // SAFETY: the context is open.
            unsafe { (self.api().select_subdevices)(self.pointer, parts) };
            match self.open_parts(selector) {
                Ok(pointer) => {
                    return Ok(Device {
                        context: self,
                        pointer,
                    });
                }
                Err(code) => last_code = code,
            }
        }
        Err((self, last_code))
    }

    fn open_parts(&self, selector: &Selector) -> Result<*mut raw::Device, c_int> {
        let mut device = ptr::null_mut();
        let code = match selector {
            Selector::Index(index) => {
                let index = c_int::try_from(*index).unwrap_or(c_int::MAX);
                // SAFETY: the context is open and `device` may be written.
                unsafe { (self.api().open_device)(self.pointer, &raw mut device, index) }
            }
            Selector::Serial(serial) => {
                let serial = CString::new(serial.as_str()).map_err(|_| -1)?;
                let open = self.api().open_device_by_camera_serial;
                // SAFETY: the context is open, `device` may be written, and the
                // serial is null-terminated and lives during the call.
                unsafe { open(self.pointer, &raw mut device, serial.as_ptr()) }
            }
        };
        if code < 0 || device.is_null() {
            Err(code)
        } else {
            Ok(device)
        }
    }

    /// Serial numbers of all readable cameras; empty if the library cannot list them.
    pub(crate) fn serials(&self) -> Vec<String> {
        let api = self.api();
        let (Some(list), Some(free)) = (api.list_device_attributes, api.free_device_attributes)
        else {
            return Vec::new();
        };
        let mut first: *mut DeviceAttributes = ptr::null_mut();
        // SAFETY: the context is open and `first` may be written.
        let code = unsafe { list(self.pointer, &raw mut first) };
        let serials = if code < 0 {
            Vec::new()
        } else {
            serials_of(first)
        };
        if !first.is_null() {
            // SAFETY: the list came from this library and is freed once.
            unsafe { free(first) };
        }
        serials
    }

    fn api(&self) -> &Api {
        self.library.api()
    }
}

/// Copies the serial numbers out of the library's linked list.
fn serials_of(mut entry: *const DeviceAttributes) -> Vec<String> {
    let mut serials = Vec::new();
    // SAFETY: each entry is null or a live one of the library's list.
    while let Some(attributes) = unsafe { entry.as_ref() } {
        if !attributes.camera_serial.is_null() {
            // SAFETY: a serial is a null-terminated text that lives as long as its entry.
            let serial = unsafe { CStr::from_ptr(attributes.camera_serial) };
            serials.push(serial.to_string_lossy().into_owned());
        }
        entry = attributes.next;
    }
    serials
}

impl Drop for Context {
    fn drop(&mut self) {
        // SAFETY: the context is open, its device is closed, and it is not used again.
        // What it returns is always 0.
        let _ = unsafe { (self.api().shutdown)(self.pointer) };
    }
}

impl Device {
    pub(crate) fn pointer(&self) -> *mut raw::Device {
        self.pointer
    }

    pub(crate) fn library(&self) -> &Library {
        &self.context.library
    }

    /// Selects 11-bit depth and RGB, both 640x480.
    pub(crate) fn choose_modes(&self) -> Result<(), Error> {
        let api = self.api();
        // SAFETY: takes two numbers; these are among the modes fakenect knows too.
        let depth = unsafe { (api.find_depth_mode)(raw::RESOLUTION_MEDIUM, raw::DEPTH_11BIT) };
        // SAFETY: as above.
        let video = unsafe { (api.find_video_mode)(raw::RESOLUTION_MEDIUM, raw::VIDEO_RGB) };
        let fitting = |stream, mode: FrameMode, n_bytes| {
            if mode.fills(n_bytes) {
                Ok(mode)
            } else {
                Err(Error::ModeMissing { stream })
            }
        };
        let depth = fitting("depth", depth, raw::DEPTH_BYTES)?;
        let video = fitting("video", video, raw::VIDEO_BYTES)?;
        // SAFETY: the device is open and the mode came from the library.
        let code = unsafe { (api.set_depth_mode)(self.pointer, depth) };
        checked("freenect_set_depth_mode", code)?;
        // SAFETY: the device is open and the mode came from the library.
        let code = unsafe { (api.set_video_mode)(self.pointer, video) };
        checked("freenect_set_video_mode", code)?;
        Ok(())
    }

    /// Registers the frame callbacks with libfreenect.
    pub(crate) fn set_callbacks(&self) {
        // SAFETY: the device is open; the callback is a plain function that never unwinds.
        unsafe { (self.api().set_depth_callback)(self.pointer, callbacks::on_depth) };
        // SAFETY: as above.
        unsafe { (self.api().set_video_callback)(self.pointer, callbacks::on_video) };
    }

    pub(crate) fn start_streams(&self) -> Result<(), Error> {
        // SAFETY: the device is open, its mode is chosen, its buffer outlives the stream.
        checked("freenect_start_depth", unsafe {
            (self.api().start_depth)(self.pointer)
        })?;
        // SAFETY: as above.
        checked("freenect_start_video", unsafe {
            (self.api().start_video)(self.pointer)
        })?;
        Ok(())
    }

    /// Runs the library's event loop for up to `timeout`; callbacks run inside this call. Returns
    /// the library's code, 0 for success.
    pub(crate) fn process_events(&self, timeout: Duration) -> c_int {
        let mut timeout = TimeVal {
            seconds: timeout.as_secs().min(3600) as std::ffi::c_long,
            microseconds: timeout.subsec_micros() as std::ffi::c_long,
        };
        let process_events = self.api().process_events_timeout;
        // SAFETY: the context is open and the time-out may be read.
        unsafe { process_events(self.context.pointer, &raw mut timeout) }
    }

    /// Reads the accelerometer; blocks for one USB transfer.
    pub(crate) fn tilt_state(&self) -> Result<Option<TiltState>, Error> {
        // SAFETY: the device is open.
        let code = unsafe { (self.api().update_tilt_state)(self.pointer) };
        checked("freenect_update_tilt_state", code)?;
        // SAFETY: the device is open.
        let state = unsafe { (self.api().get_tilt_state)(self.pointer) };
        // SAFETY: the state is null or part of the open device; no call runs meanwhile.
        Ok(unsafe { state.as_ref() }.copied())
    }

    /// Sets a camera feature; `None` if the library does not support features.
    pub(crate) fn set_flag(&self, flag: c_int, on: bool) -> Option<Result<(), Error>> {
        let set_flag = self.api().set_flag?;
        // SAFETY: the device is open.
        let code = unsafe { set_flag(self.pointer, flag, c_int::from(on)) };
        Some(checked("freenect_set_flag", code).map(|_| ()))
    }

    fn api(&self) -> &Api {
        self.context.api()
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // Stopping what never started, or a Kinect that is gone, only returns a
        // code, and there is nothing left to do about it.
        // SAFETY: the device is open.
        let _ = unsafe { (self.api().stop_video)(self.pointer) };
        // SAFETY: the device is open.
        let _ = unsafe { (self.api().stop_depth)(self.pointer) };
        // SAFETY: the device is open and is not used again.
        let _ = unsafe { (self.api().close_device)(self.pointer) };
    }
}
