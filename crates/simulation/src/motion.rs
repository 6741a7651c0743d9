//! Regions that move along keyed times.

use souple_scene::keyframes::Keyframe;

/// Nodes whose motion is prescribed: u(t) = R(t) (X − c) + c + T(t) − X on some axes.
pub(crate) struct Motion {
    pub(crate) nodes: Vec<u32>,
    pub(crate) axes: [bool; 3],
    pub(crate) translation: Vec<Keyframe<[f64; 3]>>,
    pub(crate) rotation: Option<Turn>,
}

/// Rotation about an axis; angles in degrees.
pub(crate) struct Turn {
    /// Unit vector.
    pub(crate) axis: [f64; 3],
    pub(crate) through: [f64; 3],
    pub(crate) keys: Vec<Keyframe<f64>>,
}

impl Motion {
    /// Overwrites displacement and velocity of the moved unknowns by their value at time `t`.
    pub(crate) fn prescribe(&self, t: f64, rest: &[[f64; 3]], d: usize, u: &mut [f64], v: &mut [f64]) {
        let (shift, drift) = match &self.translation[..] {
            [] => ([0.0; 3], [0.0; 3]),
            keys => {
                let part = |axis: usize| value_and_rate(keys.iter().map(|k| (k.time, k.value[axis])), t);
                let parts = [part(0), part(1), part(2)];
                (parts.map(|p| p.0), parts.map(|p| p.1))
            }
        };
        let turn = self.rotation.as_ref().map(|turn| {
            let (degrees, rate) = value_and_rate(turn.keys.iter().map(|k| (k.time, k.value)), t);
            (turn, degrees.to_radians().sin_cos(), rate.to_radians())
        });
        for &n in &self.nodes {
            let n = n as usize;
            let mut moved = shift;
            let mut velocity = drift;
            if let Some((turn, (sin, cos), rate)) = &turn {
                // Rodrigues' formula on the arm r = X − c.
                let r: [f64; 3] = std::array::from_fn(|k| rest[n][k] - turn.through[k]);
                let along: f64 = (0..3).map(|k| turn.axis[k] * r[k]).sum();
                let across = cross(turn.axis, r);
                let turned: [f64; 3] =
                    std::array::from_fn(|k| r[k] * cos + across[k] * sin + turn.axis[k] * along * (1.0 - cos));
                let spin = cross(turn.axis, turned);
                for k in 0..3 {
                    moved[k] += turned[k] - r[k];
                    velocity[k] += rate * spin[k];
                }
            }
            for axis in (0..d).filter(|&k| self.axes[k]) {
                u[n * d + axis] = moved[axis];
                v[n * d + axis] = velocity[axis];
            }
        }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

/// Value at `t` of the piecewise linear function through the keys, and its slope on the way there (zero outside).
fn value_and_rate(keys: impl Iterator<Item = (f64, f64)>, t: f64) -> (f64, f64) {
    let mut before: Option<(f64, f64)> = None;
    for (time, value) in keys {
        if t <= time {
            return match before {
                None => (value, 0.0),
                Some((t0, v0)) => {
                    let rate = (value - v0) / (time - t0);
                    (v0 + rate * (t - t0), rate)
                }
            };
        }
        before = Some((time, value));
    }
    (before.map_or(0.0, |b| b.1), 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half a turn takes a point to the other side, and the velocity is ω × r on the way.
    #[test]
    fn half_a_turn() {
        let keys = vec![Keyframe { time: 0.0, value: 0.0 }, Keyframe { time: 2.0, value: 180.0 }];
        let turn = Turn { axis: [0.0, 0.0, 1.0], through: [1.0, 0.0, 0.0], keys };
        let motion = Motion { nodes: vec![0], axes: [true; 3], translation: Vec::new(), rotation: Some(turn) };
        let rest = [[2.0, 0.0, 5.0]];
        let (mut u, mut v) = (vec![0.0; 3], vec![0.0; 3]);
        motion.prescribe(1.0, &rest, 3, &mut u, &mut v);
        let speed = std::f64::consts::PI / 2.0;
        let near = |a: &[f64], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14);
        assert!(near(&u, [-1.0, 1.0, 0.0]) && near(&v, [-speed, 0.0, 0.0]), "{u:?} {v:?}");
        motion.prescribe(3.0, &rest, 3, &mut u, &mut v);
        assert!(near(&u, [-2.0, 0.0, 0.0]) && near(&v, [0.0; 3]), "{u:?} {v:?}");
    }
}
