//! The tree against a small reference model, in virtual time: random failures,
//! wishes to stop, bad starts and messages, under every strategy and restart.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::task::{Context, Waker};
use std::time::Duration;

use crate::support::{Adder, Order, Shared, count};
use actor::{
    ActorConfig, Address, Answer, ChildSpec, Event, Lost, Placement, Restart, RestartPolicy,
    StopReason, Strategy, Tree, reports,
};
use proptest::prelude::{Just, ProptestConfig, Strategy as Generator, TestCaseError, prop};
use proptest::{prop_assert_eq, prop_oneof, proptest};
use tokio::runtime::Builder;
use tokio::sync::oneshot;
use tokio::time::{Instant, sleep_until};

const NAMES: [&str; 4] = ["a", "b", "c", "d"];
/// Everything begins at a multiple of this plus its number, so that no two
/// things that are not related happen in the same moment.
const GRAIN_MS: u64 = 64;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Deed {
    Panic,
    Fail,
    Finish,
    Add,
    /// Panics and fails to start so often afterwards.
    BadStarts(usize),
}

#[derive(Debug, Clone)]
struct Case {
    strategy: Strategy,
    max_restarts: u32,
    window_ms: u64,
    backoff_min_ms: u64,
    backoff_max_ms: u64,
    restarts: Vec<Restart>,
    /// After so many grains, this is done to that child.
    deeds: Vec<(u64, usize, Deed)>,
}

fn case() -> impl Generator<Value = Case> {
    let strategy = prop_oneof![
        Just(Strategy::OneForOne),
        Just(Strategy::OneForAll),
        Just(Strategy::RestForOne)
    ];
    let restart = prop_oneof![
        4 => Just(Restart::Permanent),
        2 => Just(Restart::Transient),
        1 => Just(Restart::Temporary)
    ];
    let deed = prop_oneof![
        3 => Just(Deed::Panic),
        1 => Just(Deed::Fail),
        2 => Just(Deed::Finish),
        4 => Just(Deed::Add),
        1 => (1_usize..3).prop_map(Deed::BadStarts)
    ];
    let deeds = prop::collection::vec((0_u64..30, 0..NAMES.len(), deed), 1..GRAIN_MS as usize);
    let restarts = prop::collection::vec(restart, NAMES.len());
    let policy = (0_u32..12, 1_u64..300, 0_u64..6, 0_u64..30);
    (strategy, policy, restarts, deeds).prop_map(|(strategy, policy, restarts, deeds)| Case {
        strategy,
        max_restarts: policy.0,
        window_ms: policy.1 * GRAIN_MS,
        backoff_min_ms: policy.2 * GRAIN_MS,
        backoff_max_ms: (policy.2 + policy.3) * GRAIN_MS,
        restarts,
        deeds,
    })
}

/// What is seen of the tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Seen {
    Started(usize),
    Restarting { child: usize, after_ms: u64 },
    Stopped(usize),
    Finished(usize),
    Failed(usize),
    Escalated(usize),
}

/// What became of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fate {
    Answered(u64),
    Lost,
    Refused,
    Waiting,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Up,
    /// Starts at this time; `keeps` the messages that come meanwhile.
    Due {
        at_ms: u64,
        keeps: bool,
    },
    Over,
}

/// The rules of the tree as sentences over lists.
struct Model<'a> {
    case: &'a Case,
    now_ms: u64,
    states: Vec<State>,
    totals: Vec<u64>,
    bad_starts: Vec<usize>,
    restarts: Vec<(u64, usize)>,
    seen: Vec<(u64, Seen)>,
    /// To whom, and what became of it.
    messages: Vec<(usize, Fate)>,
    has_ended: bool,
}

impl<'a> Model<'a> {
    fn new(case: &'a Case) -> Self {
        let start = State::Due {
            at_ms: 0,
            keeps: true,
        };
        Self {
            case,
            now_ms: 0,
            states: vec![start; NAMES.len()],
            totals: vec![0; NAMES.len()],
            bad_starts: vec![0; NAMES.len()],
            restarts: Vec::new(),
            seen: Vec::new(),
            messages: Vec::new(),
            has_ended: false,
        }
    }

    fn see(&mut self, seen: Seen) {
        self.seen.push((self.now_ms, seen));
    }

    /// Lets time pass and starts who is due, the earlier first, then in order.
    fn advance(&mut self, until_ms: u64) {
        let due = |(child, state): (usize, &State)| match state {
            State::Due { at_ms, .. } => Some((*at_ms, child)),
            _ => None,
        };
        while !self.has_ended {
            let next = self.states.iter().enumerate().filter_map(due).min();
            let Some((at_ms, child)) = next.filter(|(at_ms, _)| *at_ms <= until_ms) else {
                break;
            };
            self.now_ms = at_ms;
            self.start(child);
        }
        self.now_ms = until_ms;
    }

    fn start(&mut self, child: usize) {
        if self.bad_starts[child] > 0 {
            self.bad_starts[child] -= 1;
            return self.fail(child);
        }
        self.states[child] = State::Up;
        self.see(Seen::Started(child));
        for (to, fate) in &mut self.messages {
            if *to == child && *fate == Fate::Waiting {
                self.totals[child] += 1;
                *fate = Fate::Answered(self.totals[child]);
            }
        }
    }

    /// A failure that calls for a restart.
    fn fail(&mut self, child: usize) {
        let (case, now_ms) = (self.case, self.now_ms);
        let is_recent = |(at_ms, _): &&(u64, usize)| now_ms - at_ms < case.window_ms;
        let recent: Vec<_> = self.restarts.iter().filter(is_recent).collect();
        if recent.len() >= case.max_restarts as usize {
            return self.escalate(child);
        }
        let n_own = recent.iter().filter(|(_, who)| *who == child).count();
        let after_ms = (case.backoff_min_ms << n_own).min(case.backoff_max_ms);
        self.restarts.push((now_ms, child));
        self.see(Seen::Restarting { child, after_ms });
        let (first, last) = match case.strategy {
            Strategy::OneForOne => (child, child),
            Strategy::OneForAll => (0, NAMES.len() - 1),
            Strategy::RestForOne => (child, NAMES.len() - 1),
        };
        for other in (first..=last).rev() {
            let keeps = match self.states[other] {
                _ if other == child => true,
                State::Due { keeps, .. } => keeps,
                State::Up => {
                    self.see(Seen::Stopped(other));
                    self.close(other);
                    false
                }
                State::Over => false,
            };
            let stays_away = case.restarts[other] == Restart::Temporary;
            self.states[other] = if stays_away && other != child {
                State::Over
            } else {
                let at_ms = now_ms + after_ms;
                State::Due { at_ms, keeps }
            };
        }
    }

    fn escalate(&mut self, child: usize) {
        self.see(Seen::Failed(child));
        self.states[child] = State::Over;
        for other in (0..NAMES.len()).rev() {
            if self.states[other] == State::Up {
                self.see(Seen::Stopped(other));
            }
            self.close(other);
        }
        self.see(Seen::Escalated(child));
        self.has_ended = true;
    }

    fn close(&mut self, child: usize) {
        self.states[child] = State::Over;
        for (to, fate) in &mut self.messages {
            if *to == child && *fate == Fate::Waiting {
                *fate = Fate::Lost;
            }
        }
    }

    fn apply(&mut self, child: usize, deed: Deed) {
        let restart = self.case.restarts[child];
        match (self.states[child], deed) {
            (State::Up, Deed::Add) => {
                self.totals[child] += 1;
                let fate = Fate::Answered(self.totals[child]);
                self.messages.push((child, fate));
            }
            (State::Due { keeps: true, .. }, _) => self.messages.push((child, Fate::Waiting)),
            (State::Due { .. } | State::Over, _) => self.messages.push((child, Fate::Refused)),
            (State::Up, Deed::Finish) => {
                // Adds one, which is committed.
                self.totals[child] += 1;
                if restart == Restart::Permanent {
                    return self.fail(child);
                }
                self.see(Seen::Finished(child));
                self.states[child] = State::Over;
            }
            (State::Up, _) if restart == Restart::Temporary => {
                self.see(Seen::Failed(child));
                self.states[child] = State::Over;
            }
            (State::Up, Deed::BadStarts(n)) => {
                self.bad_starts[child] = n;
                self.fail(child);
            }
            (State::Up, _) => self.fail(child),
        }
    }
}

fn seen(event: &Event<actor::ChildPath>) -> Seen {
    let place = |id: &actor::ChildPath| {
        let names = NAMES.iter();
        names.clone().position(|name| *name == id.as_str())
    };
    let place = |id| place(id).expect("only these were started");
    match event {
        Event::Started { id } => Seen::Started(place(id)),
        Event::Restarting { id, after, .. } => Seen::Restarting {
            child: place(id),
            after_ms: after.as_millis() as u64,
        },
        Event::Stopped { id, reason } => match reason {
            StopReason::Asked => Seen::Stopped(place(id)),
            StopReason::Finished => Seen::Finished(place(id)),
            _ => Seen::Failed(place(id)),
        },
        Event::Escalated(escalation) => Seen::Escalated(place(&escalation.id)),
        other => unreachable!("nothing hangs here: {other}"),
    }
}

struct Actors {
    shared: Vec<Arc<Shared>>,
    addresses: Vec<Address<Adder>>,
    answers: Vec<Option<Answer<u64>>>,
}

impl Actors {
    fn apply(&mut self, child: usize, deed: Deed, is_up: bool) {
        let order = match deed {
            _ if !is_up => Order::Add(1),
            Deed::Add => Order::Add(1),
            Deed::Panic => Order::Panic(100),
            Deed::Fail => Order::Fail(100),
            Deed::Finish => Order::Finish(1),
            Deed::BadStarts(n) => {
                self.shared[child].bad_starts.store(n, Ordering::Relaxed);
                Order::Panic(100)
            }
        };
        if matches!(order, Order::Add(_)) {
            let answer = self.addresses[child].ask(0, order).ok();
            self.answers.push(answer);
        } else {
            self.addresses[child].tell(0, order).expect("it is up");
        }
    }

    fn fates(self) -> Vec<Fate> {
        let mut context = Context::from_waker(Waker::noop());
        let mut fate = |answer: Option<Answer<u64>>| {
            let Some(answer) = answer else {
                return Fate::Refused;
            };
            match std::pin::pin!(answer).poll(&mut context) {
                std::task::Poll::Ready(Ok(total)) => Fate::Answered(total),
                std::task::Poll::Ready(Err(Lost)) => Fate::Lost,
                std::task::Poll::Pending => Fate::Waiting,
            }
        };
        self.answers.into_iter().map(&mut fate).collect()
    }
}

fn plant(case: &Case) -> (Tree, Actors) {
    let ms = Duration::from_millis;
    let policy = RestartPolicy::new(
        case.max_restarts,
        ms(case.window_ms),
        ms(case.backoff_min_ms),
        ms(case.backoff_max_ms),
    );
    let mut actors = Actors {
        shared: Vec::new(),
        addresses: Vec::new(),
        answers: Vec::new(),
    };
    let mut specs = Vec::new();
    for (name, restart) in NAMES.into_iter().zip(&case.restarts) {
        let config = ActorConfig {
            restart: *restart,
            placement: Placement::Inline,
            mailbox_capacity: count(100),
            shutdown: Duration::from_secs(5),
        };
        let shared = Arc::new(Shared::default());
        let (spec, address) = ChildSpec::actor::<Adder>(name, config, Arc::clone(&shared), 0);
        specs.push(spec);
        actors.shared.push(shared);
        actors.addresses.push(address);
    }
    let policy = policy.expect("the strategy makes valid policies");
    let tree = Tree::new(case.strategy, policy, specs).expect("names differ");
    (tree, actors)
}

/// Lets everybody do what there is to do in this moment.
async fn settle() {
    for _ in 0..100 {
        tokio::task::yield_now().await;
    }
}

async fn check(case: Case) -> Result<(), TestCaseError> {
    let (tree, mut actors) = plant(&case);
    let (reports, mut events) = reports(count(10_000));
    let begin = Instant::now();
    let elapsed_ms = move || begin.elapsed().as_millis() as u64;
    let watching = tokio::spawn(async move {
        let mut log = Vec::new();
        while let Some(event) = events.recv().await {
            log.push((elapsed_ms(), seen(&event)));
        }
        log
    });
    let (stop, told) = oneshot::channel::<()>();
    let running = tokio::spawn(tree.run(reports, async {
        let _ = told.await;
    }));
    settle().await;
    let mut model = Model::new(&case);
    model.advance(0);
    let mut grains = 0;
    for (number, (gap, child, deed)) in (1..).zip(&case.deeds) {
        grains += gap;
        let at_ms = grains * GRAIN_MS + number;
        sleep_until(begin + Duration::from_millis(at_ms)).await;
        settle().await;
        model.advance(at_ms);
        if model.has_ended {
            break;
        }
        actors.apply(*child, *deed, model.states[*child] == State::Up);
        model.apply(*child, *deed);
        settle().await;
        // A back-off of nothing is over in the same moment.
        model.advance(at_ms);
    }
    let expected: Vec<_> = model.messages.iter().map(|(_, fate)| *fate).collect();
    prop_assert_eq!(actors.fates(), expected);
    prop_assert_eq!(running.is_finished(), model.has_ended);
    let n_seen = model.seen.len();
    drop(stop);
    let outcome = running.await.expect("the tree does not panic");
    prop_assert_eq!(outcome.is_err(), model.has_ended);
    let mut log = watching.await.expect("it does not panic");
    // The rest is the stop that the test asked for.
    log.truncate(n_seen);
    prop_assert_eq!(log, model.seen);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]
    #[test]
    fn the_tree_follows_the_model(case in case()) {
        let runtime = Builder::new_current_thread().enable_time().start_paused(true).build();
        runtime.expect("a runtime").block_on(check(case))?;
    }
}
