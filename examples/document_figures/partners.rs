//! P Figures 7 to 9: edges cut by clip partners, beside conics.

use image::{DynamicImage, RgbImage};
use qsplat::bake::{Clips, Edges, MaxError, Options, Silent};
use qsplat::measure::image::flip;
use qsplat::model::asset::Asset;
use qsplat::render::camera::{Camera, Framing, View};
use qsplat::render::input::Style;
use qsplat::render::{Settings, cpu, input};
use qsplat::{Result, deliver};

use super::models::{Model, external, parts};
use super::page::Page;

/// Error bounds, shares of the diagonal: coarse and default.
const BOUNDS: [f64; 2] = [0.003, 0.001];

/// Azimuths and elevations of the views, degrees: none looks along a face.
const VIEWS: [[f64; 2]; 6] =
    [[35.0, 25.0], [125.0, -20.0], [215.0, 30.0], [305.0, -35.0], [10.0, 70.0], [190.0, -65.0]];

/// Sides of the pictures.
const SIZE: [u32; 2] = [400, 400];

/// How far the pictures of splats are from those of their mesh.
struct Off {
    /// Mean FLIP over the views.
    flip: f64,
    /// Pixels at which the mesh shows and no splat does, over all views.
    missing: usize,
    /// Pixels at which a splat shows and the mesh does not.
    extra: usize,
}

/// The section.
///
/// # Errors
/// Those of reading, baking, drawing and writing.
pub fn make(page: &mut Page) -> Result<()> {
    page.section("P Figures 7 to 9: clip partners beside conics");
    page.say(
        "The document shows, by eye, that partners whose areas are classified leave no holes where \
         independent cuts do (Fig. 7), and that coarse models stay sharp (Fig. 9). Ours: each model baked \
         twice at the same bound, with curves along the lines found and with `--clips partners`, the same \
         splats but for how far they reach. *Independent* is the document's first strategy: the same \
         partners, each cutting by itself. FLIP is the mean over six views of 400 × 400 pixels, against \
         the mesh's picture; *missing* and *extra* count pixels over all of them. *Given up* counts cuts \
         that would have taken away what a splat must show: there it reaches over the edge.",
    );
    let mut models = parts()?;
    for file in ["abc-00000049.obj", "teapot.obj"] {
        models.extend(external(file)?);
    }
    let rows = models.iter().flat_map(|model| BOUNDS.map(|bound| row(model, bound)));
    let rows = rows.collect::<Result<Vec<_>>>()?;
    let columns = [
        "model",
        "bound / D",
        "splats, conics",
        "splats, partners",
        "pairs",
        "in groups",
        "given up",
        "bytes, conics",
        "bytes, partners",
        "FLIP, conics",
        "FLIP, partners",
        "FLIP, independent",
        "missing / extra, conics",
        "missing / extra, partners",
        "missing / extra, independent",
    ];
    page.table("partners", &columns, &rows)
}

fn row(model: &Model, bound: f64) -> Result<Vec<String>> {
    let bake = |clips: Clips| {
        let max_error = MaxError::Relative(bound);
        let options = Options { max_error, clips, edges: Edges::Auto, ..Options::default() };
        deliver::deliver(&model.input, &options, &mut Silent)
    };
    let (conics, partners) = (bake(Clips::Curved)?, bake(Clips::Partners)?);
    let tally = partners.baked.partners.unwrap_or_default();
    let assets = [&conics.asset, &partners.asset, &independent(&partners.asset)];
    let [a, b, c] = assets.map(|asset| off(model, asset));
    let offs = [a?, b?, c?];
    let mut row = vec![
        model.name.clone(),
        format!("{:.1} %", 100.0 * bound),
        conics.asset.splats.len().to_string(),
        partners.asset.splats.len().to_string(),
        tally.pairs.to_string(),
        (tally.intersected + tally.mixed).to_string(),
        tally.given_up.to_string(),
        conics.bytes.len().to_string(),
        partners.bytes.len().to_string(),
    ];
    row.extend(offs.iter().map(|off| format!("{:.4}", off.flip)));
    row.extend(offs.iter().map(|off| format!("{} / {}", off.missing, off.extra)));
    Ok(row)
}

/// The same splats, each partner cutting by itself.
fn independent(asset: &Asset) -> Asset {
    let mut asset = asset.clone();
    for splat in &mut asset.splats {
        splat.partners = splat.partners.iter().flatten().map(|&partner| vec![partner]).collect();
    }
    asset
}

fn off(model: &Model, asset: &Asset) -> Result<Off> {
    let settings = Settings { size: SIZE, ..Settings::default() };
    let (style, input) = (Style::default(), deliver::model(&model.input));
    let mut off = Off { flip: 0.0, missing: 0, extra: 0 };
    for [azimuth, elevation] in VIEWS {
        let view = View::Angles { azimuth, elevation };
        let camera = Camera::framing(&asset.frame, asset.diagonal, view, Framing::default(), SIZE);
        let mesh = rgb(input::render(input, &camera, &settings, &style)?.rgba);
        let splats = rgb(cpu::render(asset, &camera, &settings)?.rgba);
        off.flip += flip(&mesh, &splats)?.mean() / VIEWS.len() as f64;
        let mesh = input::visibility(input, &camera, SIZE, &style)?.seen;
        let splats = cpu::visibility(asset, &camera, SIZE)?.seen;
        let pixels = || mesh.iter().zip(&splats);
        off.missing += pixels().filter(|(mesh, splat)| mesh.is_some() && splat.is_none()).count();
        off.extra += pixels().filter(|(mesh, splat)| mesh.is_none() && splat.is_some()).count();
    }
    Ok(off)
}

fn rgb(picture: image::RgbaImage) -> RgbImage {
    DynamicImage::ImageRgba8(picture).to_rgb8()
}
