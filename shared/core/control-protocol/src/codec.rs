//! CBOR encoding of requests and replies.

use crate::printable_request::PrintableRequest;
use crate::{MAX_MESSAGE_BYTES, PROTOCOL_VERSION, Refusal, RefusalKind, Reply, Request};
use serde::Serialize;

/// Encodes a message; `None` when it is longer than the protocol allows.
pub fn encode<T: Serialize>(message: &T) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    ciborium::into_writer(message, &mut bytes).ok()?;
    (bytes.len() <= MAX_MESSAGE_BYTES).then_some(bytes)
}

/// Encodes a reply; one that is too long becomes a refusal.
pub fn encode_reply(reply: &Reply) -> Vec<u8> {
    encode(reply)
        .or_else(|| encode(&too_long()))
        .unwrap_or_default()
}

fn too_long() -> Reply {
    let sentence = "the answer is too long for one message; this is a fault of tabula";
    Reply::Refused(Refusal::new(RefusalKind::Internal, sentence))
}

/// Message of the control socket: the length (4 bytes, little-endian), then the bytes.
pub fn framed(bytes: &[u8]) -> Vec<u8> {
    let mut message = (bytes.len() as u32).to_le_bytes().to_vec();
    message.extend_from_slice(bytes);
    message
}

/// Decodes a request of this protocol version.
///
/// # Errors
/// A refusal for the sender, of other versions, unknown commands and unprintable texts.
pub fn decode_request(bytes: &[u8]) -> Result<Request, Refusal> {
    let request: Request = ciborium::from_reader(bytes).map_err(|error| {
        Refusal::new(
            RefusalKind::Version,
            format!(
                "the request is not understood ({error}); use the tabula of the daemon's version"
            ),
        )
    })?;
    if request.protocol == PROTOCOL_VERSION {
        return check_texts(bytes).map(|()| request);
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

/// Refuses control and invisible characters, which could forge a line of the history or of a log,
/// and rewrite a terminal.
fn check_texts(bytes: &[u8]) -> Result<(), Refusal> {
    match ciborium::from_reader::<PrintableRequest, _>(bytes) {
        Ok(PrintableRequest) => Ok(()),
        Err(ciborium::de::Error::Semantic(_, sentence)) => {
            Err(Refusal::new(RefusalKind::Invalid, sentence))
        }
        Err(error) => Err(Refusal::new(RefusalKind::Version, error.to_string())),
    }
}

/// Decodes a reply; invalid bytes become a refusal.
pub fn decode_reply(bytes: &[u8]) -> Reply {
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
    use crate::{
        Command, FactFilter, MAX_PAGE_EVENTS, MAX_PAGE_FACTS, MAX_PAGE_STEPS, MAX_PAGE_TASKS,
        MAX_PLAN_BYTES, MAX_STEP_REASON_BYTES, MAX_STEP_WORD_BYTES, MAX_TASK_PLAN_BYTES,
        MAX_TASK_STEPS, RecordedStep, WorldCommand, WorldReply,
    };
    use constraint::{Constraint, Finding, Findings, Reason, Ternary};
    use message::{
        ActorStamps, MAX_NEAR_CATEGORIES, MAX_REJECTED_CANDIDATES, MAX_SCENE_OBJECTS, NearCategory,
        RejectedCandidate, SceneObject, SceneSummary, Text,
    };
    use scene_document::{
        EventDocument, EventsDocument, FactDocument, FactsDocument, PlaceDocument, TaskDocument,
        TaskStepDocument, TasksDocument,
    };

    use std::collections::BTreeMap;

    #[test]
    fn requests_survive_and_other_versions_are_refused() {
        let command = Command::Ask { track_id: 3 };
        let bytes = encode(&Request::from(command.clone())).unwrap();
        assert_eq!(decode_request(&bytes), Ok(Request::from(command.clone())));
        let newer = Request {
            protocol: 99,
            ..Request::from(command)
        };
        let refusal = decode_request(&encode(&newer).unwrap()).unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::Version);
        assert!(decode_request(b"rubbish").is_err() && decode_request(b"").is_err());
    }

    #[test]
    fn control_characters_in_texts_are_refused() {
        let forget = |author: &str| Command::Forget {
            id: crate::MutationId(1),
            author: author.into(),
            category: "mug".into(),
        };
        let decoded = |command| decode_request(&encode(&Request::from(command)).unwrap());
        assert!(decoded(forget("Anna Müller")).is_ok());
        let refusal = decoded(forget("anna\n99 ben")).unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::Invalid);
        assert!(refusal.sentence.contains("U+000A"), "{refusal}");
    }

    /// Any bytes are a command or a refusal with a sentence, and a command survives its own
    /// encoding.
    #[test]
    fn fuzz_requests_and_replies() {
        let id = crate::MutationId(7);
        let commands = [
            Command::Objects,
            Command::Forget {
                id,
                author: "anna".into(),
                category: "mug".into(),
            },
            Command::World(WorldCommand::Facts(FactFilter::default())),
            Command::World(WorldCommand::RecordStep {
                task_id: 2,
                step: RecordedStep {
                    number: 1,
                    state: "held".into(),
                    primitive: "lift".into(),
                    label: Some("mug".into()),
                    attempt: 1,
                    ..RecordedStep::default()
                },
            }),
            Command::Arm(crate::ArmCommand::Move {
                lease: crate::ArmLease {
                    id: u64::MAX,
                    holder: "anna".into(),
                },
                motion: crate::ArmMotion::MoveJoints {
                    angles_rad: [0.5; 6],
                },
            }),
            Command::Job(crate::JobCommand::Write {
                job: 1,
                offset: 2,
                bytes: vec![1, 2, 3],
            }),
        ];
        let seeds: Vec<Vec<u8>> = commands
            .into_iter()
            .map(|command| encode(&Request::from(command)).unwrap())
            .collect();
        mutation_fuzzing::fuzz(&seeds, |bytes| {
            match decode_request(bytes) {
                Ok(command) => {
                    let again = encode(&command.clone()).unwrap();
                    // A number that is NaN equals nothing, so the texts are compared.
                    let decoded = decode_request(&again).unwrap();
                    assert_eq!(format!("{decoded:?}"), format!("{command:?}"));
                }
                Err(refusal) => assert!(refusal.sentence.contains(' ')),
            }
            // A reply of a hostile daemon.
            let _ = decode_reply(bytes);
        });
    }

    /// Object whose every number and text has its longest form.
    fn longest_object() -> SceneObject {
        let name = Text::truncated(&"x".repeat(64));
        let near = NearCategory {
            label: name,
            distance: 0.123_456_7,
            probability: 0.123_456_7,
        };
        SceneObject {
            track_id: u64::MAX,
            n_points: u32::MAX,
            n_views: u32::MAX,
            n_key_views: u32::MAX,
            n_sides: u32::MAX,
            view_id: u32::MAX,
            linked_to: u64::MAX,
            memory_sequence: u64::MAX,
            label: name,
            is_labelled: 1,
            n_categories: MAX_NEAR_CATEGORIES as u32,
            categories: [near; MAX_NEAR_CATEGORIES],
            mean_argb: u32::MAX,
            color_percents: std::array::from_fn(|term| if term < 11 { 9 } else { 0 }),
            distance: 0.123_456_7,
            probability: 0.123_456_7,
            position_covariance_m2: [1.234_567_8e-5; 6],
            rotation_covariance_rad2: [1.234_567_8e-5; 6],
            velocity_m_s: [0.123_456_7; 3],
            angular_velocity_rad_s: [0.123_456_7; 3],
            stamps: ActorStamps {
                asked_ns: u64::MAX,
                begun_ns: u64::MAX,
                described_ns: u64::MAX,
                recognised_ns: u64::MAX,
                answered_ns: u64::MAX,
            },
            ..SceneObject::default()
        }
    }

    /// All objects of a full scene fit into one message.
    #[test]
    fn the_longest_list_of_objects_fits() {
        let object = longest_object();
        let mut findings = Findings::default();
        for constraint in Constraint::ALL {
            let reason = Reason::Robot {
                share: 0.876_543_2,
                margin_m: 0.123_456_7,
            };
            let value = Ternary::Unknown;
            findings.set(constraint, Finding { value, reason });
        }
        let candidate = RejectedCandidate {
            decisive: u32::MAX,
            findings: RejectedCandidate::wire_findings(&findings),
            ..RejectedCandidate::default()
        };
        let scene = SceneSummary {
            n_objects_total: u32::MAX,
            n_rejected: u32::MAX,
            n_ignored: MAX_REJECTED_CANDIDATES as u32,
            ignored: [candidate; MAX_REJECTED_CANDIDATES],
            assumptions: u32::MAX,
            rule: Text::truncated(&"x".repeat(Text::CAPACITY)),
            source_name: Text::truncated(&"x".repeat(Text::CAPACITY)),
            ..SceneSummary::default()
        };
        let report = message::document::scene(&scene, &vec![object; MAX_SCENE_OBJECTS], u64::MAX);
        let bytes = encode(&Reply::Objects(Box::new(report.clone()))).unwrap();
        assert_eq!(decode_reply(&bytes), Reply::Objects(Box::new(report)));
    }

    fn longest_fact(name: &str) -> FactDocument {
        let place = PlaceDocument {
            position_m: [0.123_456_789; 3],
            orientation_xyzw: [0.123_456_789; 4],
            size_m: [0.123_456_789; 3],
        };
        FactDocument {
            fact: u64::MAX,
            subject: "object".into(),
            track_id: Some(u64::MAX),
            task_id: None,
            surface_id: None,
            property: "activity".into(),
            value: Some(name.to_owned()),
            answer: None,
            place: Some(place),
            start_ns: u64::MAX,
            end_ns: Some(u64::MAX),
        }
    }

    /// Step whose every number and text has its longest form, with a plan of some bytes.
    fn longest_step(plan_bytes: usize) -> TaskStepDocument {
        let word = "x".repeat(MAX_STEP_WORD_BYTES);
        TaskStepDocument {
            number: u64::MAX,
            state: "succeeded".into(),
            primitive: word.clone(),
            track_id: u64::MAX,
            label: Some(word.clone()),
            place: Some(word),
            attempt: u32::MAX,
            reason: "x".repeat(MAX_STEP_REASON_BYTES),
            plan: "x".repeat(plan_bytes),
            started_ns: u64::MAX,
            ended_ns: Some(u64::MAX),
        }
    }

    fn longest_task(steps: Vec<TaskStepDocument>) -> TaskDocument {
        TaskDocument {
            task_id: u64::MAX,
            kind: "x".repeat(64),
            parameters: "x".repeat(2048),
            author: "x".repeat(256),
            state: "succeeded".into(),
            started_ns: u64::MAX,
            ended_ns: Some(u64::MAX),
            reason: "x".repeat(2048),
            steps,
            ..TaskDocument::default()
        }
    }

    /// The task with the most steps and the longest plans fits, however the plans are spread.
    #[test]
    fn the_longest_task_fits() {
        let even = MAX_TASK_PLAN_BYTES / MAX_TASK_STEPS;
        let n_whole = MAX_TASK_PLAN_BYTES / MAX_PLAN_BYTES;
        let uneven = |index| if index < n_whole { MAX_PLAN_BYTES } else { 0 };
        let plan_bytes: [&dyn Fn(usize) -> usize; 2] = [&|_| even, &uneven];
        for plan_bytes in plan_bytes {
            let steps = (0..MAX_TASK_STEPS).map(|index| longest_step(plan_bytes(index)));
            let task = Box::new(longest_task(steps.collect()));
            let reply = Reply::World(WorldReply::Task(task));
            let bytes = encode(&reply).expect("it fits");
            assert_eq!(decode_reply(&bytes), reply);
        }
    }

    /// The longest pages of the working memory fit, too.
    #[test]
    fn the_longest_pages_of_the_world_fit() {
        let name = "x".repeat(128);
        let fact = longest_fact(&name);
        let event = EventDocument {
            sequence: u64::MAX,
            wall_ns: u64::MAX,
            event: "action_succeeded".into(),
            track_id: Some(u64::MAX),
            task_id: Some(u64::MAX),
            label: Some(name.clone()),
            task_kind: Some("x".repeat(64)),
            step: Some(u64::MAX),
            primitive: Some("x".repeat(MAX_STEP_WORD_BYTES)),
            reason: "x".repeat(2048),
            sentence: "x".repeat(2048 + 256),
            ..EventDocument::default()
        };
        let task = longest_task(vec![longest_step(0); MAX_PAGE_STEPS]);
        let next = Some(u64::MAX);
        let replies = [
            WorldReply::Facts(FactsDocument {
                facts: vec![fact; MAX_PAGE_FACTS],
                next,
            }),
            WorldReply::Events(EventsDocument {
                events: vec![event; MAX_PAGE_EVENTS],
                newest: u64::MAX,
            }),
            WorldReply::Tasks(TasksDocument {
                tasks: vec![task; MAX_PAGE_TASKS],
                next,
            }),
        ];
        for reply in replies {
            let reply = Reply::World(reply);
            let bytes = encode(&reply).expect("it fits");
            assert_eq!(decode_reply(&bytes), reply);
        }
    }

    /// A client may omit unused fields of a filter.
    #[test]
    fn empty_filter_requests_a_page_of_all_facts() {
        let words = BTreeMap::from([("track_id", 7)]);
        let facts = BTreeMap::from([("facts", words)]);
        let command = BTreeMap::from([("world", facts)]);
        let mut bytes = Vec::new();
        ciborium::into_writer(&command, &mut bytes).unwrap();
        let filter = FactFilter {
            track_id: Some(7),
            ..FactFilter::default()
        };
        let expected = Command::World(WorldCommand::Facts(filter));
        assert_eq!(
            ciborium::from_reader::<Command, _>(&*bytes).unwrap(),
            expected
        );
    }

    #[test]
    fn reply_that_is_too_long_becomes_a_refusal() {
        let long = Reply::Refused(Refusal::new(RefusalKind::Internal, "x".repeat(1_000_000)));
        assert_eq!(decode_reply(&encode_reply(&long)), too_long());
        assert!(matches!(decode_reply(b"\xff\x00"), Reply::Refused(_)));
    }
}
