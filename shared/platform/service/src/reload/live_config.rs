//! Live configuration: the checked settings of a process, replaced as a whole by a reload.

use std::sync::Arc;
use tokio::sync::watch;

/// Newest settings of a process. Each clone notices changes for itself.
#[derive(Debug, Clone)]
pub struct LiveConfig<C>(watch::Receiver<Arc<C>>);

impl<C> LiveConfig<C> {
    /// Settings that change when others are sent.
    pub(super) fn new(config: C) -> (watch::Sender<Arc<C>>, Self) {
        let (sender, receiver) = watch::channel(Arc::new(config));
        (sender, Self(receiver))
    }

    /// Settings that never change, for tests.
    pub fn constant(config: C) -> Self {
        Self::new(config).1
    }

    /// Newest settings.
    pub fn get(&self) -> Arc<C> {
        self.0.borrow().clone()
    }

    /// Newest settings, which are no change any more.
    pub fn take(&mut self) -> Arc<C> {
        self.0.borrow_and_update().clone()
    }

    /// Newest settings if they have changed since they were last taken.
    pub fn take_change(&mut self) -> Option<Arc<C>> {
        // An error means that the sender is gone: the process is ending.
        let has_changed = self.0.has_changed().unwrap_or(false);
        has_changed.then(|| self.take())
    }

    /// Waits for settings that have not been taken; for ever when none can come.
    pub async fn change(&mut self) -> Arc<C> {
        if self.0.changed().await.is_err() {
            std::future::pending::<()>().await;
        }
        self.take()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn change_is_taken_once_by_each_clone() {
        let (sender, mut first) = LiveConfig::new(1);
        let mut second = first.clone();
        assert_eq!(first.take_change(), None);
        sender.send_replace(Arc::new(2));
        sender.send_replace(Arc::new(3));
        assert_eq!(first.take_change().as_deref(), Some(&3));
        assert_eq!(first.take_change(), None);
        assert_eq!(*second.change().await, 3);
        assert_eq!(*second.get(), 3);
    }
}
