//! One picture of a scene at one time, without a window.

use crate::camera::Camera;
use crate::colouring::ColourBy;
use crate::draw::frame::bounds;
use crate::draw::renderer::Shot;
use crate::draw::studio::{Pose, Studio, ground_below};
use crate::look::{Look, Section};
use crate::model::Model;
use crate::numbers::with_unit;
use souple_simulation::session::{Stamped, replay};
use souple_simulation::{Ending, Simulation};

/// What to draw.
#[derive(Clone, Debug)]
pub struct Screenshot {
    /// Simulated time in s; the scene's end or rest without it.
    pub at: Option<f64>,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Azimuth and elevation in degrees, and a factor of the distance.
    pub camera: Option<[f32; 3]>,
    /// How the model is shown; its section is replaced by `cut`.
    pub look: Look,
    /// An axis, and where along the box of the body it is cut, from 0 to 1; what lies towards the eye is taken away.
    pub cut: Option<(usize, f32)>,
}

/// A picture, and what should be known about it.
pub struct Taken {
    /// A PNG file.
    pub png: Vec<u8>,
    /// Simulated time in s.
    pub time: f64,
    /// What drew it.
    pub device: String,
    /// Why the state is not the one that was asked for: the simulation failed before.
    pub failure: Option<String>,
}

/// Advances to the time and draws.
///
/// A simulation that fails on the way is drawn in its last good state, and says so.
///
/// # Errors
/// In words: no graphics device, or a change of the script that cannot be made.
pub fn take(
    simulation: &mut Simulation,
    script: &[Stamped],
    studio: &mut Studio,
    wish: &Screenshot,
) -> Result<Taken, String> {
    let model = Model::of(simulation);
    let failure = advance(simulation, script, wish.at);
    let positions = to_single(&simulation.positions());
    let field = match wish.look.colour_by {
        ColourBy::Field(field) => simulation.element_field(field).map_err(|e| e.message)?,
        _ => Vec::new(),
    };
    let field: Vec<f32> = field.into_iter().map(|v| v as f32).collect();
    let all = bounds(&positions);
    let mut camera = Camera::around(all[0], all[1], model.up);
    if let Some([azimuth, elevation, _]) = wish.camera {
        (camera.azimuth, camera.elevation) = (azimuth, elevation);
    }
    camera.fit(all[0], all[1], wish.size[0] as f32 / wish.size[1] as f32);
    if let Some([.., zoom]) = wish.camera {
        camera.distance *= zoom;
    }
    let mut look = wish.look.clone();
    look.section = wish.cut.map(|(axis, share)| cut(&camera, all, axis, share));
    let ground = look.ground.then(|| ground_below(&positions, &camera));
    let subtitle = format!("t = {}", with_unit(simulation.time(), "s"));
    let pose = Pose { positions: &positions, field: &field, held: &model.fixed, subtitle: &subtitle };
    let shot = Shot { size: wish.size, camera, section: look.section, ground };
    let pixels = studio.picture(&model, pose, &look, shot).map_err(|e| e.to_string())?;
    Ok(Taken { png: pixels.png()?, time: simulation.time(), device: studio.device(), failure })
}

/// A plane across an axis of a box; what is towards the eye is hidden.
pub fn cut(camera: &Camera, [low, high]: [[f32; 3]; 2], axis: usize, share: f32) -> Section {
    let mut normal = [0.0; 3];
    normal[axis] = if camera.axes()[2][axis] >= 0.0 { 1.0 } else { -1.0 };
    let place = low[axis] + share * (high[axis] - low[axis]);
    Section { normal, offset: normal[axis] * place }
}

/// Positions as pictures need them.
pub fn to_single(positions: &[[f64; 3]]) -> Vec<[f32; 3]> {
    positions.iter().map(|p| p.map(|x| x as f32)).collect()
}

/// Steps until the time, or the scene's end; why not, if not.
fn advance(simulation: &mut Simulation, script: &[Stamped], at: Option<f64>) -> Option<String> {
    if at.is_some() || !script.is_empty() {
        simulation.run_on();
    }
    let mut step = 0;
    loop {
        let half = 0.5 * simulation.controls().step;
        let reached = at.unwrap_or(simulation.end_time()) - half;
        if simulation.time() >= reached {
            return None;
        }
        if script.is_empty() {
            match simulation.advance() {
                Err(error) => return Some(error.message),
                Ok(progress) if matches!(progress.finished, Some(Ending::AtRest | Ending::Finished)) => return None,
                Ok(_) => {}
            }
        } else {
            step += 1;
            if let Err(error) = replay(simulation, script, step) {
                return Some(error.message);
            }
        }
    }
}
