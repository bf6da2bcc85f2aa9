//! What must not change a single byte.

use glam::DVec3;
use qsplat::bake::{DEFAULT_EFFORT, MaxError, Options};
use qsplat::model::cloud::Cloud;

use super::scene::{Draw, bake, cloud, options};

fn bowl(scale: f64) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut draw = Draw(11);
    (0..3000)
        .map(|_| {
            let (x, y) = (draw.both(), draw.both());
            let normal = DVec3::new(-0.8 * x, -0.2 * y, 1.0);
            (DVec3::new(x, y, 0.4 * x * x + 0.1 * y * y) * scale, normal)
        })
        .unzip()
}

#[test]
fn neither_order_nor_repetition_nor_a_power_of_two_changes_the_splats() {
    let (places, normals) = bowl(1.0);
    for normals in [&normals[..], &[]] {
        let bytes = |order: &[usize]| {
            let at =
                |values: &[DVec3]| order.iter().filter_map(|&n| values.get(n).copied()).collect::<Vec<_>>();
            bake(&cloud(&at(&places), &at(normals)), &options(MaxError::Relative(1e-3))).bytes
        };
        let mut order: Vec<usize> = (0..places.len()).collect();
        let first = bytes(&order);
        Draw(12).shuffle(&mut order);
        assert_eq!(first, bytes(&order), "order");
        let twice: Vec<usize> = order.iter().chain(&order).copied().collect();
        assert_eq!(first, bytes(&twice), "repetition");
    }
    let splats = |scale: f64| {
        let (places, normals) = bowl(scale);
        bake(&cloud(&places, &normals), &options(MaxError::Relative(1e-3))).asset.splats
    };
    assert_eq!(splats(1.0), splats(2.0));
    assert_eq!(splats(1.0), splats(2.0_f64.powi(-40)));
}

/// Two planes that meet along `Y`, so that there is a crease to find.
fn roof() -> (Vec<DVec3>, Vec<DVec3>) {
    let mut draw = Draw(17);
    let (mut places, mut normals) = (Vec::new(), Vec::new());
    for _ in 0..4000 {
        let (x, y) = (draw.both(), draw.both());
        places.push(DVec3::new(x, y, -0.8 * x.abs()));
        normals.push(DVec3::new(0.8 * x.signum(), 0.0, 1.0).normalize());
    }
    (places, normals)
}

#[test]
fn neither_order_nor_threads_change_the_bytes_at_any_effort() {
    for (what, (places, normals)) in [("bowl", bowl(1.0)), ("roof", roof())] {
        let mut order: Vec<usize> = (0..places.len()).collect();
        let plain = cloud(&places, &normals);
        Draw(13).shuffle(&mut order);
        let at = |values: &[DVec3]| order.iter().map(|&n| values[n]).collect::<Vec<_>>();
        let changed = cloud(&at(&places), &at(&normals));
        for effort in [3, DEFAULT_EFFORT, DEFAULT_EFFORT + 1] {
            let options = Options { effort, ..options(MaxError::Relative(1e-3)) };
            let on = |threads: usize, cloud: &Cloud| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| bake(cloud, &options).bytes)
            };
            let expected = on(1, &plain);
            assert_eq!(expected, on(3, &plain), "{what} at effort {effort}: threads");
            assert_eq!(expected, on(2, &changed), "{what} at effort {effort}: order");
        }
    }
}
