//! Printability check of a request: none of its texts may hold a control or invisible character.
//!
//! The check walks through the CBOR data item whatever command it is, so that no author, category,
//! kind, reason or name of a later command is forgotten.

use serde::de::{Deserialize, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt;
use unicode_text::is_unprintable;

/// Data item whose texts are all printable; keeps nothing of it.
pub(super) struct PrintableRequest;

impl<'de> Deserialize<'de> for PrintableRequest {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Walk)
    }
}

struct Walk;

impl<'de> Visitor<'de> for Walk {
    type Value = PrintableRequest;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a request")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<PrintableRequest, E> {
        match text.chars().find(|c| is_unprintable(*c)) {
            None => Ok(PrintableRequest),
            Some(c) => Err(E::custom(format!(
                "a text of the request contains the control or invisible character U+{:04X}; \
                 remove it",
                u32::from(c)
            ))),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<PrintableRequest, A::Error> {
        while items.next_element::<PrintableRequest>()?.is_some() {}
        Ok(PrintableRequest)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<PrintableRequest, A::Error> {
        while entries
            .next_entry::<PrintableRequest, PrintableRequest>()?
            .is_some()
        {}
        Ok(PrintableRequest)
    }

    fn visit_some<D: Deserializer<'de>>(self, inner: D) -> Result<PrintableRequest, D::Error> {
        PrintableRequest::deserialize(inner)
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(
        self,
        inner: D,
    ) -> Result<PrintableRequest, D::Error> {
        PrintableRequest::deserialize(inner)
    }

    fn visit_bool<E>(self, _: bool) -> Result<PrintableRequest, E> {
        Ok(PrintableRequest)
    }

    fn visit_i64<E>(self, _: i64) -> Result<PrintableRequest, E> {
        Ok(PrintableRequest)
    }

    fn visit_i128<E>(self, _: i128) -> Result<PrintableRequest, E> {
        Ok(PrintableRequest)
    }

    fn visit_u64<E>(self, _: u64) -> Result<PrintableRequest, E> {
        Ok(PrintableRequest)
    }

    fn visit_u128<E>(self, _: u128) -> Result<PrintableRequest, E> {
        Ok(PrintableRequest)
    }

    fn visit_f64<E>(self, _: f64) -> Result<PrintableRequest, E> {
        Ok(PrintableRequest)
    }

    fn visit_bytes<E>(self, _: &[u8]) -> Result<PrintableRequest, E> {
        Ok(PrintableRequest)
    }

    fn visit_none<E>(self) -> Result<PrintableRequest, E> {
        Ok(PrintableRequest)
    }

    fn visit_unit<E>(self) -> Result<PrintableRequest, E> {
        Ok(PrintableRequest)
    }

    /// A tagged item, which no command has.
    fn visit_enum<A: serde::de::EnumAccess<'de>>(
        self,
        tagged: A,
    ) -> Result<PrintableRequest, A::Error> {
        tagged.variant::<IgnoredAny>()?;
        Err(A::Error::custom("a request has no tagged items"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, MutationId, RecordedStep, Request, WorldCommand};
    use std::collections::BTreeMap;

    fn check(item: &impl serde::Serialize) -> Result<(), String> {
        let mut bytes = Vec::new();
        ciborium::into_writer(item, &mut bytes).unwrap();
        let checked = ciborium::from_reader::<PrintableRequest, _>(&*bytes);
        checked.map(|_| ()).map_err(|error| error.to_string())
    }

    #[test]
    fn requests_with_printable_texts_pass() {
        let task = WorldCommand::StartTask {
            id: MutationId(u128::MAX),
            kind: "clear".into(),
            parameters: r#"{"table": 1, "Tasse": "für Ben 杯子"}"#.into(),
            author: "anna".into(),
        };
        check(&Request::from(Command::World(task))).unwrap();
        check(&Request::from(Command::Memory(
            crate::MemoryQuery::History { from: None, max: 3 },
        )))
        .unwrap();
        check(&(1.5, -3, true, None::<u8>, [0_u8; 3])).unwrap();
    }

    #[test]
    fn control_characters_are_found_wherever_they_are() {
        let esc = "a\u{1b}[2J";
        let nested = BTreeMap::from([("a", vec![("b", Some(esc))])]);
        for refused in [
            check(&esc),
            check(&nested),
            check(&BTreeMap::from([(esc, 1)])),
            check(&"line\nfeed"),
            check(&"right to left \u{202e}"),
        ] {
            assert!(refused.unwrap_err().contains("character U+"));
        }
    }

    #[test]
    fn texts_of_a_step_are_checked() {
        let step = |reason: &str, plan: &str| {
            let step = RecordedStep {
                reason: reason.into(),
                plan: plan.into(),
                ..RecordedStep::default()
            };
            check(&Request::from(Command::World(WorldCommand::RecordStep {
                task_id: 1,
                step,
            })))
        };
        step("sie rutschte", r#"{"grasp": [0.5, -1e-3]}"#).unwrap();
        step("", "{\n}").unwrap_err();
        step("\u{1b}[2J", "{}").unwrap_err();
    }

    #[test]
    fn bytes_are_no_text() {
        check(&serde_bytes::Bytes::new(b"\x1b[2J\n")).unwrap();
    }
}
