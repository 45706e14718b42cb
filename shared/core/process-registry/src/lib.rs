//! Registry of the daemon's processes: the name, code and duties of each, as data.
//!
//! Channel, service, gateway, supervision and doctor read this table; a process that is added
//! here needs no change in any of them.
//!
//! ```
//! use process_registry::ProcessKind;
//!
//! let memory = ProcessKind::from_word("memory").unwrap();
//! assert_eq!(memory, ProcessKind::MEMORY);
//! assert_eq!(memory.program(), "tabula-memory");
//! ```
//!
//! Invariants: names and codes are stored and sent; they never change and are never used again.

use std::fmt;

/// Description of one process of the daemon.
#[derive(Debug, PartialEq, Eq)]
struct ProcessEntry {
    /// Code of the process in shared memory and on disk.
    code: u32,
    /// Name of the process for people and scripts, such as `camera`.
    word: &'static str,
    duties: &'static [Duty],
}

/// Duty of a process, as far as others need to know it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Duty {
    /// Publishes frames. Exactly one such process runs in a daemon.
    Sensor,
    /// Reports each frame that it has finished, for which a source in lockstep waits.
    FollowsFrames,
    /// Writes a store, and has more time than others before it counts as hung.
    Store,
    /// Owns requests of the control protocol, and serves them.
    Owner,
    /// Commands the arm, and runs only in a daemon that has one.
    Commander,
    /// Drives an arm: a program of the user, which a daemon has or has not.
    Driver,
}

/// Process of the daemon: an entry of the registry.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ProcessKind(u32);

macro_rules! processes {
    ($($(#[$doc:meta])* $name:ident = $code:literal, $word:literal, [$($duty:ident),*];)+) => {
        impl ProcessKind {
            $($(#[$doc])* pub const $name: Self = Self($code);)+
        }

        /// Entries in starting order.
        static REGISTRY: [ProcessEntry; [$($word),+].len()] = [
            $(ProcessEntry { code: $code, word: $word, duties: &[$(Duty::$duty),*] }),+
        ];
    };
}

processes! {
    /// `tabula-gateway`: serves the control socket, and passes each request to its owner.
    GATEWAY = 5, "gateway", [];
    /// `tabula-memory`: stores views, labels and world facts.
    MEMORY = 3, "memory", [Store, FollowsFrames, Owner];
    /// `tabula-perception`: detects, tracks and recognises objects.
    PERCEPTION = 2, "perception", [FollowsFrames, Owner];
    /// `tabula-camera`: publishes camera frames.
    CAMERA = 1, "camera", [Sensor];
    /// `tabula-simulator`: replaces the camera by a simulated scene, and drives its arm.
    SIMULATOR = 4, "simulator", [Sensor, Owner];
    /// `tabula-arm`: drives a real arm. It is a program of the robot's user, and owns the requests to
    /// the arm; where there is none, the simulator answers them.
    ARM = 7, "arm", [Owner, Driver];
    /// `tabula-executive`: carries out tasks with the arm.
    EXECUTIVE = 6, "executive", [Owner, Commander];
}

impl ProcessKind {
    /// All processes in starting order.
    pub fn all() -> impl DoubleEndedIterator<Item = Self> + Clone {
        REGISTRY.iter().map(|entry| Self(entry.code))
    }

    /// Process of a code; `None` for one that is not registered.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::all().find(|process| process.0 == code)
    }

    /// Process of a name; `None` for one that is not registered.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::all().find(|process| process.word() == word)
    }

    /// Code of the process in shared memory and on disk.
    pub fn code(self) -> u32 {
        self.0
    }

    /// Name of the process for people and scripts, such as `camera`.
    pub fn word(self) -> &'static str {
        self.entry().word
    }

    /// True if the process has a duty.
    pub fn has(self, duty: Duty) -> bool {
        self.entry().duties.contains(&duty)
    }

    /// File name of the executable, such as `tabula-camera`.
    pub fn program(self) -> String {
        format!("tabula-{}", self.word())
    }

    fn entry(self) -> &'static ProcessEntry {
        // Every value comes from an entry.
        let found = REGISTRY.iter().find(|entry| entry.code == self.0);
        found.unwrap_or(&REGISTRY[0])
    }
}

impl fmt::Debug for ProcessKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_and_codes_are_pinned_and_unique() {
        let pinned = [
            ("gateway", 5),
            ("memory", 3),
            ("perception", 2),
            ("camera", 1),
            ("simulator", 4),
            ("arm", 7),
            ("executive", 6),
        ];
        let known: Vec<_> = ProcessKind::all()
            .map(|process| (process.word(), process.code()))
            .collect();
        assert_eq!(known, pinned);
        let codes: BTreeSet<_> = known.iter().map(|(_, code)| code).collect();
        assert_eq!(codes.len(), known.len());
        for (word, code) in known {
            assert_eq!(ProcessKind::from_code(code), ProcessKind::from_word(word));
        }
        assert_eq!(ProcessKind::from_code(0), None);
    }
}
