//! Answering requests of the daemon's own processes.

use super::shared_memory::{IoxService, names_of, open};
use super::{Handler, codec};
use crate::domain::{Domain, Service};
use crate::wake::{Sleeper, Waker};
use crate::{Error, control::CallError};
use iceoryx2::active_request::ActiveRequest;
use iceoryx2::prelude::BackpressureStrategy;
use message::ProcessKind;
use message::control::Reply;
use std::sync::Arc;

type IoxServer = iceoryx2::port::server::Server<Service, [u8], (), [u8], ()>;
type IoxRequest = ActiveRequest<Service, [u8], (), [u8], ()>;

/// Answers the commands of one process.
pub struct Server {
    port: IoxServer,
    sleeper: Sleeper,
    replies: Arc<Waker>,
    handler: Handler,
    _service: IoxService,
    _domain: Domain,
}

impl Server {
    /// A server; within a tokio runtime.
    ///
    /// # Errors
    /// When the process answers nothing, or shared memory fails.
    pub fn new(domain: &Domain, process: ProcessKind, handler: Handler) -> Result<Self, Error> {
        let names = names_of(process)
            .ok_or_else(|| Error::transport("serve", "control", process.name()))?;
        let service = open(domain, names.service)?;
        let server = service
            .server_builder()
            .initial_max_slice_len(names.message_bytes)
            .max_loaned_responses_per_request(1)
            .backpressure_strategy(BackpressureStrategy::DiscardData)
            .create()
            .map_err(|e| Error::transport("make a server of", names.service, e))?;
        Ok(Self {
            port: server,
            sleeper: Sleeper::new(domain, names.service)?,
            replies: Arc::new(Waker::new(domain, names.replies)?),
            handler,
            _service: service,
            _domain: domain.clone(),
        })
    }

    /// Answers until the future is dropped; each request in a task of its own.
    pub async fn run(self) {
        loop {
            while let Ok(Some(request)) = self.port.receive() {
                let answer = answer(request, self.handler.clone(), self.replies.clone());
                tokio::spawn(answer);
            }
            self.sleeper.woken().await;
        }
    }
}

async fn answer(request: IoxRequest, handler: Handler, replies: Arc<Waker>) {
    let command = codec::decode_request(request.payload());
    let reply = match command {
        Ok(command) => handler(command).await,
        Err(refusal) => Reply::Refused(refusal),
    };
    if let Err(error) = respond(&request, &reply) {
        tracing::warn!("a reply was lost: {error}; its client will time out and may ask again");
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
