//! Where the picture is seen from: a point to look at, a distance, and two angles about the upward axis.
//!
//! ```text
//! eye = target + distance · (cos e cos a · side₁ + cos e sin a · side₂ + sin e · up)      azimuth a, elevation e
//! ```

use crate::geometry::{Matrix, Vector, along, cross, dot, length, look, minus, perspective, product, unit};

/// Angle of view from bottom to top, in radians: narrow enough that straight edges look parallel.
const ANGLE: f32 = 0.5;

/// A view of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point in the middle of the picture, in m.
    pub target: Vector,
    /// Distance of the eye from it, in m.
    pub distance: f32,
    /// Angle about the upward axis in degrees.
    pub azimuth: f32,
    /// Angle above the ground in degrees.
    pub elevation: f32,
    /// Upwards: against gravity, or y.
    pub up: Vector,
}

impl Camera {
    /// A view of everything within a box, from the front, right and above; `up` need not be a unit vector.
    pub fn around(low: Vector, high: Vector, up: Vector) -> Camera {
        let up = if length(up) > 0.0 { unit(up) } else { [0.0, 1.0, 0.0] };
        let mut camera = Camera { target: [0.0; 3], distance: 1.0, azimuth: 30.0, elevation: 22.0, up };
        camera.fit(low, high, 16.0 / 9.0);
        camera
    }

    /// Moves so that a box fills the picture of this ratio of width to height; the direction stays.
    pub fn fit(&mut self, low: Vector, high: Vector, aspect: f32) {
        self.target = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
        let [right, up, back] = self.axes();
        let slope = (ANGLE / 2.0).tan();
        let mut distance: f32 = 0.0;
        for corner in 0..8u32 {
            let point: Vector = std::array::from_fn(|k| if corner >> k & 1 == 0 { low[k] } else { high[k] });
            let arm = minus(point, self.target);
            let need = (dot(arm, right).abs() / aspect).max(dot(arm, up).abs()) / slope + dot(arm, back);
            distance = distance.max(need);
        }
        self.distance = if distance > 0.0 { 1.15 * distance } else { 1.0 };
    }

    /// Right, up and back (towards the eye) as unit vectors.
    pub fn axes(&self) -> [Vector; 3] {
        // Two directions of the ground. With y up, azimuth 0 looks along −z and the x axis points right.
        let start = if self.up[1].abs() > 0.5 { [0.0, 0.0, 1.0] } else { [0.0, -1.0, 0.0] };
        let front = unit(along(start, -dot(start, self.up), self.up));
        let side = cross(self.up, front);
        let (sin, cos) = self.azimuth.to_radians().sin_cos();
        let ground = along(front.map(|x| x * cos), sin, side);
        let (sin, cos) = self.elevation.to_radians().sin_cos();
        let back = along(ground.map(|x| x * cos), sin, self.up);
        let right = unit(cross(self.up, ground));
        [right, cross(back, right), back]
    }

    /// Where the eye is, in m.
    pub fn eye(&self) -> Vector {
        along(self.target, self.distance, self.axes()[2])
    }

    /// Clip coordinates from positions, for a picture of this ratio of width to height that shows a ball.
    pub fn matrix(&self, aspect: f32, centre: Vector, radius: f32) -> Matrix {
        let [right, up, back] = self.axes();
        let eye = self.eye();
        let depth = dot(minus(eye, centre), back);
        let near = (depth - radius).max(self.distance * 0.01);
        let far = (depth + radius).max(2.0 * near);
        product(&perspective(ANGLE, aspect, near, far), &look(eye, right, up, back))
    }

    /// The ray through a point of the picture, (−1, −1) at its lower left and (1, 1) at its upper right.
    pub fn ray(&self, [x, y]: [f32; 2], aspect: f32) -> (Vector, Vector) {
        let [right, up, back] = self.axes();
        let slope = (ANGLE / 2.0).tan();
        let direction = along(along(back.map(|c| -c), x * slope * aspect, right), y * slope, up);
        (self.eye(), unit(direction))
    }

    /// Metres per height of the picture in the plane through a point.
    pub fn height_at(&self, point: Vector) -> f32 {
        2.0 * (ANGLE / 2.0).tan() * dot(minus(self.eye(), point), self.axes()[2]).max(1e-6 * self.distance)
    }

    /// Where a point stands in the picture, as [`Camera::ray`] counts.
    pub fn place(&self, point: Vector, aspect: f32) -> [f32; 2] {
        let [right, up, _] = self.axes();
        let arm = minus(point, self.eye());
        let half = self.height_at(point) / 2.0;
        [dot(arm, right) / (half * aspect), dot(arm, up) / half]
    }

    /// Turns about the target by degrees.
    pub fn turn(&mut self, azimuth: f32, elevation: f32) {
        self.azimuth = (self.azimuth + azimuth).rem_euclid(360.0);
        self.elevation = (self.elevation + elevation).clamp(-89.0, 89.0);
    }

    /// Moves the target by parts of the picture's height.
    pub fn pan(&mut self, right: f32, up: f32) {
        let height = self.height_at(self.target);
        let axes = self.axes();
        self.target = along(along(self.target, right * height, axes[0]), up * height, axes[1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rays and places are inverse to each other, whatever the view.
    #[test]
    fn rays_lead_to_places() {
        for (up, azimuth, elevation) in [([0.0, 1.0, 0.0], 20.0, 10.0), ([0.0, 0.0, 1.0], 200.0, -40.0)] {
            let mut camera = Camera::around([0.0; 3], [2.0, 1.0, 3.0], up);
            (camera.azimuth, camera.elevation) = (azimuth, elevation);
            let (from, direction) = camera.ray([0.3, -0.6], 1.5);
            let [x, y] = camera.place(along(from, 1.7, direction), 1.5);
            assert!((x - 0.3).abs() < 1e-4 && (y + 0.6).abs() < 1e-4, "{x} {y}");
        }
    }

    /// After fitting, every corner of the box lies inside the picture, and the box is not lost in it.
    #[test]
    fn fitting_shows_all() {
        let (low, high) = ([-1.0, 0.0, 2.0], [7.0, 1.0, 3.0]);
        let camera = Camera::around(low, high, [0.0, 1.0, 0.0]);
        let mut most: f32 = 0.0;
        for corner in 0..8u32 {
            let point: Vector = std::array::from_fn(|k| if corner >> k & 1 == 0 { low[k] } else { high[k] });
            let [x, y] = camera.place(point, 16.0 / 9.0);
            most = most.max(x.abs()).max(y.abs());
        }
        assert!(most < 1.0 && most > 0.6, "{most}");
    }
}
