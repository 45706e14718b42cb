//! Asking another process of the daemon.

use super::shared_memory::{IoxService, MAX_OPEN_REQUESTS, names_of, open};
use super::{CallError, codec};
use crate::Error;
use crate::domain::{Domain, Service};
use crate::wake::{Sleeper, Waker};
use iceoryx2::pending_response::PendingResponse;
use iceoryx2::prelude::{BackpressureStrategy, PortFactory as _};
use message::ProcessKind;
use message::control::{Command, MAX_MESSAGE_BYTES, Reply, Request};
use std::time::Duration;
use tokio::sync::Mutex;

type IoxClient = iceoryx2::port::client::Client<Service, [u8], (), [u8], ()>;
type IoxPending = PendingResponse<Service, [u8], (), [u8], ()>;

/// Wake-ups are a convenience: a reply is found even if its wake-up was lost.
const LOOK_AGAIN: Duration = Duration::from_millis(20);

/// Asks one process; one request at a time, others wait for their turn.
pub struct Client {
    port: Mutex<Port>,
    process: ProcessKind,
}

struct Port {
    client: IoxClient,
    requests: Waker,
    replies: Sleeper,
    service: IoxService,
    _domain: Domain,
}

impl Client {
    /// A client of the server in `process`, which need not be there yet; within a
    /// tokio runtime.
    ///
    /// # Errors
    /// When the process answers nothing, or shared memory fails.
    pub fn new(domain: &Domain, process: ProcessKind) -> Result<Self, Error> {
        let names =
            names_of(process).ok_or_else(|| Error::transport("ask", "control", process.name()))?;
        let service = open(domain, names.service)?;
        let client = service
            .client_builder()
            .initial_max_slice_len(names.message_bytes)
            .max_active_requests(MAX_OPEN_REQUESTS)
            .backpressure_strategy(BackpressureStrategy::DiscardData)
            .create()
            .map_err(|e| Error::transport("make a client of", names.service, e))?;
        let port = Port {
            client,
            requests: Waker::new(domain, names.service)?,
            replies: Sleeper::new(domain, names.replies)?,
            service,
            _domain: domain.clone(),
        };
        Ok(Self {
            port: Mutex::new(port),
            process,
        })
    }

    /// Asks, and waits for the reply at most until the deadline.
    ///
    /// # Errors
    /// When nobody answers, or not in time.
    pub async fn call(&self, command: Command, deadline: Duration) -> Result<Reply, CallError> {
        let bytes = codec::encode(&Request::from(command)).ok_or_else(|| {
            CallError::Refused(format!(
                "a request may have at most {MAX_MESSAGE_BYTES} bytes"
            ))
        })?;
        let answered = async {
            let port = self.port.lock().await;
            let pending = self.send(&port, &bytes)?;
            self.reply(&port, pending).await
        };
        match tokio::time::timeout(deadline, answered).await {
            Ok(reply) => reply,
            Err(_) => Err(CallError::TimedOut { after: deadline }),
        }
    }

    fn send(&self, port: &Port, bytes: &[u8]) -> Result<IoxPending, CallError> {
        let not_there = CallError::NotThere {
            process: self.process.name(),
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

    async fn reply(&self, port: &Port, pending: IoxPending) -> Result<Reply, CallError> {
        loop {
            // Connected is asked first: a reply may come between the two questions.
            let is_connected = pending.is_connected();
            match pending.receive() {
                Ok(Some(response)) => return Ok(codec::decode_reply(response.payload())),
                Ok(None) if is_connected => {}
                _ => {
                    return Err(CallError::NotThere {
                        process: self.process.name(),
                    });
                }
            }
            let _ = tokio::time::timeout(LOOK_AGAIN, port.replies.woken()).await;
        }
    }
}
