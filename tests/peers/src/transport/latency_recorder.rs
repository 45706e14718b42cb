//! What the receiver notes of each message.

use crate::answer::Answer;
use crate::plan::Task;
use crate::{clock, payload};

#[derive(Debug)]
pub struct Log {
    task: Task,
    latency_ns: Vec<u64>,
    touch_ns: Vec<u64>,
    next: u64,
    n_lost: u64,
    /// Processor time of the process when the warm-up ended, and with the last message.
    cpu_begin_ns: u64,
    cpu_end_ns: u64,
}

impl Log {
    pub fn new(task: Task) -> Self {
        let series = || Vec::with_capacity(task.n_messages as usize);
        Self {
            latency_ns: series(),
            touch_ns: series(),
            next: 0,
            n_lost: 0,
            cpu_begin_ns: clock::process_ns(),
            cpu_end_ns: 0,
            task,
        }
    }

    /// A message can be read: tells whether it was the last.
    pub fn note(&mut self, number: u64, sent_ns: u64, payload: &[u8]) -> bool {
        let received_ns = clock::now_ns();
        payload::touch(number, payload);
        let touched_ns = clock::now_ns();
        assert_eq!(payload.len(), self.task.payload_bytes);
        if number >= self.task.n_warm_up {
            self.latency_ns.push(received_ns - sent_ns);
            self.touch_ns.push(touched_ns - received_ns);
            self.n_lost += number - self.next.max(self.task.n_warm_up);
        } else {
            self.cpu_begin_ns = clock::process_ns();
        }
        self.next = number + 1;
        let is_last = self.next == self.task.n_all();
        if is_last {
            self.cpu_end_ns = clock::process_ns();
        }
        is_last
    }

    pub fn answer(self) -> Answer {
        Answer::default()
            .with("cpu_ns", [self.cpu_end_ns - self.cpu_begin_ns])
            .with("lost", [self.n_lost])
            .with("latency_ns", self.latency_ns)
            .with("touch_ns", self.touch_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Mode, System};

    #[test]
    fn gaps_are_counted_and_the_warm_up_is_not() {
        let mut task = Task::new(System::Iceoryx2, Mode::Polled, 64, 1);
        (task.n_warm_up, task.n_messages) = (3, 5);
        let mut log = Log::new(task);
        for number in [0, 2, 4, 7] {
            let is_last = log.note(number, clock::now_ns(), &[number as u8; 64]);
            assert_eq!(is_last, number == 7);
        }
        let answer = log.answer();
        assert_eq!(answer.figure("lost"), Ok(3), "3, 5 and 6");
        assert_eq!(answer.series("latency_ns").unwrap().len(), 2);
    }
}
