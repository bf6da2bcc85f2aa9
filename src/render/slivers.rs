//! Parts of a mesh so thin in the picture that no ray of it tells of them.
//!
//! A card seen along its plane, a wire, the tip of a spike: its picture runs through pixels between the middles
//! that their rays pass through.

use glam::DVec2;

use super::project::Bound;
use super::tiles::Rect;

/// From the middle of a pixel to its sides.
const HALF: f64 = 0.5;

/// The pixels of a picture whose rays meet a mesh, and those that it touches far from all of these.
pub(super) struct Slivers {
    size: [u32; 2],
    touched: Vec<bool>,
    /// Pixels whose rays meet the mesh, and the eight around each: there its outline is known.
    known: Vec<bool>,
}

impl Slivers {
    /// Of a picture whose pixels' rays meet a mesh or not, rows from the top.
    pub(super) fn beside(met: Vec<bool>, size: [u32; 2]) -> Self {
        let mut known = met.clone();
        for place in (0..met.len()).filter(|&place| met[place]) {
            let (x, y) = (place as u32 % size[0], place as u32 / size[0]);
            let columns = x.saturating_sub(1) as usize..size[0].min(x + 2) as usize;
            for y in y.saturating_sub(1)..size[1].min(y + 2) {
                let row = y as usize * size[0] as usize;
                known[row + columns.start..row + columns.end].fill(true);
            }
        }
        Self { size, touched: met, known }
    }

    /// Adds a convex polygon of the mesh as the picture shows it, in samples.
    pub(super) fn add(&mut self, polygon: &[DVec2; 4]) {
        let (min, max) = polygon.iter().fold((polygon[0], polygon[0]), |(a, b), &p| (a.min(p), b.max(p)));
        let rect = Rect::of(&Bound { min: min - HALF, max: max + HALF }, self.size);
        rect.samples_in(&Rect::whole(self.size), |place, [x, y]| {
            if !self.known[place] && !self.touched[place] {
                let middle = DVec2::new(f64::from(x), f64::from(y)) + HALF;
                self.touched[place] = is_touched(polygon, middle);
            }
        });
    }

    /// The pixels, rows from the top.
    pub(super) fn touched(self) -> Vec<bool> {
        self.touched
    }
}

/// Whether a polygon touches a pixel whose rows and columns it meets: none of its sides has all of it on the
/// other side (separating axes, Gottschalk, Lin and Manocha 1996).
fn is_touched(polygon: &[DVec2; 4], middle: DVec2) -> bool {
    let is_apart = |n: usize| {
        let across = (polygon[(n + 1) % 4] - polygon[n]).perp();
        let reach = HALF * (across.x.abs() + across.y.abs());
        let offsets = polygon.map(|corner| across.dot(corner - middle));
        offsets.iter().all(|&off| off > reach) || offsets.iter().all(|&off| off < -reach)
    };
    !(0..4).any(is_apart)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [u32; 2] = [8, 6];

    /// The pixels that a polygon adds beside some that rays meet, in rows of `o` and `#`.
    fn rows(met: &[[u32; 2]], polygon: [[f64; 2]; 4]) -> Vec<String> {
        let mut hit = vec![false; (SIZE[0] * SIZE[1]) as usize];
        met.iter().for_each(|&[x, y]| hit[(y * SIZE[0] + x) as usize] = true);
        let mut slivers = Slivers::beside(hit.clone(), SIZE);
        slivers.add(&polygon.map(DVec2::from));
        let letters = slivers.touched().into_iter().zip(hit).map(|pixel| match pixel {
            (true, true) => '#',
            (true, false) => 'o',
            _ => '.',
        });
        let letters: Vec<char> = letters.collect();
        letters.chunks_exact(SIZE[0] as usize).map(|row| row.iter().collect()).collect()
    }

    #[test]
    fn a_line_touches_the_pixels_that_it_runs_through_and_no_others() {
        let line = |a: [f64; 2], b: [f64; 2]| [a, b, b, a];
        let aslant = rows(&[], line([0.2, 4.6], [5.9, 0.3]));
        assert_eq!(aslant, ["....oo..", "...oo...", "..oo....", "ooo.....", "o.......", "........"]);
        let along = rows(&[], line([2.5, 1.1], [2.5, 3.9]));
        assert_eq!(along, ["........", "..o.....", "..o.....", "..o.....", "........", "........"]);
        let beyond = rows(&[], line([-9.0, 5.5], [90.0, 5.5]));
        assert_eq!(beyond, ["........", "........", "........", "........", "........", "oooooooo"]);
    }

    #[test]
    fn what_lies_beside_rays_that_meet_the_mesh_is_known() {
        let spike = [[1.2, 0.1], [1.9, 0.1], [6.9, 5.1], [6.9, 5.1]];
        let found = rows(&[[1, 0]], spike);
        assert_eq!(found, [".#......", "...o....", "...oo...", "....oo..", ".....oo.", "......o."]);
    }

    #[test]
    fn a_point_touches_one_pixel() {
        assert_eq!(rows(&[], [[3.4, 2.7]; 4])[2], "...o....");
    }
}
