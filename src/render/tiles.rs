//! Draws many small things into a picture, tile by tile: the loop behind the CPU reference.
//!
//! A tile holds all that happens to its pixels, so tiles run side by side, and each visits
//! its items in their order: the picture does not depend on the number of threads.

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use super::composite::{self, Blend};
use super::eye::{Eye, Ray};
use super::project::Bound;

/// Side of a tile in samples: its buffers stay in the first-level cache.
const TILE: u32 = 32;

/// Where a ray meets an item.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// View depth.
    pub depth: f64,
    /// The item's own coordinates of the place.
    pub at: DVec2,
    /// Squared distance from the item's centre, 1 at its rim; 0 for items without a centre.
    pub ellipse: f64,
    /// How much deeper another hit may lie and still be seen instead; 0 but beside a clip curve.
    pub gives_way: f64,
}

impl Hit {
    /// The depth by which it is seen or not.
    fn order(&self) -> f64 {
        self.depth + self.gives_way
    }
}

/// What an item looks like at a hit.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Unit normal in view coordinates, on either side.
    pub normal: DVec3,
    /// Linear colour.
    pub color: Vec3,
}

/// Many things that rays can meet, by index.
pub trait Scene: Sync {
    /// How many.
    fn len(&self) -> usize;
    /// The screen bound of one, or `None` when the near plane hides it.
    fn bound(&self, item: usize) -> Option<Bound>;
    /// Visits bounds that together hold as much of one as [`Self::bound`], and perhaps fewer samples; some of them
    /// more than once.
    fn bounds(&self, item: usize, visit: &mut dyn FnMut(&Bound)) {
        if let Some(bound) = self.bound(item) {
            visit(&bound);
        }
    }
    /// The nearest hit of one in front of the near plane.
    fn hit(&self, item: usize, ray: &Ray) -> Option<Hit>;
    /// How one looks at a hit.
    fn look(&self, item: usize, at: DVec2) -> Look;
    /// The colour of one by kind, see [`super::constants::tint`].
    fn tint(&self, _item: usize) -> usize {
        0
    }
}

/// A pixel's surface, in view coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Pixel {
    /// The item that was hit first, not counting what gives way, or after blending the one seen nearest its centre.
    pub item: usize,
    /// View depth of the first hit.
    pub depth: f64,
    /// Unit normal of the first hit, or blended, turned towards the eye.
    pub normal: DVec3,
    /// Linear colour of the first hit, or blended.
    pub color: Vec3,
    /// The ray for each unit of view depth.
    pub direction: DVec3,
    /// Items that the ray met, at any depth.
    pub met: u32,
    /// [`Hit::gives_way`] of the first hit.
    pub gives_way: f64,
}

/// How the hits of one pixel come together.
#[derive(Clone, Copy, Debug)]
pub enum Mix {
    /// The nearest alone.
    Nearest,
    /// Those within a band behind the nearest that face the same way.
    Band {
        /// Thickness along the normal, model units.
        band: f64,
        /// Least cosine between the normals.
        agree: f64,
    },
}

/// Draws a scene and turns each pixel into a value, rows from the top.
///
/// `paint` sees the pixels that were hit; the others become `background`.
pub fn draw<S: Scene, T: Copy + Send + Sync>(
    scene: &S,
    eye: &Eye,
    mix: Mix,
    background: T,
    paint: impl Fn(&Pixel) -> T + Sync,
) -> Vec<T> {
    let [width, height] = eye.size;
    let mut picture = vec![background; width as usize * height as usize];
    let rects: Vec<Rect> = (0..scene.len())
        .into_par_iter()
        .map(|item| scene.bound(item).map_or(Rect::EMPTY, |bound| Rect::of(&bound, eye.size)))
        .collect();
    let bands = picture.par_chunks_mut((TILE * width) as usize).enumerate();
    bands.for_each(|(band, rows)| {
        let y = band as u32 * TILE;
        let strip = Rect { x: [0, width], y: [y, height.min(y + TILE)] };
        let here: Vec<u32> = (0..rects.len() as u32).filter(|&n| rects[n as usize].meets(&strip)).collect();
        let columns: Vec<u32> = (0..width).step_by(TILE as usize).collect();
        let tiles: Vec<Vec<Option<Pixel>>> = columns
            .par_iter()
            .map(|&x| {
                let tile = Tile { area: Rect { x: [x, width.min(x + TILE)], y: strip.y }, eye, mix };
                tile.draw(scene, &rects, &here)
            })
            .collect();
        for (&x, tile) in columns.iter().zip(&tiles) {
            let across = width.min(x + TILE) - x;
            for (row, line) in rows.chunks_exact_mut(width as usize).zip(tile.chunks_exact(across as usize)) {
                for (out, pixel) in row[x as usize..].iter_mut().zip(line) {
                    if let Some(pixel) = pixel {
                        *out = paint(pixel);
                    }
                }
            }
        }
    });
    picture
}

/// How deep the nearest hit of each sample lies, rows from the top; infinite where nothing is hit. The
/// same as [`draw`] tells, for much less work, on this thread alone.
pub fn depths<S: Scene>(scene: &S, eye: &Eye) -> Vec<f64> {
    let [width, height] = eye.size;
    let mut depths = vec![f64::INFINITY; width as usize * height as usize];
    let all = Tile { area: Rect::whole(eye.size), eye, mix: Mix::Nearest };
    for item in 0..scene.len() {
        scene.bounds(item, &mut |bound| {
            all.samples(&Rect::of(bound, eye.size), |place, ray| {
                if let Some(hit) = scene.hit(item, ray) {
                    depths[place] = depths[place].min(hit.depth);
                }
            });
        });
    }
    depths
}

/// A half-open rectangle of samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rect {
    x: [u32; 2],
    y: [u32; 2],
}

impl Rect {
    /// No samples.
    const EMPTY: Self = Self { x: [0; 2], y: [0; 2] };

    /// The samples of a picture whose middles lie in a bound.
    pub(super) fn of(bound: &Bound, size: [u32; 2]) -> Self {
        // Casts saturate, and a NaN becomes 0: the rectangle stays inside the picture.
        let span = |min: f64, max: f64, side: u32| {
            let from = (min - 0.5).ceil().max(0.0) as u32;
            let to = (max + 0.5).floor().max(0.0) as u32;
            [from.min(side), to.min(side)]
        };
        Self { x: span(bound.min.x, bound.max.x, size[0]), y: span(bound.min.y, bound.max.y, size[1]) }
    }

    /// All samples of a picture.
    pub(super) fn whole([width, height]: [u32; 2]) -> Self {
        Self { x: [0, width], y: [0, height] }
    }

    /// How many samples.
    pub(super) fn count(&self) -> u32 {
        let side = |[from, to]: [u32; 2]| to.saturating_sub(from);
        side(self.x) * side(self.y)
    }

    /// Calls `visit` with each of these samples that lies in an area: its place in the area's rows, and its
    /// column and row.
    pub(super) fn samples_in(&self, area: &Self, mut visit: impl FnMut(usize, [u32; 2])) {
        let cut = self.cut(area);
        let across = (area.x[1] - area.x[0]) as usize;
        for y in cut.y[0]..cut.y[1] {
            let row = (y - area.y[0]) as usize * across;
            for x in cut.x[0]..cut.x[1] {
                visit(row + (x - area.x[0]) as usize, [x, y]);
            }
        }
    }

    /// What two rectangles share; perhaps empty.
    fn cut(&self, other: &Self) -> Self {
        let span = |a: [u32; 2], b: [u32; 2]| [a[0].max(b[0]), a[1].min(b[1])];
        Self { x: span(self.x, other.x), y: span(self.y, other.y) }
    }

    /// Whether two rectangles share a sample.
    fn meets(&self, other: &Self) -> bool {
        let cut = self.cut(other);
        cut.x[0] < cut.x[1] && cut.y[0] < cut.y[1]
    }
}

/// One tile at work.
struct Tile<'a> {
    area: Rect,
    eye: &'a Eye,
    mix: Mix,
}

impl Tile<'_> {
    /// Visibility, then attributes; pixels in rows.
    fn draw<S: Scene>(&self, scene: &S, rects: &[Rect], strip: &[u32]) -> Vec<Option<Pixel>> {
        let here: Vec<u32> = strip.iter().copied().filter(|&n| rects[n as usize].meets(&self.area)).collect();
        let mut pixels = self.visibility(scene, rects, &here);
        if let Mix::Band { band, agree } = self.mix {
            self.attributes(scene, rects, &here, &mut pixels, band, agree);
        }
        pixels
    }

    /// Calls `visit` with each sample of an item's rectangle in the tile.
    fn samples(&self, rect: &Rect, mut visit: impl FnMut(usize, &Ray)) {
        rect.samples_in(&self.area, |place, sample| visit(place, &self.eye.ray_through(sample)));
    }

    /// The nearest hit of each pixel, unless it gives way; of equally near ones, the first.
    fn visibility<S: Scene>(&self, scene: &S, rects: &[Rect], here: &[u32]) -> Vec<Option<Pixel>> {
        let count = (self.area.x[1] - self.area.x[0]) * (self.area.y[1] - self.area.y[0]);
        let mut nearest: Vec<Option<(Hit, usize)>> = vec![None; count as usize];
        let mut met = vec![0_u32; count as usize];
        for item in here.iter().map(|&n| n as usize) {
            self.samples(&rects[item], |place, ray| {
                let Some(hit) = scene.hit(item, ray) else { return };
                met[place] += 1;
                if nearest[place].is_none_or(|(old, _)| hit.order() < old.order()) {
                    nearest[place] = Some((hit, item));
                }
            });
        }
        let mut pixels = vec![None; count as usize];
        self.samples(&self.area, |place, ray| {
            pixels[place] = nearest[place].map(|(hit, item)| {
                let (look, direction) = (scene.look(item, hit.at), ray.direction());
                let normal = composite::face(look.normal, direction);
                let Hit { depth, gives_way, .. } = hit;
                Pixel { item, depth, normal, color: look.color, direction, met: met[place], gives_way }
            });
        });
        pixels
    }

    /// Blends into each pixel what lies within the band behind it and faces the same way.
    fn attributes<S: Scene>(
        &self,
        scene: &S,
        rects: &[Rect],
        here: &[u32],
        pixels: &mut [Option<Pixel>],
        band: f64,
        agree: f64,
    ) {
        let mut blends: Vec<Blend> =
            pixels.iter().map(|pixel| Blend::new(pixel.map_or(0, |pixel| pixel.item))).collect();
        let limits: Vec<f64> = pixels
            .iter()
            .map(|pixel| {
                pixel.map_or(f64::NEG_INFINITY, |p| {
                    p.depth + composite::depth_band(band, p.normal, p.direction)
                })
            })
            .collect();
        for item in here.iter().map(|&n| n as usize) {
            self.samples(&rects[item], |place, ray| {
                let Some(pixel) = &pixels[place] else { return };
                let Some(hit) = scene.hit(item, ray) else { return };
                // What gives way by more is of the other side of an edge, or of this one and no better.
                if hit.depth <= limits[place] && hit.gives_way <= pixel.gives_way {
                    let look = scene.look(item, hit.at);
                    let normal = composite::face(look.normal, pixel.direction);
                    if normal.dot(pixel.normal) >= agree {
                        blends[place].add(item, hit.ellipse, normal, look.color);
                    }
                }
            });
        }
        for (pixel, blend) in pixels.iter_mut().zip(&blends) {
            if let Some(pixel) = pixel {
                (pixel.normal, pixel.color) = blend.mean();
                pixel.item = blend.item;
            }
        }
    }
}
