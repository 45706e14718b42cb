//! File of the prior of novelty: what people's corrections have shown outlives a restart.

use file_access::write_atomic;
use learning::NoveltyPrior;
use serde::{Deserialize, Serialize};
use service::Home;
use std::path::{Path, PathBuf};
use tokio::sync::watch;

/// Name of the file in the data folder.
const FILE_NAME: &str = "novelty-prior.json";

/// Content of the file.
#[derive(Debug, Serialize, Deserialize)]
struct NoveltyPriorRecord {
    /// Number of new objects, with those of the initial prior.
    n_new: f32,
    /// Number of known objects, with those of the initial prior.
    n_known: f32,
}

/// Writer of the prior whenever it changes.
pub(crate) struct NoveltyPriorWriter {
    path: PathBuf,
    changes: watch::Receiver<NoveltyPrior>,
}

/// Prior that the data folder holds, and the writer of its changes. Without a file, or with one
/// that cannot be used, which is logged, learning begins anew.
pub(crate) fn open(home: &Home) -> (watch::Sender<NoveltyPrior>, NoveltyPriorWriter) {
    let path = home.path().join(FILE_NAME);
    let prior = read(&path).unwrap_or_else(|why| {
        tracing::warn!("{why}; the share of new objects is learned anew");
        NoveltyPrior::default()
    });
    let (sender, changes) = watch::channel(prior);
    (sender, NoveltyPriorWriter { path, changes })
}

impl NoveltyPriorWriter {
    /// Writes the prior until the last sender is gone. A file that cannot be written is logged, and
    /// written at the next change.
    pub(crate) async fn run(mut self) {
        while self.changes.changed().await.is_ok() {
            let prior = *self.changes.borrow_and_update();
            let path = self.path.clone();
            let written = tokio::task::spawn_blocking(move || write_atomic(&path, bytes(&prior)));
            if let Ok(Err(error)) = written.await {
                tracing::warn!(
                    "what the lessons show about new objects is lost at a restart: {error}"
                );
            }
        }
        std::future::pending::<()>().await;
    }
}

/// Prior of a file; the initial one when there is none.
///
/// # Errors
/// A sentence about a file that cannot be used.
fn read(path: &Path) -> Result<NoveltyPrior, String> {
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            return Ok(NoveltyPrior::default());
        }
        Err(error) => return Err(format!("{} cannot be read: {error}", path.display())),
    };
    let record = serde_json::from_slice(&bytes).ok();
    let counts = record.map(|NoveltyPriorRecord { n_new, n_known }| [n_new, n_known]);
    let prior = counts.and_then(NoveltyPrior::from_counts);
    prior.ok_or_else(|| format!("{} is damaged", path.display()))
}

fn bytes(prior: &NoveltyPrior) -> Vec<u8> {
    let [n_new, n_known] = prior.counts();
    serde_json::to_vec(&NoveltyPriorRecord { n_new, n_known }).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use learning::Feedback;
    use test_data::golden;

    #[tokio::test]
    async fn prior_is_read_again_as_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let home = Home::at(folder.path().to_owned());
        let (sender, writer) = open(&home);
        assert_eq!(*sender.borrow(), NoveltyPrior::default());
        let writing = tokio::spawn(writer.run());
        sender.send_modify(|prior| prior.learn(Feedback::FalseName));
        let learned = *sender.borrow();
        while *open(&home).0.borrow() != learned {
            tokio::time::sleep(std::time::Duration::from_millis(5)).await;
        }
        writing.abort();
    }

    #[test]
    fn damaged_file_is_told_and_learning_begins_anew() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(FILE_NAME);
        for content in [
            "",
            "{",
            "{\"n_new\":-1,\"n_known\":9}",
            "{\"n_new\":1e30,\"n_known\":9}",
        ] {
            std::fs::write(&path, content).unwrap();
            assert!(read(&path).unwrap_err().contains("is damaged"), "{content}");
            let (sender, _) = open(&Home::at(folder.path().to_owned()));
            assert_eq!(*sender.borrow(), NoveltyPrior::default());
        }
    }

    #[test]
    fn golden_prior_is_written_and_read() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/novelty-prior.txt");
        let mut prior = NoveltyPrior::default();
        prior.learn(Feedback::FalseName);
        let read = |bytes: &[u8]| {
            let record: NoveltyPriorRecord = serde_json::from_slice(bytes).unwrap();
            NoveltyPrior::from_counts([record.n_new, record.n_known]).unwrap()
        };
        golden::check(&file, &[("learned", prior)], bytes, read);
    }
}
