//! Depth discontinuities between neighbouring pixels.

/// Relative difference of disparity that counts as a discontinuity. A surface inclined by 83°
/// changes that much from pixel to pixel of a Kinect.
const JUMP: f32 = 0.015;
/// Number of pixels that are compared at once (SIMD).
const BLOCK: usize = 16;

/// True if the disparities of two neighbouring pixels, 0 for empty ones, differ by a
/// discontinuity.
#[inline]
pub(super) fn is_jump(a_px: f32, b_px: f32) -> bool {
    (a_px - b_px).abs() > JUMP * a_px.max(b_px)
}

/// Calls `visit` with each index for which `is_found(a[i], b[i])` holds, in ascending order.
///
/// Vector instructions skip the blocks without any.
#[inline]
pub(super) fn for_each_pair(
    a: &[f32],
    b: &[f32],
    is_found: impl Fn(f32, f32) -> bool,
    mut visit: impl FnMut(usize),
) {
    let len = a.len().min(b.len());
    let (a, b) = (&a[..len], &b[..len]);
    let blocks = a.chunks_exact(BLOCK).zip(b.chunks_exact(BLOCK));
    for (block, (a, b)) in blocks.enumerate() {
        let mut any = false;
        for i in 0..BLOCK {
            any |= is_found(a[i], b[i]);
        }
        if any {
            for i in 0..BLOCK {
                if is_found(a[i], b[i]) {
                    visit(block * BLOCK + i);
                }
            }
        }
    }
    for i in len - len % BLOCK..len {
        if is_found(a[i], b[i]) {
            visit(i);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discontinuities_are_found_in_order() {
        let a: Vec<f32> = (0..75)
            .map(|i| if i % 9 == 4 { 0.0 } else { 40.0 })
            .collect();
        let mut found = vec![];
        for_each_pair(&a, &a[1..], is_jump, |i| found.push(i));
        let expected: Vec<usize> = (0..74).filter(|i| i % 9 == 3 || i % 9 == 4).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn empty_neighbours_are_no_discontinuity() {
        assert!(!is_jump(0.0, 0.0) && is_jump(0.0, 40.0) && !is_jump(40.0, 40.4));
    }
}
