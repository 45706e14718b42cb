//! Parameters of the request-response services: names, limits, message sizes.

use crate::reservation::{Reservation, SLOT_OVERHEAD_BYTES};
use message::control::MAX_MESSAGE_BYTES;
use message::{ProcessKind, service_name};

/// Largest number of clients of one server.
pub(crate) const MAX_CLIENTS: usize = 6;
/// Open requests of one client: the one it waits for, and one that has timed out and
/// that the server still works on.
pub(crate) const MAX_OPEN_REQUESTS: usize = 2;

/// Longest request to the arm or its report: numbers and a sentence.
const ARM_MESSAGE_BYTES: usize = 16 * 1024;

/// Request-response service: its name, and the event that wakes its clients.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RequestService {
    pub(crate) name: &'static str,
    pub(crate) replies: &'static str,
    /// Longest request or reply, bytes; memory is reserved for it many times over.
    pub(crate) message_bytes: usize,
}

/// Service of the server in a process; `None` for a process without a server.
pub(crate) fn request_service(process: ProcessKind) -> Option<RequestService> {
    match process {
        ProcessKind::Memory => Some(RequestService {
            name: service_name::CONTROL_MEMORY,
            replies: "control/memory/replies",
            message_bytes: MAX_MESSAGE_BYTES,
        }),
        ProcessKind::Perception => Some(RequestService {
            name: service_name::CONTROL_PERCEPTION,
            replies: "control/perception/replies",
            message_bytes: MAX_MESSAGE_BYTES,
        }),
        ProcessKind::Simulator => Some(RequestService {
            name: service_name::CONTROL_ARM,
            replies: "arm/command/replies",
            message_bytes: ARM_MESSAGE_BYTES,
        }),
        ProcessKind::Camera => None,
    }
}

/// Reservations of the requests and replies of all servers.
pub(crate) fn reservations() -> Vec<Reservation> {
    let of_server = |process| {
        let RequestService {
            name,
            message_bytes,
            ..
        } = request_service(process)?;
        let requests = MAX_CLIENTS * (MAX_OPEN_REQUESTS + 2);
        let replies = MAX_CLIENTS * MAX_OPEN_REQUESTS * 3;
        Some(Reservation {
            service: name,
            slots: (requests + replies) as u64,
            slot_bytes: message_bytes as u64 + SLOT_OVERHEAD_BYTES,
        })
    };
    ProcessKind::ALL.into_iter().filter_map(of_server).collect()
}
