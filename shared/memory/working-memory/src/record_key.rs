//! Database keys of the working memory: a table letter and a big-endian number, so that byte order
//! equals semantic order.

/// Database key of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum RecordKey {
    /// Metadata record: `m`.
    Meta,
    /// Robot record: `r`.
    Robot,
    /// Object record: `o`, track-id.
    Object(u64),
    /// Fact record: `f`, number.
    Fact(u64),
    /// Event record: `e`, sequence number.
    Event(u64),
    /// Task record: `t`, number.
    Task(u64),
    /// Surface record: `s`, number.
    Surface(u64),
}

impl RecordKey {
    pub(crate) fn key(self) -> Vec<u8> {
        let (table, number) = match self {
            Self::Meta => return vec![b'm'],
            Self::Robot => return vec![b'r'],
            Self::Object(number) => (b'o', number),
            Self::Fact(number) => (b'f', number),
            Self::Event(number) => (b'e', number),
            Self::Task(number) => (b't', number),
            Self::Surface(number) => (b's', number),
        };
        let mut key = vec![table];
        key.extend(number.to_be_bytes());
        key
    }

    /// Decodes a key; `None` for an invalid one.
    pub(crate) fn of(key: &[u8]) -> Option<Self> {
        let (&table, number) = key.split_first()?;
        if number.is_empty() {
            return match table {
                b'm' => Some(Self::Meta),
                b'r' => Some(Self::Robot),
                _ => None,
            };
        }
        let number = u64::from_be_bytes(number.try_into().ok()?);
        match table {
            b'o' => Some(Self::Object(number)),
            b'f' => Some(Self::Fact(number)),
            b'e' => Some(Self::Event(number)),
            b't' => Some(Self::Task(number)),
            b's' => Some(Self::Surface(number)),
            _ => None,
        }
    }
}

/// Phrase for the record under a key, for error messages.
pub(crate) fn in_words(key: &[u8]) -> String {
    match RecordKey::of(key) {
        Some(RecordKey::Meta) => "the record about the store".to_owned(),
        _ => format!("the record {}", key.escape_ascii()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn keys_keep_content_and_order(a in any::<u64>(), b in any::<u64>()) {
            for entry in [RecordKey::Object(a), RecordKey::Fact(a), RecordKey::Event(a), RecordKey::Task(a), RecordKey::Surface(a)] {
                prop_assert_eq!(RecordKey::of(&entry.key()), Some(entry));
            }
            prop_assert_eq!(RecordKey::Fact(a).key().cmp(&RecordKey::Fact(b).key()), a.cmp(&b));
        }
    }

    #[test]
    fn invalid_keys_are_none() {
        assert_eq!(RecordKey::of(&RecordKey::Meta.key()), Some(RecordKey::Meta));
        assert_eq!(
            RecordKey::of(&RecordKey::Robot.key()),
            Some(RecordKey::Robot)
        );
        for other in [&b""[..], b"x", b"o", b"f123", b"x12345678", b"m12345678"] {
            assert_eq!(RecordKey::of(other), None, "{}", other.escape_ascii());
        }
    }
}
