//! The icosahedron, each face divided and pushed out along its rays.

use glam::DVec3;

use super::surface::Surface;

/// The twelve corners: cyclic permutations of `(0, ±1, ±golden ratio)`, not yet unit.
const CORNERS: [[f64; 3]; 12] = {
    let g = 1.618_033_988_749_895;
    [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ]
};

/// The twenty faces, counter-clockwise seen from outside.
const FACES: [[usize; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];

/// A closed mesh of `10 f² + 2` vertices, each at `place(unit direction)`.
pub fn geodesic(frequency: usize, place: impl Fn(DVec3) -> DVec3) -> Surface {
    let mut surface = Surface::default();
    for face in FACES {
        let [a, b, c] = face.map(|n| DVec3::from_array(CORNERS[n]));
        let rows: Vec<Vec<u32>> = (0..=frequency)
            .map(|row| {
                (0..=frequency - row)
                    .map(|n| {
                        let weights = [frequency - row - n, n, row].map(|w| w as f64);
                        let ray = weights[0] * a + weights[1] * b + weights[2] * c;
                        surface.vertex(place(ray.normalize()))
                    })
                    .collect()
            })
            .collect();
        for pair in rows.windows(2) {
            let (low, high) = (&pair[0], &pair[1]);
            for n in 0..high.len() {
                surface.triangle([low[n], low[n + 1], high[n]], false);
                if n + 1 < high.len() {
                    surface.triangle([low[n + 1], high[n + 1], high[n]], false);
                }
            }
        }
    }
    surface
}
