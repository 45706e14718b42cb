//! Request server over shared memory, for processes of the daemon.

use super::request_response::{IoxService, open};
use super::{Handler, Peer, codec};
use crate::domain::{Domain, Service};
use crate::request_services::request_service;
use crate::segment_backing::back_segment;
use crate::wake_event::{WakeListener, WakeNotifier};
use crate::{Error, control::CallError};
use iceoryx2::active_request::ActiveRequest;
use iceoryx2::prelude::BackpressureStrategy;
use message::ProcessKind;
use message::control::Reply;
use std::sync::Arc;

type IoxServer = iceoryx2::port::server::Server<Service, [u8], (), [u8], ()>;
type IoxRequest = ActiveRequest<Service, [u8], (), [u8], ()>;

/// Control server: answers one process's commands.
pub struct Server {
    port: IoxServer,
    listener: WakeListener,
    replies: Arc<WakeNotifier>,
    handler: Handler,
    _service: IoxService,
    _domain: Domain,
}

impl Server {
    /// Creates a server; within a tokio runtime.
    ///
    /// # Errors
    /// When the process has no service, or shared memory fails.
    pub fn new(domain: &Domain, process: ProcessKind, handler: Handler) -> Result<Self, Error> {
        let parameters = request_service(process)
            .ok_or_else(|| Error::transport("serve", "control", process.word()))?;
        let service = open(domain, parameters.name)?;
        let server = service
            .server_builder()
            .initial_max_slice_len(parameters.message_bytes)
            .max_loaned_responses_per_request(1)
            .backpressure_strategy(BackpressureStrategy::DiscardData)
            .create()
            .map_err(|e| Error::transport("make a server of", parameters.name, e))?;
        back_segment(domain.name(), parameters.name, server.id().value())?;
        Ok(Self {
            port: server,
            listener: WakeListener::new(domain, parameters.name)?,
            replies: Arc::new(WakeNotifier::new(domain, parameters.replies)?),
            handler,
            _service: service,
            _domain: domain.clone(),
        })
    }

    /// Serves until the future is dropped; each request in a separate task.
    pub async fn run(self) {
        loop {
            while let Ok(Some(request)) = self.port.receive() {
                let answer = answer(request, self.handler.clone(), self.replies.clone());
                tokio::spawn(answer);
            }
            self.listener.woken().await;
        }
    }
}

async fn answer(request: IoxRequest, handler: Handler, replies: Arc<WakeNotifier>) {
    let command = codec::decode_request(request.payload());
    let reply = match command {
        // Only this user's processes may open the shared memory.
        Ok(command) => handler(command, Peer::own()).await,
        Err(refusal) => Reply::Refused(refusal),
    };
    if let Err(error) = respond(&request, &reply) {
        tracing::warn!(
            "a reply was lost: {error}; its client will time out and may repeat the request"
        );
    }
    drop(request);
    replies.wake();
}

fn respond(request: &IoxRequest, reply: &Reply) -> Result<(), CallError> {
    let bytes = codec::encode_reply(reply);
    let lost = |cause: &dyn std::fmt::Debug| CallError::Refused(format!("{cause:?}"));
    let response = request
        .loan_slice_uninit(bytes.len())
        .map_err(|e| lost(&e))?;
    response
        .write_from_slice(&bytes)
        .send()
        .map_err(|e| lost(&e))
}
