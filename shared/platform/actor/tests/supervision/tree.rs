//! Trees of unlike children: order, time to stop, escalation upwards.

use std::future::pending;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::support::{Adder, Order, Refused, Shared, WATCHDOG, config, count, soon, usual_policy};
use actor::{
    ActorConfig, Address, Cause, ChildPath, ChildSpec, Error, Escalation, Events, Lost, Placement,
    Restart, RestartPolicy, SendError, Stop, Strategy, Supervisor, Tree, reports,
};
use tokio::runtime::Handle;
use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tokio::time::{Instant, sleep};

const SECOND: Duration = Duration::from_secs(1);

/// At most so many restarts a minute, each after a second.
fn at_most(max_restarts: u32) -> RestartPolicy {
    RestartPolicy::new(max_restarts, 60 * SECOND, SECOND, SECOND).expect("a valid policy")
}

struct Running {
    tree: JoinHandle<Result<(), Escalation<ChildPath>>>,
    events: Events<ChildPath>,
    stop: oneshot::Sender<()>,
}

fn run(tree: Tree) -> Running {
    let (reports, events) = reports(count(1000));
    let (stop, told) = oneshot::channel();
    let tree = tokio::spawn(tree.run(reports, async {
        let _ = told.await;
    }));
    Running { tree, events, stop }
}

impl Running {
    async fn lines(&mut self, n: usize) -> Vec<String> {
        let mut lines = Vec::new();
        while lines.len() < n {
            let event = soon(self.events.recv()).await;
            lines.push(event.expect("the tree runs").to_string());
        }
        lines
    }

    async fn ended(self) -> Result<(), Escalation<ChildPath>> {
        soon(self.tree).await.expect("the tree does not panic")
    }

    async fn stopped(self) -> Result<(), Escalation<ChildPath>> {
        drop(self.stop);
        soon(self.tree).await.expect("the tree does not panic")
    }
}

type Diary = Arc<Mutex<Vec<String>>>;

fn note(diary: &Diary, line: &str) {
    diary.lock().expect("nobody panics").push(line.to_owned());
}

/// Takes a second to end after it was told to.
fn diarist(id: &'static str, diary: &Diary) -> ChildSpec {
    let diary = Arc::clone(diary);
    ChildSpec::task(id, Restart::Permanent, 5 * SECOND, move |stop: Stop| {
        let diary = Arc::clone(&diary);
        async move {
            note(&diary, &format!("{id} begins"));
            stop.await;
            sleep(SECOND).await;
            note(&diary, &format!("{id} ends"));
            Ok::<_, Refused>(())
        }
    })
}

fn adder(id: &'static str, restart: Restart, shared: &Arc<Shared>) -> (ChildSpec, Address<Adder>) {
    let config = ActorConfig {
        restart,
        placement: Placement::Inline,
        mailbox_capacity: count(4),
        shutdown: SECOND,
    };
    ChildSpec::actor(id, config, Arc::clone(shared), 0)
}

#[tokio::test(start_paused = true)]
async fn children_start_in_order_and_stop_in_the_reverse_order_one_after_the_other() {
    let diary = Diary::default();
    let below = vec![diarist("b1", &diary), diarist("b2", &diary)];
    let below = Tree::new(Strategy::OneForOne, usual_policy(), below).unwrap();
    let children = vec![
        diarist("a", &diary),
        ChildSpec::tree("b", Restart::Permanent, below),
        diarist("c", &diary),
    ];
    let mut running = run(Tree::new(Strategy::OneForAll, usual_policy(), children).unwrap());
    let expected = ["a", "b/b1", "b/b2", "b", "c"].map(|id| format!("Actor {id} has started."));
    assert_eq!(running.lines(5).await, expected);
    let begin = Instant::now();
    running.stopped().await.unwrap();
    assert_eq!(begin.elapsed(), 4 * SECOND, "one after the other");
    let diary = diary.lock().unwrap();
    let order = ["a begins", "b1 begins", "b2 begins", "c begins"];
    assert_eq!(diary[..4], order);
    assert_eq!(diary[4..], ["c ends", "b2 ends", "b1 ends", "a ends"]);
}

#[tokio::test(start_paused = true)]
async fn who_comes_after_waits_until_the_one_before_is_ready() {
    let shared = Arc::new(Shared::default());
    shared.bad_starts.store(3, Ordering::Relaxed);
    let (first, _) = adder("first", Restart::Permanent, &shared);
    let diary = Diary::default();
    let children = vec![first, diarist("second", &diary)];
    let mut running = run(Tree::new(Strategy::RestForOne, at_most(3), children).unwrap());
    let begin = Instant::now();
    let lines = running.lines(5).await;
    assert_eq!(begin.elapsed(), 3 * SECOND);
    let again = "Actor first starts again after 1000 ms, because it failed: the adder refuses.";
    assert_eq!(lines[..3], [again; 3]);
    assert_eq!(
        lines[3..],
        ["Actor first has started.", "Actor second has started."]
    );
    running.stopped().await.unwrap();
}

#[tokio::test(start_paused = true)]
async fn who_does_not_end_in_its_shutdown_time_is_left_behind() {
    let resource = Arc::new(());
    let held = Arc::clone(&resource);
    let deaf = ChildSpec::task("deaf", Restart::Permanent, 3 * SECOND, move |_stop| {
        let held = Arc::clone(&held);
        async move {
            let outcome = pending::<Result<(), Refused>>().await;
            drop(held);
            outcome
        }
    });
    let mut running = run(Tree::new(Strategy::OneForOne, usual_policy(), vec![deaf]).unwrap());
    running.lines(1).await;
    let Running {
        tree,
        mut events,
        stop,
    } = running;
    let begin = Instant::now();
    drop(stop);
    soon(tree).await.unwrap().unwrap();
    assert_eq!(begin.elapsed(), 3 * SECOND);
    assert_eq!(Arc::strong_count(&resource), 1, "dropped with its task");
    assert_eq!(
        soon(events.recv()).await.unwrap().to_string(),
        "Actor deaf did not stop within the shutdown time and was left behind."
    );
}

#[tokio::test(start_paused = true)]
async fn a_task_that_panics_is_named_and_begins_again() {
    let mut n_lives = 0;
    let task = ChildSpec::task("frames", Restart::Transient, SECOND, move |stop: Stop| {
        n_lives += 1;
        let life = n_lives;
        async move {
            assert!(life > 1, "no camera");
            stop.await;
            Ok::<_, Refused>(())
        }
    });
    let mut running = run(Tree::new(Strategy::OneForOne, usual_policy(), vec![task]).unwrap());
    assert_eq!(
        running.lines(3).await,
        [
            "Actor frames has started.",
            "Actor frames starts again after 50 ms, because it panicked: no camera.",
            "Actor frames has started."
        ]
    );
    running.stopped().await.unwrap();
}

#[tokio::test(start_paused = true)]
async fn an_escalation_is_a_failure_of_the_child_and_begins_anew_from_the_first_state() {
    let shared = Arc::new(Shared::default());
    let (inner, address) = adder("inner", Restart::Permanent, &shared);
    let (bystander, other) = adder("bystander", Restart::Permanent, &shared);
    let below = Tree::new(Strategy::OneForOne, at_most(1), vec![inner, bystander]).unwrap();
    let below = ChildSpec::tree("below", Restart::Permanent, below);
    let mut running = run(Tree::new(Strategy::OneForOne, at_most(1), vec![below]).unwrap());
    running.lines(3).await;
    let add = |n| soon(address.ask(1, Order::Add(n)).unwrap());
    let panic = |tag| soon(address.ask(tag, Order::Panic(9)).unwrap());
    assert_eq!(add(7).await, Ok(7));
    assert_eq!(panic(2).await, Err(Lost));
    running.lines(2).await;
    assert_eq!(add(1).await, Ok(8), "from the last good state");
    assert_eq!(panic(3).await, Err(Lost));
    let lines = running.lines(7).await;
    assert!(lines[3].contains("Actor below starts again"), "{lines:?}");
    assert_eq!(add(1).await, Ok(1), "from the first state");
    assert_eq!(panic(4).await, Err(Lost));
    assert_eq!(panic(7).await, Err(Lost));
    let escalation = running.ended().await.unwrap_err();
    assert_eq!(escalation.id.as_str(), "below");
    let sentence = escalation.to_string();
    assert!(
        sentence.contains("more than 1 restarts within 60 s were needed, the last by actor below")
            && sentence.contains("the last by actor below/inner: it panicked"),
        "{sentence}"
    );
    assert!(sentence.contains("(at message 7, which is lost)"));
    assert!(matches!(
        other.tell(8, Order::Add(1)),
        Err(SendError::Closed(_))
    ));
}

#[tokio::test(start_paused = true)]
async fn a_supervisor_that_escalates_is_empty_afterwards_and_spawns_again() {
    let shared = Arc::new(Shared::default());
    let mut settings = config(Restart::Permanent, Placement::Inline);
    settings.policy = at_most(0);
    let (objects, _events) =
        Supervisor::<u64, Adder>::new(settings, Arc::clone(&shared), Handle::current());
    let spec = ChildSpec::supervisor("objects", Restart::Permanent, &objects);
    let mut running = run(Tree::new(Strategy::OneForAll, at_most(1), vec![spec]).unwrap());
    running.lines(1).await;
    for is_last in [false, true] {
        let track = objects.spawn(17, 0).unwrap();
        objects.spawn(18, 0).unwrap();
        assert_eq!(
            soon(track.ask(4711, Order::Panic(1)).unwrap()).await,
            Err(Lost)
        );
        if is_last {
            break;
        }
        let sentence = &running.lines(1).await[0];
        assert!(
            sentence.contains("Actor objects starts again")
                && sentence.contains("actor 17: it panicked: at 1 (at message 4711"),
            "{sentence}"
        );
        assert_eq!(objects.n_actors(), 0);
        assert!(matches!(
            objects.spawn(17, 0),
            Err(Error::SupervisorEnded { .. })
        ));
        running.lines(1).await;
    }
    let escalation = running.ended().await.unwrap_err();
    assert!(matches!(escalation.cause, Cause::Failed(_)));
    assert_eq!(objects.n_actors(), 0);
}

#[tokio::test(start_paused = true)]
async fn stopping_a_tree_stops_the_actors_of_its_supervisors() {
    let shared = Arc::new(Shared::default());
    let settings = config(Restart::Permanent, Placement::Inline);
    let (objects, _events) =
        Supervisor::<u64, Adder>::new(settings, Arc::clone(&shared), Handle::current());
    let spec = ChildSpec::supervisor("objects", Restart::Permanent, &objects);
    let mut running = run(Tree::new(Strategy::OneForAll, at_most(1), vec![spec]).unwrap());
    running.lines(1).await;
    let track = objects.spawn(17, 0).unwrap();
    soon(track.ask(1, Order::Add(1)).unwrap()).await.unwrap();
    running.stopped().await.unwrap();
    assert!(track.is_closed());
    assert_eq!(shared.stopped.load(Ordering::Relaxed), 1);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_actor_that_hangs_on_the_reactor_never_lives_twice() {
    let shared = Arc::new(Shared::default());
    let (stuck, address) = adder("stuck", Restart::Permanent, &shared);
    let (failing, other) = adder("failing", Restart::Permanent, &shared);
    let policy = RestartPolicy::new(2, 60 * SECOND, Duration::ZERO, Duration::ZERO).unwrap();
    let mut running = run(Tree::new(Strategy::OneForAll, policy, vec![stuck, failing]).unwrap());
    let (tell, begun) = std::sync::mpsc::channel();
    let (gate, opened) = std::sync::mpsc::channel();
    // A message sent from a thread of the reactor could keep the tree waiting
    // behind the one that hangs.
    running.lines(2).await;
    let answer = address.ask(0, Order::Hang(tell, opened)).unwrap();
    tokio::task::spawn_blocking(move || begun.recv_timeout(WATCHDOG))
        .await
        .unwrap()
        .unwrap();
    other.tell(1, Order::Panic(0)).unwrap();
    let escalation = running.ended().await.unwrap_err();
    assert!(escalation.to_string().contains("previous life hangs"));
    drop(gate);
    drop(answer);
}

#[test]
fn two_children_of_one_name_are_refused() {
    let diary = Diary::default();
    let children = vec![diarist("a", &diary), diarist("a", &diary)];
    let error = Tree::new(Strategy::OneForOne, usual_policy(), children).unwrap_err();
    assert!(matches!(error, Error::DuplicateChild { id: "a" }));
}
