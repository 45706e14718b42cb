//! Mailbox, life cycle, worker pool and supervision.
