//! JPEG encoder for tests: one colour per block of 8 x 8 pixels.

/// Encodes a baseline JPEG of `columns` x `rows` blocks from their colours, row-major:
/// luminance and two chrominances.
pub(crate) fn encode(columns: u16, rows: u16, blocks: &[[u8; 3]]) -> Vec<u8> {
    let mut file = vec![0xff, 0xd8, 0xff, 0xdb, 0, 67, 0];
    file.extend([1; 64]);
    let [[h1, h0], [w1, w0]] = [8 * rows, 8 * columns].map(u16::to_be_bytes);
    file.extend([
        0xff, 0xc0, 0, 17, 8, h1, h0, w1, w0, 3, 1, 0x11, 0, 2, 0x11, 0, 3, 0x11, 0,
    ]);
    // DC categories 0 to 11 with codes of four bits; AC has only the end of a block.
    file.extend([
        0xff, 0xc4, 0, 31, 0x00, 0, 0, 0, 12, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    ]);
    file.extend(0..12);
    file.extend([
        0xff, 0xc4, 0, 20, 0x10, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    ]);
    file.extend([0xff, 0xda, 0, 12, 3, 1, 0, 2, 0, 3, 0, 0, 63, 0]);
    for byte in entropy_coded(blocks) {
        file.push(byte);
        if byte == 0xff {
            file.push(0);
        }
    }
    file.extend([0xff, 0xd9]);
    file
}

fn entropy_coded(blocks: &[[u8; 3]]) -> Vec<u8> {
    let mut bits: Vec<bool> = Vec::new();
    let mut push = |value: u16, n_bits: u32| {
        bits.extend((0..n_bits).rev().map(|bit| value >> bit & 1 == 1));
    };
    let mut previous = [0_i16; 3];
    for block in blocks {
        for (previous, &value) in previous.iter_mut().zip(block) {
            let coefficient = 8 * (i16::from(value) - 128);
            let difference = coefficient - std::mem::replace(previous, coefficient);
            let category = 16 - difference.unsigned_abs().leading_zeros();
            push(category as u16, 4);
            // Negative differences are stored less one.
            push((difference - i16::from(difference < 0)) as u16, category);
            push(0, 1);
        }
    }
    bits.resize(bits.len().next_multiple_of(8), true);
    bits.chunks(8)
        .map(|byte| byte.iter().fold(0, |sum, &bit| sum << 1 | u8::from(bit)))
        .collect()
}
