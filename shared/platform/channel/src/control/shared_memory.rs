//! The request-response services of a domain.

use crate::Error;
use crate::domain::{Domain, Service};
use crate::reservation::Reservation;
use iceoryx2::prelude::ServiceName;
use iceoryx2::service::port_factory::request_response::PortFactory;
use message::ProcessKind;
use message::control::MAX_MESSAGE_BYTES;
use message::service_name;

pub(super) type IoxService = PortFactory<Service, [u8], (), [u8], ()>;

/// Processes that may ask one server at a time.
const MAX_CLIENTS: usize = 6;
/// Requests a client may have open: the one it waits for, and one whose time was
/// over and that the server still works on.
pub(super) const MAX_OPEN_REQUESTS: usize = 2;

/// A command to the arm or its report: numbers and a sentence.
const ARM_MESSAGE_BYTES: usize = 16 * 1024;

/// One server: the service's name, and the names of the events that wake the
/// server and its clients.
#[derive(Debug, Clone, Copy)]
pub(super) struct Names {
    pub(super) service: &'static str,
    pub(super) replies: &'static str,
    /// Longest request or reply, bytes; memory is reserved for it many times over.
    pub(super) message_bytes: usize,
}

/// Names of the server in a process; `None` for a process that answers nothing.
pub(super) fn names_of(process: ProcessKind) -> Option<Names> {
    match process {
        ProcessKind::Memory => Some(Names {
            service: service_name::CONTROL_MEMORY,
            replies: "control/memory/replies",
            message_bytes: MAX_MESSAGE_BYTES,
        }),
        ProcessKind::Perception => Some(Names {
            service: service_name::CONTROL_PERCEPTION,
            replies: "control/perception/replies",
            message_bytes: MAX_MESSAGE_BYTES,
        }),
        ProcessKind::Simulator => Some(Names {
            service: service_name::CONTROL_ARM,
            replies: "arm/command/replies",
            message_bytes: ARM_MESSAGE_BYTES,
        }),
        ProcessKind::Camera => None,
    }
}

/// Opens a service, and makes it when it is not there. Overflow is off on both
/// sides: a full queue is an error the caller sees, never a lost request.
pub(super) fn open(domain: &Domain, name: &'static str) -> Result<IoxService, Error> {
    let service_name: ServiceName = name
        .try_into()
        .map_err(|e| Error::transport("name", name, e))?;
    domain
        .node()
        .service_builder(&service_name)
        .request_response::<[u8], [u8]>()
        .enable_safe_overflow_for_requests(false)
        .enable_safe_overflow_for_responses(false)
        .enable_fire_and_forget_requests(false)
        .max_active_requests_per_client(MAX_OPEN_REQUESTS)
        .max_loaned_requests(1)
        .max_response_buffer_size(1)
        .max_borrowed_responses_per_pending_response(1)
        .max_servers(1)
        .max_clients(MAX_CLIENTS)
        .max_nodes(MAX_CLIENTS + 1)
        .open_or_create()
        .map_err(|e| Error::transport("open", name, e))
}

/// Slots of the requests and replies of all servers. Messages are mostly short
/// and memory is touched only where written, but the sum must count them all.
pub(crate) fn reservations() -> Vec<Reservation> {
    let of_server = |process| {
        let Names {
            service,
            message_bytes,
            ..
        } = names_of(process)?;
        let requests = MAX_CLIENTS * (MAX_OPEN_REQUESTS + 2);
        let replies = MAX_CLIENTS * MAX_OPEN_REQUESTS * 3;
        Some(Reservation {
            service,
            slots: (requests + replies) as u64,
            slot_bytes: message_bytes as u64 + 128,
        })
    };
    ProcessKind::ALL.into_iter().filter_map(of_server).collect()
}
