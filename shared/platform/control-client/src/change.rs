//! Changes with a known outcome: one whose fate is unknown is sent again under its mutation
//! id, which makes the repetition idempotent.

use crate::connection::{call_failure, try_connect};
use control_protocol::{RefusalKind, TypedRequest};
use daemon_client::CallError;
use service::{CommonArguments, Failure, exit_code};
use std::time::{Duration, Instant};

/// Time for which a change is repeated after its outcome became unknown. Chosen: a process that
/// has ended is restarted, and its store opened, in less.
pub(crate) const PATIENCE: Duration = Duration::from_secs(20);
/// Pause between two attempts. Chosen.
const PAUSE: Duration = Duration::from_millis(200);

/// Sends a change to the daemon, again and again until its outcome is known. The request has a
/// mutation id, which stays the same.
///
/// # Errors
/// If the change is refused or no daemon runs, so that nothing was changed; or, with a sentence
/// that says so, if the outcome is still unknown after 20 s.
pub fn change<T>(common: &CommonArguments, request: &TypedRequest<T>) -> Result<T, Failure> {
    until_known(PATIENCE, || try_connect(common)?.ask(request))
}

/// Repeats an attempt until the outcome of the change is known, or `patience` is at its end.
pub(crate) fn until_known<T>(
    patience: Duration,
    mut attempt: impl FnMut() -> Result<T, CallError>,
) -> Result<T, Failure> {
    let mut in_doubt_since = None;
    loop {
        let error = match attempt() {
            Ok(value) => return Ok(value),
            Err(error) => error,
        };
        if !is_doubtful(&error, in_doubt_since.is_some()) {
            return Err(call_failure(error));
        }
        let since = *in_doubt_since.get_or_insert_with(Instant::now);
        if since.elapsed() >= patience {
            return Err(unknown_outcome(&error.to_string()));
        }
        std::thread::sleep(PAUSE);
    }
}

/// True if it is not known whether the change was made. After a doubtful attempt only an answer
/// about the change itself counts.
fn is_doubtful(error: &CallError, was_in_doubt: bool) -> bool {
    match error {
        CallError::Refusal(refusal) => match refusal.kind {
            RefusalKind::UnknownOutcome => true,
            RefusalKind::Unavailable | RefusalKind::TimedOut | RefusalKind::Internal => {
                was_in_doubt
            }
            _ => false,
        },
        // The request was sent, and the reply was not received.
        CallError::TimedOut { .. } | CallError::Interrupted { .. } | CallError::Carrier { .. } => {
            true
        }
        _ => was_in_doubt,
    }
}

fn unknown_outcome(doubt: &str) -> Failure {
    let sentence = format!(
        "it is not known if the change was made: {doubt}. Look for it in `tabula memory history` \
         when the daemon answers again, and repeat the command if it is not there"
    );
    Failure::new(exit_code::TIMED_OUT, sentence)
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_protocol::Refusal;

    const NEVER: Duration = Duration::ZERO;
    const LONG: Duration = Duration::from_secs(3600);

    fn refused(kind: RefusalKind) -> Result<(), CallError> {
        Err(CallError::Refusal(Refusal::new(kind, "syncing failed")))
    }

    /// Outcome of a change whose attempts have these answers, and the number of attempts.
    fn settle(
        patience: Duration,
        answers: Vec<Result<(), CallError>>,
    ) -> (Result<(), Failure>, usize) {
        let mut answers = answers.into_iter();
        let mut n_attempts = 0;
        let outcome = until_known(patience, || {
            n_attempts += 1;
            answers.next().expect("no further attempt")
        });
        (outcome, n_attempts)
    }

    #[test]
    fn change_with_an_unknown_outcome_is_repeated_until_it_is_answered() {
        let answers = vec![
            refused(RefusalKind::UnknownOutcome),
            refused(RefusalKind::Unavailable),
            Err(CallError::NoDaemon { domain: "x".into() }),
            Err(CallError::TimedOut { after: LONG }),
            Ok(()),
        ];
        assert_eq!(settle(LONG, answers), (Ok(()), 5));
    }

    #[test]
    fn change_that_was_certainly_not_made_is_not_repeated() {
        for kind in [
            RefusalKind::Unavailable,
            RefusalKind::Conflict,
            RefusalKind::Invalid,
        ] {
            let (outcome, n_attempts) = settle(LONG, vec![refused(kind)]);
            assert!(outcome.is_err() && n_attempts == 1, "{kind:?}");
        }
        let no_daemon = Err(CallError::NoDaemon { domain: "x".into() });
        let (outcome, _) = settle(LONG, vec![no_daemon]);
        assert_eq!(outcome.unwrap_err().code, exit_code::NO_DAEMON);
    }

    #[test]
    fn change_whose_outcome_stays_unknown_ends_with_a_sentence() {
        for answer in [
            refused(RefusalKind::UnknownOutcome),
            Err(CallError::Interrupted { process: "memory" }),
        ] {
            let failure = settle(NEVER, vec![answer]).0.unwrap_err();
            assert_eq!(failure.code, exit_code::TIMED_OUT);
            assert!(
                failure
                    .sentence
                    .contains("not known if the change was made"),
                "{failure}"
            );
            assert!(
                failure.sentence.contains("tabula memory history"),
                "{failure}"
            );
        }
    }
}
