//! The rays on which an asset shows a hole, or anything beside the outline: what a bake has to mend.
//!
//! They are the rays of [`super::holes`], so that what is mended is what is counted, and for holes
//! as many midway between these: slits are narrower than a pixel, and those that no ray of the one lattice
//! meets show to others.

use glam::DVec3;
use rayon::prelude::*;

use super::holes::{self, Depths};
use super::views::{SIDE, View, views};
use crate::error::Result;
use crate::model::asset::Asset;
use crate::model::sight::{Faults, Sight};
use crate::model::splat::Splat;
use crate::render::Camera;
use crate::render::eye::Eye;
use crate::render::input::{Met, Model, Prepared, Style};
use crate::render::stops::Stops;

/// Pixels that the bound spans at most in a view whose extra pixels count. A view along a needle magnifies
/// it, and the bound with it: what stands out there is what the bound allows.
const WIDEST: f64 = 4.0;

/// What is known of a model in the views of [`views`], and of a mesh in those between: slits are more than what
/// a cloud tells of its surface. Nine bytes a pixel.
pub struct Sights {
    looks: Vec<Look>,
    /// The splats that were last looked at.
    last: Option<Vec<Splat>>,
}

/// One view of a model, and the faults that splats last showed in it.
struct Look {
    view: View,
    /// How far away the model lies.
    depths: Depths,
    /// Whether what stands out beside the outline counts.
    outlined: bool,
    /// Faults by their pixels, ascending.
    open: Vec<(usize, Sight)>,
    beside: Vec<(usize, Sight)>,
}

impl Sights {
    /// Looks at a mesh, or at the surface that a cloud tells of.
    ///
    /// # Errors
    /// [`crate::Error::Usage`] for a view that cannot be drawn.
    pub fn of(model: Model<'_>) -> Result<Self> {
        let input = Prepared::new(model, &Style::default());
        let mut all = views(model);
        let own = all.len();
        if input.is_exact() {
            let scale = model.cloud().frame.scale();
            let moved: Vec<View> = all.iter().map(|view| between(view, scale)).collect();
            all.extend(moved);
        }
        let cameras: Vec<Camera> = all.iter().map(|view| view.camera).collect();
        let met = input.all_met(&cameras, [SIDE; 2])?;
        let look = |(at, (view, met)): (usize, (View, Met))| {
            let depths = Depths::new([SIDE; 2], met);
            Look { view, depths, outlined: at < own, open: Vec::new(), beside: Vec::new() }
        };
        Ok(Self { looks: all.into_iter().zip(met).enumerate().map(look).collect(), last: None })
    }

    /// The rays of pixels that are missing or seen through, and of those that are extra, in the order of
    /// the views; extra ones of views that show the bound four pixels wide at most.
    ///
    /// Only holes are looked for along the views between: what stands out beside the outline is wider than
    /// a pixel where it counts. Pixels that show none of the splats that have come or gone since the last
    /// call show what they did.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn faults(&mut self, asset: &Asset) -> Result<Faults> {
        let changed = self.last.replace(asset.splats.clone()).map(|last| Asset {
            splats: [others(&asset.splats, &last), others(&last, &asset.splats)].concat(),
            ..asset.clone()
        });
        self.looks.par_iter_mut().try_for_each(|look| look.again(asset, changed.as_ref()))?;
        let sights = |of: fn(&Look) -> &[(usize, Sight)]| {
            self.looks.iter().flat_map(of).map(|&(_, sight)| sight).collect()
        };
        Ok(Faults { open: sights(|look| &look.open), beside: sights(|look| &look.beside) })
    }
}

impl Look {
    /// Looks again where splats have come or gone, or everywhere.
    fn again(&mut self, asset: &Asset, changed: Option<&Asset>) -> Result<()> {
        let eye = Eye::new(&self.view.camera, &asset.frame, [SIDE; 2])?;
        let all = || vec![true; SIDE as usize * SIDE as usize];
        let asked = changed.map_or_else(all, |changed| Stops::new(changed, &eye).touched());
        let behind = holes::behind(asset);
        let limits = holes::limits(&self.depths, &asked, behind);
        let stops = Stops::new(asset, &eye);
        let stopped = stops.within(&limits);
        let open = self.holes(&limits, &stopped, &stops, behind, &eye);
        renew(&mut self.open, open, &asked);
        if self.outlined && asset.max_error / self.view.height * f64::from(SIDE) <= WIDEST {
            renew(&mut self.beside, beside(&limits, &stopped, &eye), &asked);
        }
        Ok(())
    }

    /// The rays that meet the model and that no splat stops soon enough.
    fn holes(
        &self,
        limits: &[f64],
        stopped: &[Option<f64>],
        stops: &Stops<'_>,
        behind: f64,
        eye: &Eye,
    ) -> Vec<(usize, Sight)> {
        // Most rays are stopped before what lies behind their own pixel: only for the others it is asked
        // how deep those around reach.
        let mut farther = vec![f64::NEG_INFINITY; limits.len()];
        for (place, limit) in farther.iter_mut().enumerate() {
            if limits[place].is_finite() && stopped[place].is_none() {
                let [x, y] = pixel(place);
                *limit = holes::farthest(&self.depths, x, y) + behind;
            }
        }
        let stopped = stops.within(&farther);
        let missed =
            (0..farther.len()).filter(|&place| farther[place].is_finite() && stopped[place].is_none());
        let sight = |place: usize| {
            let [x, y] = pixel(place);
            let own = self.depths.at(x, y)?;
            let at = eye.place([x, y], own);
            Some((place, Sight { at, direction: eye.forward, beyond: farther[place] - own }))
        };
        missed.filter_map(sight).collect()
    }
}

/// The same view moved across by half a pixel of [`SIDE`] each way, so that each of its rays passes midway
/// between four; `scale` is the length of a model unit in input units.
fn between(view: &View, scale: f64) -> View {
    let mut moved = view.clone();
    let [eye, target, up] = [view.camera.eye, view.camera.target, view.camera.up].map(DVec3::from);
    let forward = (target - eye).normalize();
    let right = forward.cross(up).normalize();
    let pixel = scale * view.height / f64::from(SIDE);
    let by = 0.5 * pixel * (right + right.cross(forward));
    (moved.camera.eye, moved.camera.target) = ((eye + by).into(), (target + by).into());
    moved
}

/// The splats of one list that are not in another.
fn others(some: &[Splat], than: &[Splat]) -> Vec<Splat> {
    let mut known: Vec<&Splat> = than.iter().collect();
    known.sort_by(|a, b| a.center.x.total_cmp(&b.center.x));
    let is_known = |splat: &Splat| {
        let from = known.partition_point(|other| other.center.x < splat.center.x);
        let same = known[from..].iter().take_while(|other| other.center.x <= splat.center.x);
        same.into_iter().any(|&other| other == splat)
    };
    some.iter().filter(|splat| !is_known(splat)).cloned().collect()
}

/// The rays that pass beside the model and that a splat stops.
fn beside(limits: &[f64], stopped: &[Option<f64>], eye: &Eye) -> Vec<(usize, Sight)> {
    let extra = stopped.iter().enumerate().filter(|&(place, _)| limits[place] == f64::INFINITY);
    let sight = |(place, depth): (usize, &Option<f64>)| {
        let at = eye.place(pixel(place), (*depth)?);
        Some((place, Sight { at, direction: eye.forward, beyond: f64::INFINITY }))
    };
    extra.filter_map(sight).collect()
}

/// Puts what was found in some pixels in the place of what was known of them.
fn renew(known: &mut Vec<(usize, Sight)>, found: Vec<(usize, Sight)>, asked: &[bool]) {
    known.retain(|&(place, _)| !asked[place]);
    known.extend(found);
    known.sort_unstable_by_key(|&(place, _)| place);
}

/// The column and row of a pixel.
fn pixel(place: usize) -> [u32; 2] {
    [place as u32 % SIDE, place as u32 / SIDE]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::holes::Mark;
    use crate::measure::planted;
    use crate::measure::seen::Drawn;
    use crate::measure::seen::tests::{asset, disc, plane, squares};
    use crate::model::cloud::Cloud;
    use crate::model::frame::Frame;
    use crate::render::cpu;
    use glam::{DVec2, Vec3};

    /// How many pixels [`holes::compare`] marks as missing or seen through, and as extra.
    fn counted(asset: &Asset, model: Model<'_>) -> Result<[usize; 2]> {
        let input = Prepared::new(model, &Style::default());
        let mut counts = [0; 2];
        for view in views(model) {
            let depths = Drawn::new(&input, view.clone())?.depths;
            let splats = cpu::visibility(asset, &view.camera, [SIDE; 2])?;
            let map = holes::compare(&depths, &splats, holes::behind(asset));
            counts[0] += map.places(&[Mark::Missing, Mark::Through]).count();
            counts[1] += map.places(&[Mark::Extra]).count();
        }
        Ok(counts)
    }

    #[test]
    fn what_is_looked_for_is_what_is_counted_and_looking_again_tells_the_same() -> Result<()> {
        let (mut mesh, back) = (plane(0.1), plane(-0.1));
        mesh.vertices.positions.extend(back.vertices.positions);
        mesh.triangles.extend([[4, 5, 6], [4, 6, 7]]);
        let whole = [squares(0.1), squares(-0.1)].concat();
        let mut holed = whole.clone();
        holed.remove(5);
        holed.push(disc(DVec3::new(0.5, 0.1, 0.1), 0.02));
        let mut known = Sights::of(Model::Mesh(&mesh))?;
        let mut any = [0; 2];
        for splats in [holed.clone(), whole.clone(), holed[1..].to_vec(), holed] {
            let asset = asset(splats);
            let again = known.faults(&asset)?;
            let mut afresh = Sights::of(Model::Mesh(&mesh))?;
            assert_eq!(again, afresh.faults(&asset)?);
            afresh.looks.retain(|look| look.outlined);
            let own = |part: fn(&Look) -> usize| afresh.looks.iter().map(part).sum::<usize>();
            let found = [own(|look| look.open.len()), own(|look| look.beside.len())];
            assert_eq!(found, counted(&asset, Model::Mesh(&mesh))?);
            (0..2).for_each(|n| any[n] = any[n].max(found[n]));
        }
        assert!(any.iter().all(|&count| count > 100), "{any:?}");
        Ok(())
    }

    #[test]
    fn of_a_cloud_too_what_is_looked_for_is_what_is_counted() -> Result<()> {
        let at =
            |n: i32, height: f32| Vec3::new((n % 41 - 20) as f32 / 40.0, (n / 41 - 20) as f32 / 40.0, height);
        let positions = (0..41 * 41).flat_map(|n| [at(n, 0.1), at(n, -0.1)]).collect();
        let cloud = Cloud { positions, ..Cloud::default() };
        let discs = planted::discs(&cloud);
        let model = Model::Surface(&cloud, &discs);
        let whole = [squares(0.1), squares(-0.1)].concat();
        let mut faulty = whole.clone();
        faulty.remove(5);
        faulty.push(disc(DVec3::new(0.5, 0.1, 0.1), 0.1));
        for (splats, any) in [(whole, false), (faulty, true)] {
            let asset = asset(splats);
            let mut known = Sights::of(model)?;
            let Faults { open, beside } = known.faults(&asset)?;
            assert_eq!(known.looks.len(), 26, "none between");
            let found = [open.len(), beside.len()];
            assert_eq!(found, counted(&asset, model)?);
            assert!(found.iter().all(|&count| (count > 100) == any), "{found:?}");
        }
        Ok(())
    }

    #[test]
    fn moved_rays_pass_midway_between_four() -> Result<()> {
        let frame = Frame { origin: DVec3::new(1e3, -20.0, 3.0), exponent: 4 };
        let positions = vec![Vec3::ZERO, Vec3::new(0.5, 0.25, 0.125)];
        let cloud = Cloud { frame, positions, ..Cloud::default() };
        for view in views(Model::Cloud(&cloud)) {
            let moved = between(&view, frame.scale());
            let [own, other] = [&view, &moved].map(|view| Eye::new(&view.camera, &frame, [SIDE; 2]));
            let (own, other) = (own?, other?);
            let corners = [[7, 9], [8, 9], [7, 8], [8, 8]].map(|pixel| own.place(pixel, 1.0));
            let middle = corners.iter().sum::<DVec3>() / 4.0;
            let pixel = view.height / f64::from(SIDE);
            let off =
                DVec2::new(middle.distance(other.place([7, 9], 1.0)), own.forward.distance(other.forward));
            assert!(off.max_element() < 1e-6 * pixel.min(1.0), "{}: {off}", view.name);
        }
        Ok(())
    }
}
