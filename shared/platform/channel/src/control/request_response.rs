//! Opening of request-response services.

use crate::Error;
use crate::domain::{Domain, Service};
use crate::request_services::{MAX_CLIENTS, MAX_OPEN_REQUESTS};
use iceoryx2::prelude::ServiceName;
use iceoryx2::service::port_factory::request_response::PortFactory;

pub(super) type IoxService = PortFactory<Service, [u8], (), [u8], ()>;

/// Opens a request-response service, or creates it. Overflow is off on both sides: a
/// full queue is an error for the caller, never a lost request.
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
