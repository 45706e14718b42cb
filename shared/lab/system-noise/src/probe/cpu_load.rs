//! Synthetic CPU load.

use std::hint::spin_loop;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{Builder, JoinHandle};

/// Spinning threads, stopped on drop.
#[derive(Debug)]
pub struct CpuLoad {
    is_over: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl CpuLoad {
    /// Starts the threads, with the scheduling and affinity of the calling thread.
    ///
    /// # Errors
    /// If a thread cannot be started.
    pub fn begin(n_threads: usize) -> io::Result<Self> {
        let mut load = Self {
            is_over: Arc::default(),
            threads: Vec::new(),
        };
        for _ in 0..n_threads {
            let is_over = load.is_over.clone();
            let spin = move || {
                while !is_over.load(Ordering::Relaxed) {
                    spin_loop();
                }
            };
            load.threads.push(Builder::new().spawn(spin)?);
        }
        Ok(load)
    }
}

impl Drop for CpuLoad {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}
