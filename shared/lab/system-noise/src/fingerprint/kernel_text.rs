//! Parsers of the kernel's description of the computer (`/proc/cpuinfo`, `/proc/meminfo`,
//! `/sys`).

/// Maximum core number accepted in a list; larger numbers are malformed.
const CORES_MAX: u32 = 65_536;

/// Value of the first line `key : value` of `/proc/cpuinfo`.
pub(crate) fn cpuinfo_value<'a>(cpuinfo: &'a str, key: &str) -> Option<&'a str> {
    let pairs = cpuinfo.lines().filter_map(|line| line.split_once(':'));
    let mut values = pairs.filter(|(name, _)| name.trim() == key);
    let value = values.next()?.1.trim();
    (!value.is_empty()).then_some(value)
}

/// Processor model from `/proc/cpuinfo`, whose key depends on the architecture.
pub(crate) fn cpu_model(cpuinfo: &str) -> Option<String> {
    let keys = ["model name", "Model", "Hardware", "cpu model", "uarch"];
    let model = keys.iter().find_map(|key| cpuinfo_value(cpuinfo, key));
    model.map(str::to_owned)
}

/// `true` if the CPU flags show a hypervisor; `None` on architectures without such flags.
pub(crate) fn has_hypervisor(cpuinfo: &str) -> Option<bool> {
    let flags = cpuinfo_value(cpuinfo, "flags")?;
    Some(flags.split_whitespace().any(|flag| flag == "hypervisor"))
}

/// Current frequencies of the cores from `/proc/cpuinfo`, kHz.
pub(crate) fn cpuinfo_frequencies_khz(cpuinfo: &str) -> Vec<u64> {
    let pairs = cpuinfo.lines().filter_map(|line| line.split_once(':'));
    let values = pairs.filter(|(name, _)| name.trim() == "cpu MHz");
    let mhz = values.filter_map(|(_, value)| value.trim().parse::<f64>().ok());
    mhz.filter(|mhz| (1.0..1e6).contains(mhz))
        .map(|mhz| (mhz * 1000.0).round() as u64)
        .collect()
}

/// Parses a core list such as `0-3,8`; `None` if it is malformed.
pub(crate) fn core_list(text: &str) -> Option<Vec<u32>> {
    let mut cores = Vec::new();
    for part in text.trim().split(',').filter(|part| !part.is_empty()) {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let (first, last): (u32, u32) = (first.trim().parse().ok()?, last.trim().parse().ok()?);
        if last >= CORES_MAX {
            return None;
        }
        cores.extend(first..=last);
    }
    cores.sort_unstable();
    cores.dedup();
    Some(cores)
}

/// Selected word, in brackets or parentheses, of a list of choices such as `always [madvise]
/// never`.
pub(crate) fn chosen(text: &str) -> Option<String> {
    let mut words = text.split_whitespace();
    words.find_map(|word| {
        let square = word.strip_prefix('[').and_then(|w| w.strip_suffix(']'));
        let round = || word.strip_prefix('(').and_then(|w| w.strip_suffix(')'));
        square.or_else(round).map(str::to_owned)
    })
}

/// Value of a key of `/proc/meminfo`, bytes.
pub(crate) fn meminfo_bytes(meminfo: &str, key: &str) -> Option<u64> {
    let pairs = meminfo.lines().filter_map(|line| line.split_once(':'));
    let (_, value) = pairs.into_iter().find(|(name, _)| *name == key)?;
    let kilobytes: u64 = value.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// Parses a size such as `32768K`, bytes.
pub(crate) fn size_bytes(text: &str) -> Option<u64> {
    let text = text.trim();
    let unit = match text.chars().last()? {
        'K' => 1 << 10,
        'M' => 1 << 20,
        'G' => 1 << 30,
        _ => 1,
    };
    let number: u64 = text.trim_end_matches(['K', 'M', 'G']).parse().ok()?;
    number.checked_mul(unit)
}

/// Preemption model of the kernel: from its version, from `debug/sched/preempt` if readable, and
/// from its command line.
pub(crate) fn preemption(
    version: &str,
    debug_preempt: Option<&str>,
    command_line: Option<&str>,
) -> String {
    let has = |word: &str| version.split_whitespace().any(|part| part == word);
    if has("PREEMPT_RT") {
        return "real-time".to_owned();
    }
    if !has("PREEMPT_DYNAMIC") {
        let model = if has("PREEMPT") {
            "full"
        } else {
            "none or voluntary"
        };
        return model.to_owned();
    }
    let words = command_line.unwrap_or_default().split_whitespace();
    let mut asked = words.filter_map(|word| word.strip_prefix("preempt="));
    let mode = debug_preempt
        .and_then(chosen)
        .or_else(|| asked.next_back().map(str::to_owned));
    match mode {
        Some(mode) => format!("dynamic ({mode})"),
        None => "dynamic (which one is not told)".to_owned(),
    }
}

/// Kind of virtual machine; `none` if nothing indicates one.
pub(crate) fn virtual_machine(
    has_hypervisor: Option<bool>,
    product: Option<&str>,
    clock_sources: Option<&str>,
) -> Option<String> {
    const PRODUCTS: [(&str, &str); 8] = [
        ("vmware", "VMware"),
        ("virtualbox", "VirtualBox"),
        ("hyper-v", "Hyper-V"),
        ("microsoft", "Hyper-V"),
        ("xen", "Xen"),
        ("qemu", "QEMU"),
        ("kvm", "KVM"),
        ("parallels", "Parallels"),
    ];
    let product = product.unwrap_or_default().to_lowercase();
    let known = PRODUCTS.iter().find(|(word, _)| product.contains(word));
    // Hyper-V's vendor also builds computers; only the CPU flag is conclusive.
    let known = known.filter(|(word, _)| *word != "microsoft" || has_hypervisor == Some(true));
    if let Some((_, name)) = known {
        return Some((*name).to_owned());
    }
    if clock_sources.is_some_and(|sources| sources.contains("kvm-clock")) {
        return Some("KVM".to_owned());
    }
    let name = if has_hypervisor? {
        "unnamed hypervisor"
    } else {
        "none"
    };
    Some(name.to_owned())
}

/// Kind of container, from the control groups of process 1; `none` if nothing indicates one.
pub(crate) fn container(cgroup: &str) -> String {
    let words = ["docker", "kubepods", "lxc", "libpod", "containerd"];
    let found = words.iter().find(|word| cgroup.contains(**word));
    (*found.unwrap_or(&"none")).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CPUINFO: &str = "processor\t: 0\nmodel name\t: AMD EPYC\ncpu MHz\t\t: 2596.144\n\
        flags\t\t: fpu tsc hypervisor lm\n\nprocessor\t: 1\nmodel name\t: AMD EPYC\ncpu MHz\t\t: 3100.0\n";

    #[test]
    fn a_processor_is_read() {
        assert_eq!(cpu_model(CPUINFO).as_deref(), Some("AMD EPYC"));
        assert_eq!(has_hypervisor(CPUINFO), Some(true));
        assert_eq!(cpuinfo_frequencies_khz(CPUINFO), [2_596_144, 3_100_000]);
        let pi = "processor : 0\nFeatures : fp asimd\nModel : Raspberry Pi 5\n";
        assert_eq!(cpu_model(pi).as_deref(), Some("Raspberry Pi 5"));
        assert_eq!(has_hypervisor(pi), None);
    }

    #[test]
    fn core_lists_are_parsed_and_malformed_ones_refused() {
        assert_eq!(core_list("0-2,5\n"), Some(vec![0, 1, 2, 5]));
        assert_eq!(core_list(""), Some(vec![]));
        for rubbish in ["x", "1-", "0-99999999", "(null)"] {
            assert_eq!(core_list(rubbish), None, "{rubbish}");
        }
    }

    #[test]
    fn chosen_word_is_in_brackets() {
        assert_eq!(chosen("always [madvise] never").as_deref(), Some("madvise"));
        assert_eq!(chosen("none (full) lazy").as_deref(), Some("full"));
        assert_eq!(chosen("always never"), None);
    }

    #[test]
    fn sizes_are_bytes() {
        let meminfo = "MemTotal:       24117248 kB\nMemFree: 1 kB\n";
        assert_eq!(meminfo_bytes(meminfo, "MemTotal"), Some(24_117_248 * 1024));
        assert_eq!(meminfo_bytes(meminfo, "SwapTotal"), None);
        assert_eq!(size_bytes("32768K"), Some(32 << 20));
        assert_eq!(size_bytes("K"), None);
    }

    #[test]
    fn preemption_follows_from_version_and_mode() {
        let of = |version, debug, line| preemption(version, debug, line);
        assert_eq!(of("#1 SMP PREEMPT_RT", None, None), "real-time");
        assert_eq!(
            of(
                "#1 SMP PREEMPT_DYNAMIC @0",
                Some("none (full) lazy"),
                Some("preempt=none")
            ),
            "dynamic (full)"
        );
        assert_eq!(
            of("#1 SMP PREEMPT_DYNAMIC", None, Some("quiet preempt=none")),
            "dynamic (none)"
        );
        assert_eq!(of("#1 SMP PREEMPT Debian", None, None), "full");
        assert_eq!(of("#1 SMP Debian", None, None), "none or voluntary");
    }

    #[test]
    fn virtual_machines_are_named() {
        let of = |flag, product, clocks| virtual_machine(flag, product, clocks);
        assert_eq!(
            of(Some(true), Some("VMware, Inc."), None).as_deref(),
            Some("VMware")
        );
        assert_eq!(
            of(Some(true), None, Some("tsc kvm-clock")).as_deref(),
            Some("KVM")
        );
        assert_eq!(
            of(Some(true), None, None).as_deref(),
            Some("unnamed hypervisor")
        );
        assert_eq!(
            of(Some(false), Some("Microsoft Surface"), Some("tsc hpet")).as_deref(),
            Some("none")
        );
        assert_eq!(of(None, None, None), None);
        assert_eq!(container("0::/docker/4f"), "docker");
        assert_eq!(container("0::/init.scope"), "none");
    }

    proptest! {
        #[test]
        fn malformed_text_is_survived(text in "\\PC{0,200}|[0-9,:\\- \\[\\]()KMG\\n]{0,60}") {
            let _ = (cpu_model(&text), has_hypervisor(&text), cpuinfo_frequencies_khz(&text));
            let _ = (core_list(&text), chosen(&text), size_bytes(&text));
            let _ = (meminfo_bytes(&text, "MemTotal"), container(&text));
            let _ = preemption(&text, Some(&text), Some(&text));
            let _ = virtual_machine(Some(true), Some(&text), Some(&text));
        }
    }
}
