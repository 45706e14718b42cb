//! The keys of the database: one letter for the table, then a big-endian number,
//! so that the order of the bytes is the order of what they mean.

/// A record, by its place in the database.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Entry {
    /// `m`: about the whole database.
    Meta,
    /// `r`: the robot.
    Robot,
    /// `o` and the track-id: an object.
    Object(u64),
    /// `f` and its number: a fact.
    Fact(u64),
    /// `e` and its sequence: an event.
    Event(u64),
    /// `t` and its number: a task.
    Task(u64),
}

impl Entry {
    pub(super) fn key(self) -> Vec<u8> {
        let (table, number) = match self {
            Self::Meta => return vec![b'm'],
            Self::Robot => return vec![b'r'],
            Self::Object(number) => (b'o', number),
            Self::Fact(number) => (b'f', number),
            Self::Event(number) => (b'e', number),
            Self::Task(number) => (b't', number),
        };
        let mut key = vec![table];
        key.extend(number.to_be_bytes());
        key
    }

    /// The record with this key; `None` when it is no key of ours.
    pub(super) fn of(key: &[u8]) -> Option<Self> {
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
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn keys_keep_content_and_order(a in any::<u64>(), b in any::<u64>()) {
            for entry in [Entry::Object(a), Entry::Fact(a), Entry::Event(a), Entry::Task(a)] {
                prop_assert_eq!(Entry::of(&entry.key()), Some(entry));
            }
            prop_assert_eq!(Entry::Fact(a).key().cmp(&Entry::Fact(b).key()), a.cmp(&b));
        }
    }

    #[test]
    fn other_keys_are_none() {
        assert_eq!(Entry::of(&Entry::Meta.key()), Some(Entry::Meta));
        assert_eq!(Entry::of(&Entry::Robot.key()), Some(Entry::Robot));
        for other in [&b""[..], b"x", b"o", b"f123", b"x12345678", b"m12345678"] {
            assert_eq!(Entry::of(other), None, "{}", other.escape_ascii());
        }
    }
}
