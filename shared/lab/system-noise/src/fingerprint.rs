//! Environment fingerprint: hardware, kernel and privileges under which latencies are measured.

pub(crate) mod kernel_text;

use crate::privilege::{self, ResourceLimit};
use crate::system_files::SystemFiles;
use kernel_text as text;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

const CPUS: &str = "sys/devices/system/cpu";

/// Build profile of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BuildProfile {
    /// Release build, without debug assertions.
    Release,
    /// Debug build, with debug assertions and overflow checks.
    Debug,
}

/// Range of the cores' current frequencies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrequencyRange {
    /// Frequency of the slowest core, kHz.
    pub lowest_khz: u64,
    /// Frequency of the fastest core, kHz.
    pub highest_khz: u64,
}

/// Environment of a latency measurement; `None` if this computer does not report a value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fingerprint {
    /// Version of tabula.
    pub tabula_version: String,
    /// Build profile of this program.
    pub build_profile: BuildProfile,
    /// Processor model name.
    pub cpu_model: Option<String>,
    /// Number of online logical cores.
    pub n_logical_cores: Option<u32>,
    /// Cores this process may use (CPU affinity).
    pub usable_cores: Option<Vec<u32>>,
    /// `true` if SMT is active: two logical cores share a physical one.
    pub is_smt_active: Option<bool>,
    /// Size of the last-level cache, bytes.
    pub last_level_cache_bytes: Option<u64>,
    /// Kernel release (`uname -r`).
    pub kernel_release: Option<String>,
    /// Kernel preemption model.
    pub preemption: Option<String>,
    /// Clock source of the kernel.
    pub clock_source: Option<String>,
    /// Frequency governor of each core; virtual machines have none.
    pub governors: Option<Vec<String>>,
    /// Current clock frequencies of the cores.
    pub frequency: Option<FrequencyRange>,
    /// `true` if the CPU flags show a hypervisor.
    pub has_hypervisor: Option<bool>,
    /// Kind of virtual machine this system runs in, or `none`.
    pub virtual_machine: Option<String>,
    /// Kind of container around this process, or `none`.
    pub container: Option<String>,
    /// Total main memory, bytes.
    pub memory_total_bytes: Option<u64>,
    /// Policy of transparent huge pages: `always`, `madvise` or `never`.
    pub transparent_huge_pages: Option<String>,
    /// CPU cores isolated from the scheduler (`isolcpus`).
    pub isolated_cores: Option<Vec<u32>>,
    /// CPU cores without a periodic tick (`nohz_full`).
    pub tickless_cores: Option<Vec<u32>>,
    /// Scheduler settings `/proc/sys/kernel/sched_*`; empty if there are none.
    pub scheduler_settings: BTreeMap<String, String>,
    /// Timer slack of this thread, ns; does not apply to real-time threads.
    pub timer_slack_ns: Option<u64>,
    /// Maximum unprivileged real-time priority (`RLIMIT_RTPRIO`).
    pub realtime_priority_limit: ResourceLimit,
    /// Maximum unprivileged locked memory, bytes (`RLIMIT_MEMLOCK`).
    pub locked_memory_limit: ResourceLimit,
    /// `true` if this process may use `SCHED_FIFO`, determined by trying.
    pub may_use_fifo: Option<bool>,
}

impl Fingerprint {
    /// Fingerprint of this computer and process. Never fails: unreadable values are `None`.
    pub fn read() -> Self {
        Self::read_from(&SystemFiles::real())
    }

    pub(crate) fn read_from(files: &SystemFiles) -> Self {
        let cpuinfo = files.text("proc/cpuinfo").unwrap_or_default();
        let cpus = |name: &str| files.text(&format!("{CPUS}/{name}"));
        let cores = |name: &str| text::core_list(&cpus(name)?);
        let has_hypervisor = text::has_hypervisor(&cpuinfo);
        Self {
            tabula_version: env!("CARGO_PKG_VERSION").to_owned(),
            build_profile: build_profile(),
            cpu_model: text::cpu_model(&cpuinfo).or_else(|| board_model(files)),
            n_logical_cores: cores("online").map(|cores| cores.len() as u32),
            usable_cores: privilege::usable_cores(),
            is_smt_active: cpus("smt/active").map(|active| active == "1"),
            last_level_cache_bytes: last_level_cache_bytes(files),
            kernel_release: files.text("proc/sys/kernel/osrelease"),
            preemption: preemption(files),
            clock_source: files.text(&clock_source_file("current_clocksource")),
            governors: governors(files),
            frequency: frequency(files, &cpuinfo),
            has_hypervisor,
            virtual_machine: virtual_machine(files, has_hypervisor),
            container: container(files),
            memory_total_bytes: files
                .text("proc/meminfo")
                .and_then(|meminfo| text::meminfo_bytes(&meminfo, "MemTotal")),
            transparent_huge_pages: files
                .text("sys/kernel/mm/transparent_hugepage/enabled")
                .and_then(|choices| text::chosen(&choices)),
            isolated_cores: isolated_cores(files),
            tickless_cores: cores("nohz_full"),
            scheduler_settings: scheduler_settings(files),
            timer_slack_ns: privilege::timer_slack_ns(),
            realtime_priority_limit: privilege::realtime_priority_limit(),
            locked_memory_limit: privilege::locked_memory_limit(),
            may_use_fifo: privilege::may_use_fifo(),
        }
    }
}

fn build_profile() -> BuildProfile {
    if cfg!(debug_assertions) {
        BuildProfile::Debug
    } else {
        BuildProfile::Release
    }
}

fn clock_source_file(name: &str) -> String {
    format!("sys/devices/system/clocksource/clocksource0/{name}")
}

/// ARM computers report the board instead of the processor.
fn board_model(files: &SystemFiles) -> Option<String> {
    let model = files.text("proc/device-tree/model")?;
    Some(model.trim_end_matches('\0').to_owned())
}

fn last_level_cache_bytes(files: &SystemFiles) -> Option<u64> {
    let folder = format!("{CPUS}/cpu0/cache");
    let caches = files.names_in(&folder).into_iter();
    let sizes = caches.filter_map(|cache| files.text(&format!("{folder}/{cache}/size")));
    sizes.filter_map(|size| text::size_bytes(&size)).max()
}

fn preemption(files: &SystemFiles) -> Option<String> {
    let version = files.text("proc/sys/kernel/version");
    let version = version.or_else(|| files.text("proc/version"))?;
    let debug = files.text("sys/kernel/debug/sched/preempt");
    let command_line = files.text("proc/cmdline");
    Some(text::preemption(
        &version,
        debug.as_deref(),
        command_line.as_deref(),
    ))
}

/// Folders `cpu0`, `cpu1` and so on, by number.
fn core_folders(files: &SystemFiles) -> Vec<String> {
    let mut numbers: Vec<u32> = files
        .names_in(CPUS)
        .iter()
        .filter_map(|name| name.strip_prefix("cpu")?.parse().ok())
        .collect();
    numbers.sort_unstable();
    let folders = numbers.iter().map(|number| format!("{CPUS}/cpu{number}"));
    folders.collect()
}

fn governors(files: &SystemFiles) -> Option<Vec<String>> {
    let governors: Vec<String> = core_folders(files)
        .iter()
        .filter_map(|core| files.text(&format!("{core}/cpufreq/scaling_governor")))
        .collect();
    (!governors.is_empty()).then_some(governors)
}

/// Current frequencies of the cores, kHz; from the frequency driver, otherwise from
/// `/proc/cpuinfo`.
pub(crate) fn frequencies_khz(files: &SystemFiles, cpuinfo: &str) -> Vec<u64> {
    let reported: Vec<u64> = core_folders(files)
        .iter()
        .filter_map(|core| files.number(&format!("{core}/cpufreq/scaling_cur_freq")))
        .collect();
    if reported.is_empty() {
        text::cpuinfo_frequencies_khz(cpuinfo)
    } else {
        reported
    }
}

/// Number of frequency changes since boot over all cores; `None` if they are not counted.
pub(crate) fn n_frequency_changes(files: &SystemFiles) -> Option<u64> {
    let counts: Vec<u64> = core_folders(files)
        .iter()
        .filter_map(|core| files.number(&format!("{core}/cpufreq/stats/total_trans")))
        .collect();
    (!counts.is_empty()).then(|| counts.iter().sum())
}

fn frequency(files: &SystemFiles, cpuinfo: &str) -> Option<FrequencyRange> {
    let reported = frequencies_khz(files, cpuinfo);
    Some(FrequencyRange {
        lowest_khz: *reported.iter().min()?,
        highest_khz: *reported.iter().max()?,
    })
}

fn virtual_machine(files: &SystemFiles, has_hypervisor: Option<bool>) -> Option<String> {
    let dmi = |name: &str| files.text(&format!("sys/class/dmi/id/{name}"));
    let product: Vec<String> = [dmi("sys_vendor"), dmi("product_name")]
        .into_iter()
        .flatten()
        .collect();
    let clocks = files.text(&clock_source_file("available_clocksource"));
    text::virtual_machine(has_hypervisor, Some(&product.join(" ")), clocks.as_deref())
}

fn container(files: &SystemFiles) -> Option<String> {
    if let Some(reported) = files.text("run/systemd/container") {
        return Some(reported);
    }
    let marks = [(".dockerenv", "docker"), ("run/.containerenv", "podman")];
    if let Some((_, name)) = marks.iter().find(|(mark, _)| files.has(mark)) {
        return Some((*name).to_owned());
    }
    files
        .text("proc/1/cgroup")
        .map(|cgroup| text::container(&cgroup))
}

/// Isolated cores; the kernel's file is empty if there are none.
fn isolated_cores(files: &SystemFiles) -> Option<Vec<u32>> {
    let file = format!("{CPUS}/isolated");
    match files.text(&file) {
        Some(list) => text::core_list(&list),
        None => files.has(&file).then(Vec::new),
    }
}

fn scheduler_settings(files: &SystemFiles) -> BTreeMap<String, String> {
    let folder = "proc/sys/kernel";
    let names = files.names_in(folder).into_iter();
    names
        .filter(|name| name.starts_with("sched_"))
        .filter_map(|name| {
            let value = files.text(&format!("{folder}/{name}"))?;
            Some((name, value))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::path::Path;

    fn write(root: &Path, path: &str, text: &str) {
        let path = root.join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    #[test]
    fn missing_files_are_none() {
        let root = tempfile::tempdir().unwrap();
        let print = Fingerprint::read_from(&SystemFiles::below(root.path()));
        assert_eq!(
            (&print.cpu_model, &print.governors, &print.frequency),
            (&None, &None, &None)
        );
        assert_eq!((&print.container, &print.virtual_machine), (&None, &None));
        assert_eq!(
            (&print.isolated_cores, &print.memory_total_bytes),
            (&None, &None)
        );
        assert!(print.scheduler_settings.is_empty());
    }

    #[test]
    fn present_files_are_read() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path();
        for core in 0..2 {
            let folder = format!("{CPUS}/cpu{core}/cpufreq");
            write(root, &format!("{folder}/scaling_governor"), "powersave\n");
            let khz = format!("{}\n", 800_000 + core);
            write(root, &format!("{folder}/scaling_cur_freq"), &khz);
            write(root, &format!("{folder}/stats/total_trans"), "21\n");
        }
        write(root, &format!("{CPUS}/online"), "0-1\n");
        write(root, &format!("{CPUS}/isolated"), "\n");
        write(root, &format!("{CPUS}/cpu0/cache/index0/size"), "32K\n");
        write(root, &format!("{CPUS}/cpu0/cache/index3/size"), "8192K\n");
        write(root, "proc/sys/kernel/sched_rt_runtime_us", "950000\n");
        let files = SystemFiles::below(root);
        let print = Fingerprint::read_from(&files);
        assert_eq!(print.governors.unwrap(), ["powersave"; 2]);
        let frequency = print.frequency.unwrap();
        assert_eq!(
            (frequency.lowest_khz, frequency.highest_khz),
            (800_000, 800_001)
        );
        assert_eq!(print.n_logical_cores, Some(2));
        assert_eq!(print.isolated_cores, Some(vec![]));
        assert_eq!(print.last_level_cache_bytes, Some(8 << 20));
        assert_eq!(print.scheduler_settings["sched_rt_runtime_us"], "950000");
        assert_eq!(n_frequency_changes(&files), Some(42));
    }

    #[test]
    fn this_computer_survives_a_round_trip() {
        let print = Fingerprint::read();
        let text = serde_json::to_string(&print).unwrap();
        assert_eq!(print, serde_json::from_str::<Fingerprint>(&text).unwrap());
        assert!(print.usable_cores.is_some_and(|cores| !cores.is_empty()));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn malformed_files_are_survived(bytes in prop::collection::vec(any::<u8>(), 0..80)) {
            let root = tempfile::tempdir().unwrap();
            for path in ["proc/cpuinfo", "proc/meminfo", "proc/cmdline", "proc/version", "proc/1/cgroup"] {
                let path = root.path().join(path);
                std::fs::create_dir_all(path.parent().unwrap()).unwrap();
                std::fs::write(path, &bytes).unwrap();
            }
            let _ = Fingerprint::read_from(&SystemFiles::below(root.path()));
        }
    }
}
