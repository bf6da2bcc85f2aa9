//! `qsplat render`: a picture of a `.qsplat`, a mesh or a cloud.

use std::path::PathBuf;

use clap::Args;
use qsplat::deliver::model;
use qsplat::error::Result;
use qsplat::ingest::Input;
use qsplat::model::asset::Asset;
use qsplat::model::frame::Frame;
use qsplat::render::camera::{Camera, DEFAULT_FOV, Framing, View};
use qsplat::render::device::Choice;
use qsplat::render::{Picture, Settings, Show, input};
use qsplat::report::png;

use super::device;
use super::{Notes, Outcome, source};

/// Draws a .qsplat, a mesh or a cloud to a PNG.
#[derive(Args)]
pub(super) struct Arguments {
    /// A .qsplat, or a mesh or cloud that `bake` reads
    #[arg(value_name = "FILE", required_unless_present = "list_devices")]
    file: Option<PathBuf>,
    /// The picture, a PNG
    #[arg(short, long, value_name = "OUT.png", required_unless_present = "list_devices")]
    output: Option<PathBuf>,
    /// From where: `front`, `iso`, or azimuth and elevation in degrees, such as `30,20`
    #[arg(long, value_name = "front|iso|AZ,EL", default_value = "front", allow_hyphen_values = true)]
    view: View,
    /// A camera as JSON, in the input's coordinates, instead of --view
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["view", "ortho", "fov"])]
    camera: Option<PathBuf>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1024x768", value_parser = size)]
    size: [u32; 2],
    /// Parallel rays
    #[arg(long, conflicts_with = "fov")]
    ortho: bool,
    /// Vertical angle of view in degrees
    #[arg(long, value_name = "DEG", default_value_t = DEFAULT_FOV, value_parser = fov)]
    fov: f64,
    /// What the picture shows: the lit surface, normals as colours, depth as grey, each splat in a
    /// colour of its own, or splats by kind (flat blue, flat and clipped green, cylinder violet,
    /// cylinder and clipped pink, quadric orange, quadric and clipped red)
    #[arg(long, value_name = "shaded|normals|depth|splats|kinds", default_value = "shaded")]
    show: Show,
    /// What draws it: `auto` takes the GPU, or the CPU reference where there is none
    #[arg(long, value_name = device::NAMES, default_value = "auto")]
    device: Choice,
    /// Names the graphics devices of this machine, one a line, and draws nothing
    #[arg(long)]
    list_devices: bool,
}

pub(super) fn size(text: &str) -> std::result::Result<[u32; 2], String> {
    let parts = text.split_once(['x', 'X']);
    let size = parts.and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    let size = size.ok_or("give width and height in pixels, such as 1024x768")?;
    let settings = Settings { size, ..Settings::default() };
    settings.samples().map(|_| size).map_err(|error| error.to_string())
}

fn fov(text: &str) -> std::result::Result<f64, String> {
    let degrees: f64 = text.parse().map_err(|_| "give an angle in degrees, such as 30".to_owned())?;
    if degrees > 0.0 && degrees < 180.0 {
        Ok(degrees)
    } else {
        Err("give an angle between 0 and 180 degrees".into())
    }
}

/// What is drawn.
enum Scene {
    Asset(Asset),
    Input(Input),
}

impl Arguments {
    pub(super) fn run(self, notes: &mut Notes<'_>) -> Result<Outcome> {
        let (false, Some(file), Some(output)) = (self.list_devices, &self.file, &self.output) else {
            return Ok(Outcome::text(device::list()));
        };
        let scene = if source::is_qsplat(file)? {
            Scene::Asset(source::asset(file)?)
        } else {
            Scene::Input(source::input(file)?)
        };
        let settings = Settings { size: self.size, show: self.show, ..Settings::default() };
        let camera = self.camera(&scene)?;
        let drawn = self.draw(&scene, &camera, &settings, notes)?;
        png::write(output, &drawn.rgba)?;
        Ok(Outcome::text(""))
    }

    fn camera(&self, scene: &Scene) -> Result<Camera> {
        if let Some(path) = &self.camera {
            return Camera::read(path);
        }
        let (frame, diagonal): (&Frame, f64) = match scene {
            Scene::Asset(asset) => (&asset.frame, asset.diagonal),
            Scene::Input(scene) => (&scene.cloud().frame, model(scene).diagonal()),
        };
        let framing =
            if self.ortho { Framing::Orthographic } else { Framing::Perspective { fov_degrees: self.fov } };
        Ok(Camera::framing(frame, diagonal, self.view, framing, self.size))
    }

    fn draw(
        &self,
        scene: &Scene,
        camera: &Camera,
        settings: &Settings,
        notes: &mut Notes<'_>,
    ) -> Result<Picture> {
        match scene {
            Scene::Asset(asset) => device::with(self.device, asset, notes, |draw| draw(camera, settings)),
            Scene::Input(scene) => {
                if self.device == Choice::Gpu {
                    notes.note(
                        "meshes and clouds are always drawn by the CPU; --device gpu is for .qsplat files",
                    );
                }
                Ok(input::render(model(scene), camera, settings, &input::Style::default())?)
            }
        }
    }
}
