//! Parsers of the kernel's time counters (`/proc/stat`, `/proc/PID/stat`, `/proc/pressure/cpu`).

/// CPU time of all cores since boot, clock ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct CpuTime {
    /// Time in user programs, the kernel and interrupts.
    pub(crate) busy: u64,
    /// Idle CPU time, including I/O wait.
    pub(crate) idle: u64,
    /// Time taken by the hypervisor while something was ready to run.
    pub(crate) steal: u64,
}

impl CpuTime {
    /// Total CPU time: busy, idle and stolen.
    pub(crate) fn total(self) -> u64 {
        self.busy
            .saturating_add(self.idle)
            .saturating_add(self.steal)
    }
}

/// Parses the line of all cores in `/proc/stat`.
pub(crate) fn cpu_time(stat: &str) -> Option<CpuTime> {
    let line = stat.lines().find_map(|line| line.strip_prefix("cpu "))?;
    let ticks: Vec<u64> = line
        .split_whitespace()
        .map_while(|word| word.parse().ok())
        .collect();
    // Fields: user, nice, system, idle, iowait, irq, softirq, steal; guest time is contained in
    // user time.
    let [user, nice, system, idle, waiting, rest @ ..] = ticks.as_slice() else {
        return None;
    };
    let sum = |ticks: &[u64]| ticks.iter().fold(0_u64, |sum, t| sum.saturating_add(*t));
    let interrupts = &rest[..rest.len().min(2)];
    Some(CpuTime {
        busy: sum(&[*user, *nice, *system, sum(interrupts)]),
        idle: sum(&[*idle, *waiting]),
        steal: rest.get(2).copied().unwrap_or(0),
    })
}

/// CPU pressure of the last 10 s as a share, 0 to 1, from `/proc/pressure/cpu`.
pub(crate) fn pressure_share(pressure: &str) -> Option<f64> {
    let line = pressure.lines().find(|line| line.starts_with("some "))?;
    let mut words = line.split_whitespace();
    let percent = words.find_map(|word| word.strip_prefix("avg10="))?;
    let percent: f64 = percent.parse().ok()?;
    (0.0..=100.0).contains(&percent).then_some(percent / 100.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_time_of_all_cores_is_read() {
        let stat = "cpu  100 5 60 270 12 3 4 15 7 0\ncpu0 1 2 3\nintr 4\n";
        let time = cpu_time(stat).unwrap();
        assert_eq!((time.busy, time.idle, time.steal), (172, 282, 15));
        assert_eq!(time.total(), 469);
        assert_eq!(cpu_time("cpu 1 2 3 4 5").unwrap().steal, 0);
        assert_eq!(cpu_time("cpu0 1 2 3 4 5 6"), None);
        assert_eq!(cpu_time("cpu 1 2 x"), None);
    }

    #[test]
    fn pressure_is_read() {
        let pressure = "some avg10=9.61 avg60=5.56 avg300=2.81 total=19993298\nfull avg10=0.00";
        assert!((pressure_share(pressure).unwrap() - 0.0961).abs() < 1e-12);
        assert_eq!(pressure_share("some avg10=NaN"), None);
        assert_eq!(pressure_share("full avg10=1"), None);
    }

    proptest! {
        #[test]
        fn malformed_text_is_survived(text in "\\PC{0,200}|(cpu |some avg10=)?[0-9 .-]{0,80}") {
            let _ = cpu_time(&text).map(CpuTime::total);
            let _ = pressure_share(&text);
        }
    }
}
