//! Resource counters of a process, from `/proc`.

use crate::system_files::SystemFiles;

/// Resource counters of a process since its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ProcessCounters {
    /// Start time, clock ticks since boot; distinguishes processes that reuse an id.
    pub start: u64,
    /// User and kernel time, clock ticks.
    pub cpu_ticks: u64,
    /// User and kernel time of the children that have ended, clock ticks.
    pub children_ticks: u64,
    /// Minor page faults (first use of memory).
    pub minor_faults: u64,
    /// Major page faults (disk access).
    pub major_faults: u64,
    /// Voluntary context switches of all threads.
    pub voluntary_switches: u64,
    /// Involuntary context switches of all threads.
    pub involuntary_switches: u64,
    /// Number of threads.
    pub n_threads: u64,
    /// Pages in memory.
    pub resident_pages: u64,
}

impl ProcessCounters {
    /// Present counters of a process; `None` if it does not exist.
    pub fn read(pid: u32) -> Option<Self> {
        Self::read_from(&SystemFiles::real(), pid)
    }

    pub(crate) fn read_from(files: &SystemFiles, pid: u32) -> Option<Self> {
        let mut counters = Self::parse(&files.text(&format!("proc/{pid}/stat"))?)?;
        let tasks = format!("proc/{pid}/task");
        for task in files.names_in(&tasks) {
            let status = files.text(&format!("{tasks}/{task}/status"));
            let (voluntary, involuntary) = switches(&status.unwrap_or_default());
            counters.voluntary_switches += voluntary;
            counters.involuntary_switches += involuntary;
        }
        Some(counters)
    }

    /// Parses `/proc/PID/stat`; the process name may contain blanks and parentheses.
    fn parse(stat: &str) -> Option<Self> {
        let (_, after_name) = stat.rsplit_once(')')?;
        let fields: Vec<&str> = after_name.split_whitespace().collect();
        // The first field here is field 3 of proc(5).
        let number = |field: usize| fields.get(field - 3)?.parse::<u64>().ok();
        Some(Self {
            start: number(22)?,
            cpu_ticks: number(14)?.saturating_add(number(15)?),
            children_ticks: number(16)?.saturating_add(number(17)?),
            minor_faults: number(10)?,
            major_faults: number(12)?,
            n_threads: number(20)?,
            resident_pages: number(24)?,
            ..Self::default()
        })
    }

    /// User and kernel time with that of the children, clock ticks.
    pub(crate) fn busy_ticks(&self) -> u64 {
        self.cpu_ticks.saturating_add(self.children_ticks)
    }

    /// Work since earlier counters of the same process; threads and pages are the present ones.
    #[must_use]
    pub fn since(&self, before: &Self) -> Self {
        let since = |count: fn(&Self) -> u64| count(self).saturating_sub(count(before));
        Self {
            cpu_ticks: since(|c| c.cpu_ticks),
            children_ticks: since(|c| c.children_ticks),
            minor_faults: since(|c| c.minor_faults),
            major_faults: since(|c| c.major_faults),
            voluntary_switches: since(|c| c.voluntary_switches),
            involuntary_switches: since(|c| c.involuntary_switches),
            ..*self
        }
    }
}

/// Voluntary and involuntary context switches of a thread, from its `status` file.
fn switches(status: &str) -> (u64, u64) {
    let of = |name: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(name))?;
        line.trim().parse().ok()
    };
    (
        of("voluntary_ctxt_switches:").unwrap_or(0),
        of("nonvoluntary_ctxt_switches:").unwrap_or(0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn stat_line_is_parsed_with_any_process_name() {
        let line = "77 (a) b (c)) S 1 77 77 0 -1 4194304 1000 0 20 0 300 50 9 1 20 0 9 0 12345 \
                    99999999 2560 18446744073709551615";
        let counters = ProcessCounters::parse(line).unwrap();
        assert_eq!((counters.minor_faults, counters.major_faults), (1000, 20));
        assert_eq!((counters.cpu_ticks, counters.busy_ticks()), (350, 360));
        assert_eq!((counters.n_threads, counters.start), (9, 12345));
        assert_eq!(counters.resident_pages, 2560);
        assert_eq!(ProcessCounters::parse("rubbish"), None);
        assert_eq!(ProcessCounters::parse("1 (x) S 1"), None);
        assert_eq!(ProcessCounters::parse(""), None);
    }

    #[test]
    fn context_switches_are_parsed() {
        let status = "Name:\tx\nvoluntary_ctxt_switches:\t12\nnonvoluntary_ctxt_switches:\t3\n";
        assert_eq!(switches(status), (12, 3));
        assert_eq!(switches(""), (0, 0));
    }

    proptest! {
        #[test]
        fn malformed_text_is_survived(text in "\\PC{0,200}|(1 \\(x\\) )?[0-9 .-]{0,120}") {
            let _ = ProcessCounters::parse(&text).map(|counters| counters.busy_ticks());
            let _ = switches(&text);
        }
    }
}
