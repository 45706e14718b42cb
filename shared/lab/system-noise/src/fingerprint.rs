//! The environment of a measurement.

pub(crate) mod kernel_text;

use crate::system_files::SystemFiles;
use crate::{privilege, scheduling};
use kernel_text as text;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

const CPUS: &str = "sys/devices/system/cpu";

/// Whether the program was built for speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BuildProfile {
    /// Without debug assertions.
    Release,
    /// With debug assertions and checks of overflow.
    Debug,
}

/// A resource limit of this process.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Limit {
    /// As much as there is.
    Unlimited,
    /// Not more than this.
    Most(u64),
}

/// Present frequencies of the cores.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrequencyRange {
    /// Of the slowest core, kHz.
    pub lowest_khz: u64,
    /// Of the fastest core, kHz.
    pub highest_khz: u64,
}

/// Where a latency was measured. `None` is what this computer does not tell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fingerprint {
    /// Version of tabula.
    pub tabula_version: String,
    /// How this program was built.
    pub build_profile: BuildProfile,
    /// The processor.
    pub cpu_model: Option<String>,
    /// Logical cores that are switched on.
    pub n_logical_cores: Option<u32>,
    /// Cores that this process may use.
    pub usable_cores: Option<Vec<u32>>,
    /// Whether two logical cores share one physical one.
    pub is_smt_active: Option<bool>,
    /// Size of the last-level cache, bytes.
    pub last_level_cache_bytes: Option<u64>,
    /// Release of the kernel.
    pub kernel_release: Option<String>,
    /// How the kernel lets itself be interrupted.
    pub preemption: Option<String>,
    /// What the kernel's clocks read.
    pub clock_source: Option<String>,
    /// Frequency governor of each core; virtual machines have none.
    pub governors: Option<Vec<String>>,
    /// Present frequencies.
    pub frequency: Option<FrequencyRange>,
    /// Whether the processor says that a hypervisor is below it.
    pub has_hypervisor: Option<bool>,
    /// Kind of virtual machine, or `none`.
    pub virtual_machine: Option<String>,
    /// Kind of container, or `none`.
    pub container: Option<String>,
    /// Memory, bytes.
    pub memory_total_bytes: Option<u64>,
    /// Who gets huge pages: `always`, `madvise` or `never`.
    pub transparent_huge_pages: Option<String>,
    /// Cores that the scheduler leaves alone (`isolcpus`).
    pub isolated_cores: Option<Vec<u32>>,
    /// Cores without a periodic tick (`nohz_full`).
    pub tickless_cores: Option<Vec<u32>>,
    /// The scheduler's settings `/proc/sys/kernel/sched_*`; empty when there are none.
    pub scheduler_settings: BTreeMap<String, String>,
    /// How far this thread's timers may be put off, ns; not those of real-time threads.
    pub timer_slack_ns: Option<u64>,
    /// Highest real-time priority without privilege (`RLIMIT_RTPRIO`).
    pub realtime_priority_limit: Limit,
    /// Bytes that may be locked without privilege (`RLIMIT_MEMLOCK`).
    pub locked_memory_limit: Limit,
    /// Whether this process may use `SCHED_FIFO`: it was tried.
    pub may_use_fifo: Option<bool>,
}

impl Fingerprint {
    /// Of this computer and this process. Nothing fails: what can not be read is `None`.
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
            usable_cores: scheduling::usable_cores(),
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
            timer_slack_ns: scheduling::timer_slack_ns(),
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

/// ARM computers name the board where x86 names the processor.
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

/// Folders `cpu0`, `cpu1` and so on.
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

/// Present frequencies of the cores, kHz; by the frequency driver, else by
/// `/proc/cpuinfo`.
pub(crate) fn frequencies_khz(files: &SystemFiles, cpuinfo: &str) -> Vec<u64> {
    let told: Vec<u64> = core_folders(files)
        .iter()
        .filter_map(|core| files.number(&format!("{core}/cpufreq/scaling_cur_freq")))
        .collect();
    if told.is_empty() {
        text::cpuinfo_frequencies_khz(cpuinfo)
    } else {
        told
    }
}

/// Changes of frequency since the start, of all cores; `None` where they are not counted.
pub(crate) fn n_frequency_changes(files: &SystemFiles) -> Option<u64> {
    let counts: Vec<u64> = core_folders(files)
        .iter()
        .filter_map(|core| files.number(&format!("{core}/cpufreq/stats/total_trans")))
        .collect();
    (!counts.is_empty()).then(|| counts.iter().sum())
}

fn frequency(files: &SystemFiles, cpuinfo: &str) -> Option<FrequencyRange> {
    let told = frequencies_khz(files, cpuinfo);
    Some(FrequencyRange {
        lowest_khz: *told.iter().min()?,
        highest_khz: *told.iter().max()?,
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
    if let Some(told) = files.text("run/systemd/container") {
        return Some(told);
    }
    let marks = [(".dockerenv", "docker"), ("run/.containerenv", "podman")];
    if let Some((_, name)) = marks.iter().find(|(mark, _)| files.has(mark)) {
        return Some((*name).to_owned());
    }
    files
        .text("proc/1/cgroup")
        .map(|cgroup| text::container(&cgroup))
}

/// The file is empty when no core is isolated.
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
    fn what_is_not_there_is_none() {
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
    fn what_is_there_is_read() {
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
        fn rubbish_in_the_files_is_survived(bytes in prop::collection::vec(any::<u8>(), 0..80)) {
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
