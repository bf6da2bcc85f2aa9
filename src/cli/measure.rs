//! `qsplat measure`: every error and cost of a file against its input.

use std::path::{Path, PathBuf};

use clap::Args;
use qsplat::bake::{Options, feature_lines, kept, meant};
use qsplat::deliver::{model, surface};
use qsplat::error::{Error, Result};
use qsplat::format;
use qsplat::measure::measures::GpuFrame;
use qsplat::measure::{self, Measures, Reference, Subject, align, cost};
use qsplat::model::asset::Asset;
use qsplat::render::device::Choice;
use qsplat::report::measured;
use qsplat::tolerance::DEFAULT_EDGE_ANGLE;

use super::progress::Style;
use super::{Notes, Outcome, bake, device, source};

/// Measures a .qsplat against the mesh or cloud it was baked from.
///
/// Distances both ways, normals, feature edges, holes and pictures from the 26 directions of the
/// cube, bytes and times. Distances are fractions of the diagonal of the input's bounding box.
/// docs/measure-schema.md says what each number means.
#[derive(Args)]
pub(super) struct Arguments {
    /// The .qsplat
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// What it was baked from
    #[arg(long, value_name = "INPUT")]
    against: PathBuf,
    /// Feature lines that the clipped borders are measured against, as in `bake`
    #[arg(long, value_name = "FILE|auto|none", default_value = "auto")]
    edges: String,
    /// Dihedral angle from which `--edges auto` takes an edge of a mesh, or a crease of a cloud, for a
    /// feature edge, degrees
    #[arg(long, value_name = "DEG", default_value_t = DEFAULT_EDGE_ANGLE, value_parser = bake::edge_angle)]
    edge_angle: f64,
    /// What the facets of a mesh stand for, as in `bake`
    #[arg(long, value_enum, default_value_t)]
    surface: bake::SurfaceArgument,
    /// Measures against the points of a cloud smoothed as `bake --denoise` does, where their noise
    /// asks for it
    #[arg(long)]
    denoise: bool,
    /// Whether to trust the normals of a cloud, as in `bake`: which of its points are outliers, left out
    /// of what is measured, depends on them
    #[arg(long, value_enum, default_value_t)]
    normals: bake::NormalsArgument,
    /// JSON instead of a table
    #[arg(long)]
    json: bool,
    /// Writes measures.json and a page, index.html, with pictures of every view that has holes
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Ends in exit code 1 if the greatest fit passes the file's error budget, the greatest
    /// distance backward passes two budgets, a pixel is missing or extra in any view, or a point that
    /// is no outlier is not covered
    #[arg(long)]
    check: bool,
    /// What draws for the time of a frame, besides the CPU reference, which draws everything that
    /// is compared: `gpu`, or `auto` for the GPU where there is one
    #[arg(long, value_name = device::NAMES, default_value = "cpu")]
    device: Choice,
    /// How to tell the progress, on standard error
    #[arg(long, value_enum, default_value_t)]
    progress: Style,
}

impl Arguments {
    pub(super) fn run(self, notes: &mut Notes<'_>) -> Result<Outcome> {
        let bytes = format::read_bytes(&self.file, &format::Limits::default())?;
        let asset = source::asset(&self.file)?;
        let input = source::input(&self.against)?;
        let frame = input.cloud().frame;
        align::check(&frame, model(&input).diagonal(), &asset)?;
        let mut progress = self.progress.teller(notes.quiet, notes.out);
        progress.stage("lines");
        let max_error = asset.max_error * asset.frame.scale() / frame.scale();
        let options = self.options()?;
        let meant = meant(&input, &options, max_error)?;
        let lines = feature_lines(&meant.input, &meant.edges, meant.noise, self.edge_angle, max_error)?;
        let lines = lines.as_ref().map(|lines| align::lines(lines, &frame, &asset.frame));
        progress.stage("reference");
        let kept = kept(&meant.input, &meant.edges, meant.noise, &options, max_error)?;
        let aligned = align::bring(surface(&kept), &asset);
        let reference = Reference::standing_for(aligned.model(), asset.diagonal)?;
        let reference = Reference { outliers: kept.outliers, ..reference };
        let subject = Subject { bytes: &bytes, asset: &asset, against: &reference, lines: lines.as_deref() };
        let mut measures = measure::measure_telling(&subject, &mut |stage| progress.stage(stage))?;
        drop(progress);
        measures.cost.gpu = self.gpu(&asset, &reference, notes)?;
        if let Some(directory) = &self.report {
            let names: [&Path; 2] = [&self.file, &self.against];
            let page = measured::write_page(&measures, &asset, &reference, names, directory)?;
            notes.note(&format!("measures and pictures: {}", page.display()));
        }
        self.outcome(&measures, notes)
    }

    /// The options that say what a bake of the input means.
    fn options(&self) -> Result<Options> {
        Ok(Options {
            edges: source::edges(&self.edges)?,
            edge_angle: self.edge_angle,
            meaning: self.surface.into(),
            denoise: self.denoise,
            normals: self.normals.into(),
            ..Options::default()
        })
    }

    /// The time of a frame on a graphics device, if one is asked for.
    fn gpu(&self, asset: &Asset, against: &Reference<'_>, notes: &mut Notes<'_>) -> Result<Option<GpuFrame>> {
        if self.device == Choice::Cpu {
            return Ok(None);
        }
        match cost::gpu_frame(asset, against.views()) {
            Err(Error::Device(why)) if self.device == Choice::Auto => {
                notes.note(&format!("no frame was drawn on a graphics device: {why}"));
                Ok(None)
            }
            frame => frame.map(Some),
        }
    }

    fn outcome(&self, measures: &Measures, notes: &mut Notes<'_>) -> Result<Outcome> {
        let mut text = if self.json { measures.json()? } else { measured::table(measures) };
        let faults = if self.check { measures.faults() } else { Vec::new() };
        for fault in &faults {
            let line = format!("FAILED: {fault}");
            // JSON stays JSON.
            if self.json { notes.note(&line) } else { text += &(line + "\n") }
        }
        if !faults.is_empty() && self.report.is_none() {
            notes.note("add --report DIR for a page that shows the views with holes");
        }
        Ok(Outcome { text, passed: faults.is_empty() })
    }
}
