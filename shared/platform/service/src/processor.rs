//! Check of the processor against the features that this build needs.
#![expect(unsafe_code, reason = "CPUID is an intrinsic function")]
#![allow(
    unused_unsafe,
    reason = "the intrinsic function is safe in later versions of Rust"
)]

/// Sentence about a processor that lacks what this build needs, or `None` where all is there.
///
/// To be called first in `main`: a program built for x86-64-v3 ends with an illegal instruction
/// on a processor that lacks one, at any later point.
#[inline(never)]
pub(crate) fn missing_features() -> Option<&'static str> {
    if has_avx2_and_fma() {
        return None;
    }
    Some(
        "this processor lacks AVX2, FMA or BMI2 (x86-64-v3, made since 2013), for which this \
         tabula was built; build it on this computer: scripts/run in the source tree does",
    )
}

/// `true` in a build for any processor of the architecture.
#[cfg(not(target_feature = "avx2"))]
fn has_avx2_and_fma() -> bool {
    true
}

/// AVX2, BMI2 and FMA by CPUID. `is_x86_feature_detected` is of no use here: it is constant in a
/// build that requires the feature.
#[cfg(target_feature = "avx2")]
fn has_avx2_and_fma() -> bool {
    use std::arch::x86_64::__cpuid_count;
    const OSXSAVE_AND_FMA: u32 = 1 << 27 | 1 << 12;
    const AVX2_AND_BMI2: u32 = 1 << 5 | 1 << 8;
    // SAFETY: every x86-64 processor has CPUID; leaf 0 gives the highest leaf.
    let highest_leaf = unsafe { __cpuid_count(0, 0) }.eax;
    if highest_leaf < 7 {
        return false;
    }
    // SAFETY: as above, the leaf exists.
    let features = unsafe { __cpuid_count(1, 0) }.ecx;
    // SAFETY: as above, the leaf exists.
    let extended = unsafe { __cpuid_count(7, 0) }.ebx;
    features & OSXSAVE_AND_FMA == OSXSAVE_AND_FMA && extended & AVX2_AND_BMI2 == AVX2_AND_BMI2
}

#[cfg(test)]
mod tests {
    #[test]
    fn processor_of_this_test_is_accepted() {
        // The test itself runs instructions of the features that it was built for.
        assert_eq!(super::missing_features(), None);
    }
}
