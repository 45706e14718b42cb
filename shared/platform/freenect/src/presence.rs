//! Detection of a Kinect on USB and of this user's rights to it.
//!
//! Reads the kernel's tables without any library, to distinguish "not plugged in", "no power",
//! "no rights" and "not installed".

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::{fmt, iter};

/// USB vendor id of Microsoft.
const VENDOR: u16 = 0x045e;

/// Kind of USB device of a Kinect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UsbPartKind {
    /// Camera, the source of both images.
    Camera,
    /// Motor in the foot, with the accelerometer.
    Motor,
    /// Microphone array of the Kinect.
    Audio,
    /// Kinect v2, which libfreenect cannot use.
    SecondGeneration,
}

impl UsbPartKind {
    /// Kind by USB product id (`libfreenect`'s list and the USB ID repository).
    fn of_product(product: u16) -> Option<Self> {
        match product {
            // Xbox 360 Kinect; Kinect for Windows.
            0x02ae | 0x02bf => Some(Self::Camera),
            0x02b0 | 0x02c2 => Some(Self::Motor),
            // Before and after firmware upload, either model.
            0x02ad | 0x02bb | 0x02be | 0x02c3 => Some(Self::Audio),
            0x02c4 | 0x02d8 | 0x02d9 => Some(Self::SecondGeneration),
            _ => None,
        }
    }
}

/// Access of this user to a device node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// Device node is readable and writable.
    Granted,
    /// Device node denies permission.
    Denied,
    /// Device node that is missing or fails otherwise.
    Failed,
}

/// USB device of a Kinect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UsbPart {
    /// Kind of the Kinect's USB device.
    pub kind: UsbPartKind,
    /// USB product id of the device, of vendor 045e.
    pub product: u16,
    /// Device node.
    pub node: PathBuf,
    /// Access that this user has to the device node.
    pub access: Access,
}

/// Kinects found on USB. Its `Display` has one to three sentences with the state and the remedy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Presence {
    parts: Vec<UsbPart>,
    bus_is_visible: bool,
}

impl Presence {
    /// Scans this machine's USB bus. Each node is opened and closed again.
    pub fn scan() -> Self {
        Self::scan_in(Path::new("/sys/bus/usb/devices"), Path::new("/dev/bus/usb"))
    }

    /// Scans the given kernel table and device nodes.
    fn scan_in(table: &Path, nodes: &Path) -> Self {
        let Ok(entries) = fs::read_dir(table) else {
            return Self {
                parts: Vec::new(),
                bus_is_visible: false,
            };
        };
        let mut parts: Vec<UsbPart> = entries
            .flatten()
            .filter_map(|entry| part_of(&entry.path(), nodes))
            .collect();
        parts.sort_by(|a, b| a.node.cmp(&b.node));
        Self {
            parts,
            bus_is_visible: true,
        }
    }

    /// USB devices found, by bus address.
    pub fn parts(&self) -> &[UsbPart] {
        &self.parts
    }

    /// `true` if a camera is present and may be opened.
    pub fn is_usable(&self) -> bool {
        self.of_kind(UsbPartKind::Camera)
            .any(|part| part.access == Access::Granted)
    }

    fn of_kind(&self, kind: UsbPartKind) -> impl Iterator<Item = &UsbPart> {
        self.parts.iter().filter(move |part| part.kind == kind)
    }
}

/// Reads an entry of the kernel's table; `None` for other devices.
fn part_of(entry: &Path, nodes: &Path) -> Option<UsbPart> {
    let read = |name| fs::read_to_string(entry.join(name)).ok();
    let hexadecimal = |name| u16::from_str_radix(read(name)?.trim(), 16).ok();
    let decimal = |name| read(name)?.trim().parse::<u16>().ok();
    let product = hexadecimal("idProduct").filter(|_| hexadecimal("idVendor") == Some(VENDOR))?;
    let kind = UsbPartKind::of_product(product)?;
    let node = nodes.join(format!(
        "{:03}/{:03}",
        decimal("busnum")?,
        decimal("devnum")?
    ));
    let access = access_to(&node);
    Some(UsbPart {
        kind,
        product,
        node,
        access,
    })
}

fn access_to(node: &Path) -> Access {
    match File::options().read(true).write(true).open(node) {
        Ok(_) => Access::Granted,
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => Access::Denied,
        Err(_) => Access::Failed,
    }
}

impl fmt::Display for Presence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.bus_is_visible {
            return f.write_str(
                "the USB bus is not visible here (no /sys/bus/usb/devices); a container must be \
                 given /dev/bus/usb",
            );
        }
        let mut sentences = iter::once(self.camera_sentence())
            .chain(self.parts.iter().filter_map(rights_sentence))
            .chain(self.generation_sentence());
        sentences.try_fold("", |separator, sentence| {
            write!(f, "{separator}{sentence}").map(|()| "; ")
        })?;
        Ok(())
    }
}

impl Presence {
    fn camera_sentence(&self) -> String {
        let n_cameras = self.of_kind(UsbPartKind::Camera).count();
        if n_cameras > 0 {
            return format!("{n_cameras} Kinect camera(s) on USB");
        }
        if self.of_kind(UsbPartKind::Motor).next().is_some() {
            // The motor runs on USB power, everything else on the 12 V supply.
            return "a Kinect's motor is on USB but its camera is not: plug in the Kinect's own \
                    power supply"
                .to_owned();
        }
        "there is no Kinect on USB: check its USB plug and its own power supply".to_owned()
    }

    fn generation_sentence(&self) -> Option<String> {
        self.of_kind(UsbPartKind::SecondGeneration).next().map(|_| {
            "a Kinect v2 is plugged in, which libfreenect cannot use: use a Kinect v1".to_owned()
        })
    }
}

/// Sentence about missing rights to a required device.
fn rights_sentence(part: &UsbPart) -> Option<String> {
    let node = part.node.display();
    let needed = matches!(part.kind, UsbPartKind::Camera | UsbPartKind::Motor);
    match part.access {
        Access::Denied if needed => Some(format!(
            "this user may not open {node}: check the udev rule for 045e:{:04x}, put the user \
             into the group plugdev (sudo usermod -aG plugdev NAME), and log in again",
            part.product
        )),
        Access::Failed if needed => Some(format!(
            "{node} cannot be opened: unplug the Kinect and plug it in again"
        )),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
