//! Lease of the one commander of an arm.

use std::collections::VecDeque;

/// Silence after which a lease ends, nanoseconds.
pub const LEASE_TIME_NS: u64 = 500_000_000;

/// Number of ended leases that are remembered, to say why they have ended. Chosen.
const N_ENDED_MAX: usize = 64;

/// Lease of an arm: at most one commander moves it, and is heard at least every half second.
///
/// A commander chooses a random number for its lease. A lease that has ended never begins again: a
/// commander that was stopped or lost must decide anew that it wants to move the arm.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CommandLease {
    current: Option<Lease>,
    ended: VecDeque<(u64, LeaseEnd)>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Lease {
    id: u64,
    holder: String,
    heard_ns: u64,
}

/// Reason for the end of a lease.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LeaseEnd {
    Released,
    Silent,
    Stopped,
}

/// Refusal of a commander.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LeaseRefusal {
    /// Another commander holds the lease.
    #[error("the arm is commanded by {holder}; wait for its end, or stop the arm")]
    Held {
        /// Name of the commander.
        holder: String,
    },
    /// The commander had released its lease.
    #[error("this lease of the arm was released; begin another one")]
    Released,
    /// The commander was silent for too long.
    #[error(
        "this lease of the arm has ended, since its commander was silent for half a second; begin \
         another one"
    )]
    Silent,
    /// The arm was stopped.
    #[error("the arm was stopped, and this lease has ended; to move it again, begin another one")]
    Stopped,
}

impl CommandLease {
    /// Name of the commander; `None` without one.
    pub fn holder(&self) -> Option<&str> {
        self.current.as_ref().map(|lease| lease.holder.as_str())
    }

    /// Begins or renews a lease at `now_ns`; `true` if it begins.
    ///
    /// # Errors
    /// The refusal when another commander holds the arm, or this lease has ended.
    pub fn renew(&mut self, id: u64, holder: &str, now_ns: u64) -> Result<bool, LeaseRefusal> {
        match &mut self.current {
            Some(lease) if lease.id == id => {
                lease.heard_ns = now_ns;
                return Ok(false);
            }
            Some(lease) => {
                let holder = lease.holder.clone();
                return Err(self.refusal(id).unwrap_or(LeaseRefusal::Held { holder }));
            }
            None => {}
        }
        if let Some(refusal) = self.refusal(id) {
            return Err(refusal);
        }
        self.current = Some(Lease {
            id,
            holder: holder.to_owned(),
            heard_ns: now_ns,
        });
        Ok(true)
    }

    /// Ends a lease at the wish of its commander; that of another one stays.
    pub fn release(&mut self, id: u64) {
        if self.current.as_ref().is_some_and(|lease| lease.id == id) {
            self.end(LeaseEnd::Released);
        }
    }

    /// Ends the lease of a commander that is silent for too long at `now_ns`; returns its name.
    pub fn expire(&mut self, now_ns: u64) -> Option<String> {
        let lease = self.current.as_ref()?;
        let is_silent = now_ns.saturating_sub(lease.heard_ns) > LEASE_TIME_NS;
        is_silent.then(|| self.end(LeaseEnd::Silent)).flatten()
    }

    /// Ends the lease because the arm is stopped; returns the name of its commander.
    pub fn stop(&mut self) -> Option<String> {
        self.end(LeaseEnd::Stopped)
    }

    fn end(&mut self, reason: LeaseEnd) -> Option<String> {
        let lease = self.current.take()?;
        if self.ended.len() == N_ENDED_MAX {
            self.ended.pop_front();
        }
        self.ended.push_back((lease.id, reason));
        Some(lease.holder)
    }

    /// Refusal of a lease that has ended.
    fn refusal(&self, id: u64) -> Option<LeaseRefusal> {
        let (_, reason) = self.ended.iter().rfind(|(ended, _)| *ended == id)?;
        Some(match reason {
            LeaseEnd::Released => LeaseRefusal::Released,
            LeaseEnd::Silent => LeaseRefusal::Silent,
            LeaseEnd::Stopped => LeaseRefusal::Stopped,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn another_commander_is_refused_by_the_holders_name() {
        let mut lease = CommandLease::default();
        assert_eq!(lease.renew(1, "anna", 0), Ok(true));
        assert_eq!(lease.renew(1, "anna", 10), Ok(false));
        let refusal = lease.renew(2, "ben", 20).unwrap_err().to_string();
        assert!(refusal.contains("anna"), "{refusal}");
        lease.release(2);
        assert_eq!(lease.holder(), Some("anna"));
        lease.release(1);
        assert_eq!(lease.renew(2, "ben", 30), Ok(true));
        assert_eq!(lease.renew(1, "anna", 40), Err(LeaseRefusal::Released));
    }

    #[test]
    fn lease_ends_after_half_a_second_of_silence() {
        let mut lease = CommandLease::default();
        lease.renew(1, "anna", 0).unwrap();
        assert_eq!(lease.expire(LEASE_TIME_NS), None);
        assert_eq!(lease.expire(LEASE_TIME_NS + 1).as_deref(), Some("anna"));
        assert_eq!(lease.expire(LEASE_TIME_NS + 2), None);
        assert_eq!(lease.renew(1, "anna", 0), Err(LeaseRefusal::Silent));
        assert_eq!(lease.renew(3, "anna", 0), Ok(true));
    }

    #[test]
    fn lease_that_was_stopped_never_begins_again() {
        let mut lease = CommandLease::default();
        assert_eq!(lease.stop(), None);
        lease.renew(1, "anna", 0).unwrap();
        assert_eq!(lease.stop().as_deref(), Some("anna"));
        assert_eq!(lease.renew(1, "anna", 1), Err(LeaseRefusal::Stopped));
        lease.renew(2, "ben", 1).unwrap();
        assert_eq!(lease.renew(1, "anna", 1), Err(LeaseRefusal::Stopped));
    }

    proptest! {
        #[test]
        fn nobody_moves_the_arm_without_the_lease(
            steps in proptest::collection::vec((0..4_u8, 0..5_u64, 0..400_000_000_u64), 1..200),
        ) {
            let mut lease = CommandLease::default();
            let mut now_ns = 0;
            for (step, id, pause_ns) in steps {
                now_ns += pause_ns;
                lease.expire(now_ns);
                let before = lease.current.clone();
                match step {
                    0 | 1 => {
                        let renewed = lease.renew(id, "x", now_ns);
                        let was_other = before.is_some_and(|before| before.id != id);
                        prop_assert!(!(was_other && renewed.is_ok()));
                        let current = lease.current.as_ref().map(|lease| lease.id);
                        prop_assert_eq!(renewed.is_ok(), current == Some(id));
                    }
                    2 => lease.release(id),
                    _ => drop(lease.stop()),
                }
                prop_assert!(lease.ended.len() <= N_ENDED_MAX);
            }
        }
    }
}
