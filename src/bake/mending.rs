//! Ends a cover: its clip curves are told thriftily, and what shows is mended.

use super::Saving;
use super::looking::Looking;
use crate::error::Result;
use crate::model::asset::Asset;
use crate::model::sight::Faults;
use crate::model::splat::Splat;
use crate::model::trial::Trial;
use crate::sample::candidates::Regions;
use crate::sample::cover::{Choice, Cover};
use crate::sample::grow::Grower;

/// Faults are looked for and mended at most so many times: what mends one is cut a little otherwise once
/// it is stored, and may show elsewhere. Five do on the models measured, but for what no splats mend.
pub(super) const MENDINGS: usize = 6;

/// All that a cover is ended with.
pub(super) struct Mending<'a> {
    pub(super) grower: &'a Grower<'a>,
    pub(super) regions: &'a Regions,
    /// Model units.
    pub(super) max_error: f64,
    /// What tells clip curves thriftily; `None` where partners cut, not lines.
    pub(super) saving: Option<&'a Saving<'a>>,
    /// Splats as whoever looks at them takes them.
    pub(super) asset: &'a dyn Fn(Vec<Splat>) -> Asset,
}

impl Mending<'_> {
    /// Tells clip curves thriftily.
    pub(super) fn save(&self, cover: &mut Cover) -> Result<()> {
        let Some(saving) = self.saving else { return Ok(()) };
        let max_error = self.max_error;
        let saving = |splats: &mut [Splat], trial: &mut dyn Trial| saving(splats, max_error, trial);
        cover.save(self.grower, self.regions, max_error, &saving)
    }

    /// Follows lines that nothing follows, and mends what is seen at most so many times; `choice` counts what was done.
    pub(super) fn mend(
        &self,
        cover: &mut Cover,
        choice: &mut Choice,
        times: usize,
        looking: &mut dyn Looking,
    ) -> Result<()> {
        let (grower, regions) = (self.grower, self.regions);
        for round in 0..times {
            let followed = if self.saving.is_some() { cover.follow(grower, regions) } else { 0 };
            let Faults { open, beside } = looking.faults(&(self.asset)(cover.splats()))?;
            let taken = cover.withdraw(grower, regions, &beside);
            let added = cover.seal(grower, regions, &open);
            choice.following += followed;
            choice.withdrawn += taken;
            choice.sealing += added;
            if followed + taken + added == 0 {
                break;
            }
            // Those added leave steps, and are told anew, as the first were: what this opens is seen in the next rounds.
            if round == 0 && added > 0 {
                self.save(cover)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::sync::Mutex;

    use glam::{DVec3, Vec3};

    use crate::bake::{Baked, Clips, Kept, Looking, Options, Silent, bake};
    use crate::error::Result;
    use crate::ingest::Input;
    use crate::model::asset::Asset;
    use crate::model::cloud::Cloud;
    use crate::model::mesh::Mesh;
    use crate::model::sight::{Faults, Sight};
    use crate::model::splat::Splat;
    use crate::model::trial::Trial;

    /// Sees some rays pass the first time that it looks, and nothing from then on.
    struct Once(Vec<Sight>);

    impl Looking for Once {
        fn at(&mut self, _: &Kept<'_>) -> Result<()> {
            Ok(())
        }

        fn faults(&mut self, _: &Asset) -> Result<Faults> {
            Ok(Faults { open: std::mem::take(&mut self.0), ..Faults::default() })
        }
    }

    /// A square, baked while rays pass it at some places; how many splats there were each time that clip curves were
    /// told.
    fn baked(clips: Clips, seen: &[DVec3]) -> (Baked, Vec<usize>) {
        let positions = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let vertices = Cloud { positions: positions.to_vec(), ..Cloud::default() };
        let square = Input::Mesh(Mesh { vertices, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() });
        let told = Mutex::new(Vec::new());
        let saving = |splats: &mut [Splat], _: f64, _: &mut dyn Trial| {
            told.lock().unwrap().push(splats.len());
            Ok(())
        };
        let sight = |&at: &DVec3| Sight { at, direction: DVec3::NEG_Z, beyond: 0.01 };
        let mut looking = Once(seen.iter().map(sight).collect());
        let options = Options { clips, ..Options::default() };
        let round = |splat: &Splat, _: f64, _: u8| Some(splat.clone());
        let baked = bake(&square, &options, &round, &saving, &mut looking, &mut Silent).unwrap();
        let mut told = told.into_inner().unwrap();
        told.dedup();
        (baked, told)
    }

    #[test]
    fn curves_are_told_once_more_with_the_splats_that_close_holes() {
        let (whole, told) = baked(Clips::Curved, &[]);
        let before = whole.asset.splats.len();
        assert_eq!((whole.choice.sealing, told), (0, vec![before]));
        let (mended, told) = baked(Clips::Curved, &[DVec3::new(0.3, 0.4, 0.0)]);
        assert_eq!((mended.choice.sealing, mended.asset.splats.len()), (1, before + 1));
        assert_eq!(told, [before, before + 1]);
    }

    #[test]
    fn where_partners_cut_no_curves_are_told() {
        assert!(baked(Clips::Partners, &[]).1.is_empty());
    }
}
