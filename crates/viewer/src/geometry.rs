//! Vectors and matrices of drawing: single precision, because a picture needs no more.

/// A point or direction.
pub type Vector = [f32; 3];

/// a + s b
pub fn along(a: Vector, s: f32, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] + s * b[k])
}

/// a − b
pub fn minus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] - b[k])
}

/// a · b
pub fn dot(a: Vector, b: Vector) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// |a|
pub fn length(a: Vector) -> f32 {
    dot(a, a).sqrt()
}

/// a / |a|; zero stays zero.
pub fn unit(a: Vector) -> Vector {
    let l = length(a);
    if l > 0.0 { a.map(|x| x / l) } else { a }
}

/// A matrix by columns, as shaders read it.
pub type Matrix = [[f32; 4]; 4];

/// A B
pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|c| std::array::from_fn(|r| (0..4).map(|k| a[k][r] * b[c][k]).sum()))
}

/// The matrix that moves `eye` to the origin and looks along −z, with y upwards.
pub fn look(eye: Vector, right: Vector, up: Vector, back: Vector) -> Matrix {
    let row = |axis: Vector| [axis[0], axis[1], axis[2], -dot(axis, eye)];
    let (x, y, z) = (row(right), row(up), row(back));
    std::array::from_fn(|c| [x[c], y[c], z[c], if c == 3 { 1.0 } else { 0.0 }])
}

/// Perspective with depth from 0 at `near` to 1 at `far`.
pub fn perspective(height_angle: f32, aspect: f32, near: f32, far: f32) -> Matrix {
    let f = 1.0 / (height_angle / 2.0).tan();
    let depth = far / (near - far);
    [[f / aspect, 0.0, 0.0, 0.0], [0.0, f, 0.0, 0.0], [0.0, 0.0, depth, -1.0], [0.0, 0.0, near * depth, 0.0]]
}

/// Where a ray hits a triangle: distance along the ray in lengths of `direction`, and the weights of the corners
/// (Möller and Trumbore, 1997); both sides count.
pub fn ray_meets_triangle(from: Vector, direction: Vector, corners: [Vector; 3]) -> Option<(f32, [f32; 3])> {
    let (e1, e2) = (minus(corners[1], corners[0]), minus(corners[2], corners[0]));
    let p = cross(direction, e2);
    let determinant = dot(e1, p);
    if determinant.abs() < f32::MIN_POSITIVE {
        return None;
    }
    let s = minus(from, corners[0]);
    let u = dot(s, p) / determinant;
    let q = cross(s, e1);
    let v = dot(direction, q) / determinant;
    let t = dot(e2, q) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some((t, [1.0 - u - v, u, v]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What lies between near and far has a depth between 0 and 1, and what is in front lies in the middle.
    #[test]
    fn perspective_keeps_order() {
        let m = perspective(0.6, 1.5, 0.1, 10.0);
        let depth = |z: f32| (m[2][2] * z + m[3][2]) / -z;
        assert!(depth(-0.1).abs() < 1e-5 && (depth(-10.0) - 1.0).abs() < 1e-5);
        assert!(depth(-1.0) < depth(-2.0));
    }

    /// A ray through a triangle's inside meets it with weights that give the point back; one beside it does not.
    #[test]
    fn rays_meet_triangles() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let (t, w) = ray_meets_triangle([0.2, 0.3, 2.0], [0.0, 0.0, -1.0], corners).unwrap();
        assert!((t - 2.0).abs() < 1e-6 && (w[1] - 0.2).abs() < 1e-6 && (w[2] - 0.3).abs() < 1e-6);
        assert!(ray_meets_triangle([0.8, 0.8, 2.0], [0.0, 0.0, -1.0], corners).is_none());
    }
}
