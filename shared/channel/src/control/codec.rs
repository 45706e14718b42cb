//! Bytes of requests and replies.

use message::control::{
    Command, MAX_MESSAGE_BYTES, PROTOCOL_VERSION, Refusal, RefusalKind, Reply, Request,
};
use serde::Serialize;

/// Encodes; `None` when the message is longer than the protocol allows.
pub(super) fn encode<T: Serialize>(message: &T) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    ciborium::into_writer(message, &mut bytes).ok()?;
    (bytes.len() <= MAX_MESSAGE_BYTES).then_some(bytes)
}

/// Encodes a reply; one that is too long becomes a refusal that says so.
pub(super) fn encode_reply(reply: &Reply) -> Vec<u8> {
    encode(reply)
        .or_else(|| encode(&too_long()))
        .unwrap_or_default()
}

fn too_long() -> Reply {
    let sentence = "the answer is too long for one message; this is a fault of tabula";
    Reply::Refused(Refusal::new(RefusalKind::Internal, sentence))
}

/// Decodes a request of this protocol version.
pub(super) fn decode_request(bytes: &[u8]) -> Result<Command, Refusal> {
    let request: Request = ciborium::from_reader(bytes).map_err(|error| {
        Refusal::new(
            RefusalKind::Version,
            format!(
                "the request is not understood ({error}); use the tabula of the daemon's version"
            ),
        )
    })?;
    if request.protocol == PROTOCOL_VERSION {
        return Ok(request.command);
    }
    Err(Refusal::new(
        RefusalKind::Version,
        format!(
            "the request has protocol version {}, the daemon speaks {PROTOCOL_VERSION}; \
             use the tabula of the daemon's version",
            request.protocol
        ),
    ))
}

/// Decodes a reply; what is no reply becomes a refusal.
pub(super) fn decode_reply(bytes: &[u8]) -> Reply {
    ciborium::from_reader(bytes).unwrap_or_else(|error| {
        Reply::Refused(Refusal::new(
            RefusalKind::Version,
            format!(
                "the daemon's answer is not understood ({error}); use the tabula of its version"
            ),
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_survive_and_other_versions_are_refused() {
        let command = Command::Ask { track_id: 3 };
        let bytes = encode(&Request::from(command.clone())).unwrap();
        assert_eq!(decode_request(&bytes), Ok(command.clone()));
        let newer = Request {
            protocol: 99,
            command,
        };
        let refusal = decode_request(&encode(&newer).unwrap()).unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::Version);
        assert!(decode_request(b"rubbish").is_err() && decode_request(b"").is_err());
    }

    #[test]
    fn too_long_a_reply_becomes_a_refusal() {
        let long = Reply::Refused(Refusal::new(RefusalKind::Internal, "x".repeat(1_000_000)));
        assert_eq!(decode_reply(&encode_reply(&long)), too_long());
        assert!(matches!(decode_reply(b"\xff\x00"), Reply::Refused(_)));
    }
}
