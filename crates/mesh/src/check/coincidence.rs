//! Nodes at the same place.

use crate::geometry::{BoundingBox, minus, norm};

/// For each point, the first point within `tolerance` metres of it that is not itself at the place of an earlier one;
/// itself when there is none.
///
/// Points are sorted into cubes; a cube is several tolerances wide, so nearly always only one is searched.
pub fn first_at_same_place(points: &[[f64; 3]], tolerance: f64) -> Vec<u32> {
    let Some(bounds) = BoundingBox::around(points) else { return Vec::new() };
    // Narrower cubes than this could not be numbered; they would hold the same points anyhow.
    let width = (16.0 * tolerance).max(1e-15 * bounds.diagonal()).max(f64::MIN_POSITIVE);
    let cube = |x: f64, axis: usize| ((x - bounds.min[axis]) / width).floor() as i64;
    let place = |p: [f64; 3], shift: f64| -> [i64; 3] { std::array::from_fn(|a| cube(p[a] + shift, a)) };
    let mut cubes: Vec<([i64; 3], u32)> = points.iter().zip(0u32..).map(|(&p, i)| (place(p, 0.0), i)).collect();
    cubes.sort_unstable();
    let mut first: Vec<u32> = Vec::with_capacity(points.len());
    for (i, &point) in points.iter().enumerate() {
        let (low, high) = (place(point, -tolerance), place(point, tolerance));
        let mut found = i as u32;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let from = cubes.partition_point(|entry| entry.0 < [x, y, z]);
                    let inside = cubes[from..].iter().take_while(|entry| entry.0 == [x, y, z]).map(|entry| entry.1);
                    // Within a cube points come in order, so the first match is the lowest.
                    let near = |&j: &u32| first[j as usize] == j && norm(minus(points[j as usize], point)) <= tolerance;
                    let earlier = inside.take_while(|&j| j < found).find(near);
                    found = earlier.unwrap_or(found);
                }
            }
        }
        first.push(found);
    }
    first
}
