//! Where depth jumps between neighbouring pixels.

/// Relative difference of disparity that is a jump. A surface inclined by
/// 83° changes that much from pixel to pixel of a Kinect.
const JUMP: f32 = 0.015;
/// Pixels that are compared at once.
const LANES: usize = 16;

/// Whether the surface is not the same on both sides. Nothing has disparity 0.
#[inline]
pub(super) fn is_jump(a_px: f32, b_px: f32) -> bool {
    (a_px - b_px).abs() > JUMP * a_px.max(b_px)
}

/// Calls `visit` with each index for which `is_found(a[i], b[i])`, in order.
///
/// Blocks without any are passed over with vector instructions.
#[inline]
pub(super) fn for_each_pair(
    a: &[f32],
    b: &[f32],
    is_found: impl Fn(f32, f32) -> bool,
    mut visit: impl FnMut(usize),
) {
    let len = a.len().min(b.len());
    let (a, b) = (&a[..len], &b[..len]);
    let blocks = a.chunks_exact(LANES).zip(b.chunks_exact(LANES));
    for (block, (a, b)) in blocks.enumerate() {
        let mut any = false;
        for i in 0..LANES {
            any |= is_found(a[i], b[i]);
        }
        if any {
            for i in 0..LANES {
                if is_found(a[i], b[i]) {
                    visit(block * LANES + i);
                }
            }
        }
    }
    for i in len - len % LANES..len {
        if is_found(a[i], b[i]) {
            visit(i);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_jump_is_found_in_order() {
        let a: Vec<f32> = (0..75)
            .map(|i| if i % 9 == 4 { 0.0 } else { 40.0 })
            .collect();
        let mut found = vec![];
        for_each_pair(&a, &a[1..], is_jump, |i| found.push(i));
        let expected: Vec<usize> = (0..74).filter(|i| i % 9 == 3 || i % 9 == 4).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn nothing_beside_nothing_is_no_jump() {
        assert!(!is_jump(0.0, 0.0) && is_jump(0.0, 40.0) && !is_jump(40.0, 40.4));
    }
}
