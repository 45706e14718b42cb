//! Request client over shared memory, for processes of the daemon.

use super::request_response::{IoxService, open};
use super::{CallError, codec};
use crate::Error;
use crate::domain::{Domain, Service};
use crate::request_services::{MAX_OPEN_REQUESTS, request_service};
use crate::segment_backing::back_segment;
use crate::wake_event::{WakeListener, WakeNotifier};
use iceoryx2::pending_response::PendingResponse;
use iceoryx2::prelude::{BackpressureStrategy, PortFactory as _};
use message::ProcessKind;
use message::control::{Command, MAX_MESSAGE_BYTES, Reply, Request};
use std::time::Duration;
use tokio::sync::Mutex;

type IoxClient = iceoryx2::port::client::Client<Service, [u8], (), [u8], ()>;
type IoxPending = PendingResponse<Service, [u8], (), [u8], ()>;

/// Polling period while waiting for a reply: a reply is found even if its wake-up was
/// lost.
const LOOK_AGAIN: Duration = Duration::from_millis(20);

/// Client of one process: sends one request at a time; further calls wait for their
/// turn.
pub struct Client {
    port: Mutex<Port>,
    process: ProcessKind,
}

struct Port {
    client: IoxClient,
    requests: WakeNotifier,
    replies: WakeListener,
    service: IoxService,
    /// Requests whose caller no longer waits, and that the server may still work on.
    unanswered: Vec<IoxPending>,
    _domain: Domain,
}

impl Port {
    /// Waits until the server may get another request.
    async fn room(&mut self) {
        loop {
            self.unanswered.retain(|pending| {
                // Connected is checked first: a reply may arrive between the two checks.
                pending.is_connected() && matches!(pending.receive(), Ok(None))
            });
            if self.unanswered.len() < MAX_OPEN_REQUESTS {
                return;
            }
            let _ = tokio::time::timeout(LOOK_AGAIN, self.replies.woken()).await;
        }
    }
}

impl Client {
    /// Creates a client of the server in `process`, which may start later; within a
    /// tokio runtime.
    ///
    /// # Errors
    /// When the process has no server, or shared memory fails.
    pub fn new(domain: &Domain, process: ProcessKind) -> Result<Self, Error> {
        let parameters = request_service(process)
            .ok_or_else(|| Error::transport("ask", "control", process.word()))?;
        let service = open(domain, parameters.name)?;
        let client = service
            .client_builder()
            .initial_max_slice_len(parameters.message_bytes)
            .max_active_requests(MAX_OPEN_REQUESTS)
            .backpressure_strategy(BackpressureStrategy::DiscardData)
            .create()
            .map_err(|e| Error::transport("make a client of", parameters.name, e))?;
        back_segment(domain.name(), parameters.name, client.id().value())?;
        let port = Port {
            client,
            requests: WakeNotifier::new(domain, parameters.name)?,
            replies: WakeListener::new(domain, parameters.replies)?,
            service,
            unanswered: Vec::with_capacity(MAX_OPEN_REQUESTS),
            _domain: domain.clone(),
        };
        Ok(Self {
            port: Mutex::new(port),
            process,
        })
    }

    /// Sends a request and waits for the reply at most for the time limit. May be dropped at any
    /// time; the server still gets no more requests at once than it takes.
    ///
    /// # Errors
    /// When the process does not run, or does not answer in time.
    pub async fn call(&self, command: Command, deadline: Duration) -> Result<Reply, CallError> {
        let bytes = codec::encode(&Request::from(command)).ok_or_else(|| {
            CallError::Refused(format!(
                "a request may have at most {MAX_MESSAGE_BYTES} bytes"
            ))
        })?;
        let answered = async {
            let mut port = self.port.lock().await;
            port.room().await;
            let pending = self.send(&port, &bytes)?;
            port.unanswered.push(pending);
            self.last_reply(&mut port).await
        };
        match tokio::time::timeout(deadline, answered).await {
            Ok(reply) => reply,
            Err(_) => Err(CallError::TimedOut { after: deadline }),
        }
    }

    fn send(&self, port: &Port, bytes: &[u8]) -> Result<IoxPending, CallError> {
        let not_there = CallError::NotThere {
            process: self.process.word(),
        };
        if port.service.dynamic_config().number_of_servers() == 0 {
            return Err(not_there);
        }
        let failed = |cause: &dyn std::fmt::Debug| {
            CallError::Refused(format!("the request could not be sent: {cause:?}"))
        };
        let request = port
            .client
            .loan_slice_uninit(bytes.len())
            .map_err(|e| failed(&e))?;
        let pending = request
            .write_from_slice(bytes)
            .send()
            .map_err(|e| failed(&e))?;
        if pending.number_of_server_connections() == 0 {
            return Err(not_there);
        }
        port.requests.wake();
        Ok(pending)
    }

    /// Waits for the reply to the last request.
    async fn last_reply(&self, port: &mut Port) -> Result<Reply, CallError> {
        loop {
            if let Some(reply) = self.take_last_reply(port) {
                return reply;
            }
            let _ = tokio::time::timeout(LOOK_AGAIN, port.replies.woken()).await;
        }
    }

    /// Reply to the last request, or the error that there will be none; `None` before either.
    fn take_last_reply(&self, port: &mut Port) -> Option<Result<Reply, CallError>> {
        let pending = port.unanswered.last()?;
        // Connected is checked first: a reply may arrive between the two checks.
        let is_connected = pending.is_connected();
        let reply = match pending.receive() {
            Ok(Some(response)) => Ok(codec::decode_reply(response.payload())),
            Ok(None) if is_connected => return None,
            _ => Err(CallError::NotThere {
                process: self.process.word(),
            }),
        };
        port.unanswered.pop();
        Some(reply)
    }
}
