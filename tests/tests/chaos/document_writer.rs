//! Writer of documents under chaos: it stores them without end and remembers what was acknowledged.

use crate::daemon::Sandbox;
use channel::DomainName;
use channel::RunFolder;
use control_client::{NewDocument, read_document, try_put_document};
use control_protocol::{Command, DocumentKind, DocumentName, MutationId, Reply};
use daemon_client::{CallError, DaemonClient};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Time limit of an answer.
const ANSWER: Duration = Duration::from_secs(3);
/// Pause between two requests, and before one is repeated.
const PAUSE: Duration = Duration::from_millis(20);
/// Number of names, each of which is stored again and again.
const N_NAMES: u64 = 50;

/// Document store of the daemon, as the teacher sees it.
#[derive(Clone)]
struct Client {
    domain: DomainName,
    folders: [RunFolder; 1],
}

impl Client {
    fn ask(&self, command: &Command) -> Result<Reply, CallError> {
        DaemonClient::connect(&self.domain, &self.folders, ANSWER)?.call(command.clone())
    }
}

#[derive(Default)]
struct Acknowledged {
    is_over: AtomicBool,
    n_acknowledged: AtomicU64,
    /// Number of the newest acknowledged document of each name.
    newest: Mutex<Vec<u64>>,
}

/// Thread that stores one document after the other; one that is not acknowledged is repeated
/// with the same id until it is.
pub(super) struct DocumentWriter {
    client: Client,
    progress: Arc<Acknowledged>,
    thread: Option<JoinHandle<()>>,
}

fn document(number: u64) -> DocumentName {
    DocumentName {
        kind: DocumentKind::TaskKnowledge,
        name: format!("chaos {}", number % N_NAMES),
    }
}

impl DocumentWriter {
    pub(super) fn start(sandbox: &Sandbox) -> Self {
        let client = Client {
            domain: sandbox.domain.clone(),
            folders: [sandbox.run_folder()],
        };
        let progress = Arc::new(Acknowledged::default());
        progress.newest.lock().unwrap().resize(N_NAMES as usize, 0);
        let thread = std::thread::spawn({
            let (client, progress) = (client.clone(), progress.clone());
            move || {
                for number in 1.. {
                    if !store(&client, &progress, number) {
                        return;
                    }
                    std::thread::sleep(PAUSE);
                }
            }
        });
        Self {
            client,
            progress,
            thread: Some(thread),
        }
    }

    /// Number of acknowledged documents.
    pub(super) fn n_acknowledged(&self) -> u64 {
        self.progress.n_acknowledged.load(Ordering::Relaxed)
    }

    /// Time from now to the next acknowledgement of a request that is sent from now on; `None` if
    /// none comes in time.
    pub(super) fn time_to_acknowledgement(&self, watchdog: Duration) -> Option<Duration> {
        let begin = Instant::now();
        // The first one may have been under way.
        let wanted = self.n_acknowledged() + 2;
        while self.n_acknowledged() < wanted {
            if begin.elapsed() > watchdog {
                return None;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        Some(begin.elapsed())
    }

    /// Stops, and returns the names whose acknowledged content is not there any more.
    pub(super) fn stop(mut self) -> Vec<String> {
        self.progress.is_over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
        let newest = self.progress.newest.lock().unwrap().clone();
        let known = newest.into_iter().filter(|number| *number > 0);
        let is_lost = |number: &u64| self.stored(&document(*number)) != Some(*number);
        known
            .filter(is_lost)
            .map(|number| document(number).name)
            .collect()
    }

    /// Number in a stored document.
    fn stored(&self, name: &DocumentName) -> Option<u64> {
        let document = read_document(name, |command| self.client.ask(&command)).ok()?;
        String::from_utf8(document.content).ok()?.parse().ok()
    }
}

impl Drop for DocumentWriter {
    fn drop(&mut self) {
        self.progress.is_over.store(true, Ordering::Relaxed);
    }
}

/// Stores a document; false when the teacher is over.
fn store(client: &Client, progress: &Acknowledged, number: u64) -> bool {
    let (id, name) = (MutationId(u128::from(number)), document(number));
    let content = number.to_string();
    let new = NewDocument {
        document: &name,
        media_type: "text/plain",
        content: content.as_bytes(),
    };
    let mut upload = None;
    loop {
        if progress.is_over.load(Ordering::Relaxed) {
            return false;
        }
        let call = |command| client.ask(&command);
        if try_put_document(id, "chaos", new, &mut upload, call).is_ok() {
            progress.newest.lock().unwrap()[(number % N_NAMES) as usize] = number;
            progress.n_acknowledged.fetch_add(1, Ordering::Relaxed);
            return true;
        }
        std::thread::sleep(PAUSE);
    }
}
