//! The arguments of `souple-view`.

use clap::Parser;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use souple_simulation::RunOptions;
use souple_simulation::session::Script;
#[cfg(feature = "window")]
use souple_simulation::session::SessionOptions;
use souple_viewer::colouring::{ColourBy, Scale, choices};
use souple_viewer::look::{Faces, Look, Shading};
use souple_viewer::palette::Map;
use souple_viewer::screenshot::Screenshot;
use std::path::PathBuf;

/// See a simulation in a window, touch it, or draw a picture of it.
#[derive(Debug, Parser)]
#[command(
    name = "souple view",
    version,
    after_help = "Examples:\n  souple view                         choose a scene in the window\n  \
        souple view scenes/organ.toml\n  \
        souple view scenes/mixed_bar.toml --screenshot bar.png --at 2.0 --size 1280x720 --colour element\n  \
        souple view scenes/organ.toml --screenshot cut.png --cut z=0.5 --colour von-mises --camera 200,20\n\n\
        Pictures need no display: a software graphics device is enough (mesa-vulkan-drivers)."
)]
pub(crate) struct Arguments {
    /// The scene file; without it, the window offers the bundled ones
    pub(crate) scene: Option<PathBuf>,
    /// Write a PNG file instead of opening a window
    #[arg(long, value_name = "FILE")]
    pub(crate) screenshot: Option<PathBuf>,
    /// Simulated time of the picture; without it, the scene's end or rest
    #[arg(long, value_name = "S")]
    at: Option<f64>,
    /// Width and height in pixels: 1280x720 for pictures, 1400x860 for windows without it
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(crate) size: Option<[u32; 2]>,
    /// Degrees around and above the body, and how far away relative to a view of everything
    #[arg(long, value_name = "AZIMUTH,ELEVATION[,DISTANCE]", allow_hyphen_values = true, value_parser = view)]
    camera: Option<[f32; 3]>,
    /// What colours show
    #[arg(long, visible_alias = "color", value_name = "WHAT", default_value = "element", value_parser = colour())]
    colour: ColourBy,
    /// The range of numbers that colours show; without it, from the least to the largest
    #[arg(long, value_name = "LOW,HIGH", allow_hyphen_values = true, value_parser = range)]
    range: Option<[f64; 2]>,
    /// The map from numbers to colours: viridis or magma
    #[arg(long, default_value = "viridis", value_parser = map)]
    map: Map,
    /// Cut across an axis, at a share of the body's length: z=0.5
    #[arg(long, value_name = "AXIS=SHARE", value_parser = cut)]
    cut: Option<(usize, f32)>,
    /// Size of each element about its centre, from 0 to 1
    #[arg(long, value_name = "SIZE", default_value_t = 1.0)]
    element_size: f32,
    /// What is drawn of the surface: plain, edged or wireframe
    #[arg(long, default_value = "edged", value_parser = faces)]
    faces: Faces,
    /// Round off faces that meet at less than 50 degrees
    #[arg(long)]
    smooth: bool,
    /// Dot the nodes
    #[arg(long)]
    points: bool,
    /// Leave out the ground
    #[arg(long)]
    no_ground: bool,
    /// Repeat what a person did in the window: the script that was saved beside a checkpoint
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
    /// Simulated seconds per second as the window opens; 0 is as fast as it goes
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    speed: f64,
    /// Pictures per second at most; without it 18 where the processor draws, and what the screen shows elsewhere
    #[arg(long, value_name = "N", conflicts_with = "screenshot")]
    pictures_per_second: Option<f64>,
    /// Close the window after this many pictures, in which the body turns once around and is pulled
    #[arg(long, value_name = "N", conflicts_with = "screenshot")]
    pub(crate) frames: Option<usize>,
    /// With --frames: write what was measured as JSON, to the terminal without this
    #[arg(long, value_name = "FILE", requires = "frames")]
    pub(crate) report: Option<PathBuf>,
    /// With --frames: write a picture of the whole window at the end, as PNG
    #[arg(long, value_name = "FILE", requires = "frames")]
    pub(crate) window_picture: Option<PathBuf>,
    /// Change a value of the scene; repeat it
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// What to compute on (see: souple list devices)
    #[arg(long, default_value = "cpu")]
    pub(crate) device: String,
    /// Number of threads; 0 takes as many as the machine has
    #[arg(long, default_value_t = 0)]
    pub(crate) threads: usize,
}

impl Arguments {
    /// What to draw.
    pub(crate) fn wish(&self) -> Result<Screenshot, String> {
        if !(self.element_size > 0.0 && self.element_size <= 1.0) {
            return Err(format!("--element-size is a number above 0 and at most 1, found {}", self.element_size));
        }
        if self.at.is_some_and(|at| !(at >= 0.0 && at.is_finite())) {
            return Err("--at is a number of seconds, at least 0".into());
        }
        let look = Look {
            colour_by: self.colour,
            scale: Scale { map: self.map, range: self.range },
            shading: if self.smooth { Shading::Smooth } else { Shading::Flat },
            faces: self.faces,
            points: self.points,
            element_size: self.element_size,
            ground: !self.no_ground,
            ..Look::default()
        };
        let size = self.size.unwrap_or([1280, 720]);
        Ok(Screenshot { at: self.at, size, camera: self.camera, look, cut: self.cut })
    }

    /// The script, if one was named.
    pub(crate) fn script(&self) -> Result<Script, String> {
        let Some(path) = &self.script else { return Ok(Script::new()) };
        let bytes = std::fs::read(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
        serde_json::from_slice(&bytes).map_err(|e| format!("{} is not a script of this program: {e}", path.display()))
    }

    /// How the simulation begins in the window.
    #[cfg(feature = "window")]
    pub(crate) fn session(&self) -> Result<SessionOptions, String> {
        if !(self.speed >= 0.0 && self.speed.is_finite()) {
            return Err(format!(
                "--speed is a number of simulated seconds per second, at least 0, found {}",
                self.speed
            ));
        }
        Ok(SessionOptions { speed: (self.speed > 0.0).then_some(self.speed), ..SessionOptions::default() })
    }

    /// Pictures per second at most.
    #[cfg(feature = "window")]
    pub(crate) fn rate(&self) -> Result<Option<f64>, String> {
        match self.pictures_per_second {
            Some(rate) if !(0.1..=1000.0).contains(&rate) => {
                Err(format!("--pictures-per-second is a number from 0.1 to 1000, found {rate}"))
            }
            rate => Ok(rate),
        }
    }

    /// Where and how to compute.
    #[cfg_attr(not(feature = "window"), expect(dead_code, reason = "only windows compute in the background"))]
    pub(crate) fn run_options(&self) -> RunOptions {
        RunOptions { device: self.device.clone(), threads: self.threads }
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let expected = || "expected a width and a height in pixels, like 1280x720, each from 16 to 8192".to_owned();
    let (width, height) = text.split_once('x').ok_or_else(expected)?;
    let parse = |t: &str| t.parse::<u32>().ok().filter(|n| (16..=8192).contains(n)).ok_or_else(expected);
    Ok([parse(width)?, parse(height)?])
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let list: Option<Vec<f64>> =
        text.split(',').map(|t| t.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect();
    list?.try_into().ok()
}

fn view(text: &str) -> Result<[f32; 3], String> {
    let expected =
        "expected an azimuth and an elevation in degrees, like 30,20, and perhaps a positive factor of the distance";
    let [a, e, d] = numbers::<3>(text).or_else(|| numbers::<2>(text).map(|[a, e]| [a, e, 1.0])).ok_or(expected)?;
    if d <= 0.0 || !(-89.0..=89.0).contains(&e) {
        return Err(format!("{expected}; elevations lie between -89 and 89"));
    }
    Ok([a as f32, e as f32, d as f32])
}

fn range(text: &str) -> Result<[f64; 2], String> {
    let ends = numbers::<2>(text).filter(|[low, high]| low < high);
    ends.ok_or_else(|| "expected two numbers in SI units, the smaller first, like 0,5e4".into())
}

fn colour() -> impl TypedValueParser<Value = ColourBy> {
    PossibleValuesParser::new(choices().into_iter().map(|c| c.1))
        .try_map(|text| choices().into_iter().find(|c| c.1 == text).map(|c| c.0).ok_or("there is no such colour"))
}

fn map(text: &str) -> Result<Map, String> {
    Map::ALL.into_iter().find(|m| m.name() == text).ok_or_else(|| "expected viridis or magma".into())
}

fn cut(text: &str) -> Result<(usize, f32), String> {
    let expected = || "expected an axis and a share of the body's length from 0 to 1, like z=0.5".to_owned();
    let (axis, share) = text.split_once('=').ok_or_else(expected)?;
    let axis = ["x", "y", "z"].iter().position(|a| *a == axis).ok_or_else(expected)?;
    let share: f32 = share.parse().ok().filter(|s| (0.0..=1.0).contains(s)).ok_or_else(expected)?;
    Ok((axis, share))
}

fn faces(text: &str) -> Result<Faces, String> {
    match text {
        "plain" => Ok(Faces::Plain),
        "edged" => Ok(Faces::Edged),
        "wireframe" => Ok(Faces::Wireframe),
        _ => Err("expected plain, edged or wireframe".into()),
    }
}
