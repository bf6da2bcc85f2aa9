//! Vertices that lie at one place.

use glam::Vec3;
use rayon::prelude::*;

/// Numbers the distinct positions, in an order of their own: the number of each vertex, and how many there are.
#[must_use]
pub fn numbered(positions: &[Vec3]) -> (Vec<u32>, usize) {
    // Adding 0 turns -0 into 0: they are one place.
    let key = |n: u32| (positions[n as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|&n| (key(n), n));
    let mut number = vec![0; positions.len()];
    let mut count = 0;
    for (n, &vertex) in order.iter().enumerate() {
        if n > 0 && key(order[n - 1]) != key(vertex) {
            count += 1;
        }
        number[vertex as usize] = count as u32;
    }
    (number, count + usize::from(!order.is_empty()))
}
