//! Which points lie in which boxes: the points are sorted into cubes, each box looks into the cubes that it meets.

use crate::geometry::BoundingBox;

/// Pairs (box, point) of the points inside each box, ordered by box, then by point.
pub(super) fn inside(points: &[[f64; 3]], boxes: &[BoundingBox]) -> Vec<(u32, u32)> {
    let Some(bounds) = BoundingBox::around(points) else { return Vec::new() };
    let mean = boxes.iter().map(BoundingBox::diagonal).sum::<f64>() / boxes.len().max(1) as f64;
    // Cubes of the size of a box; never so many along an axis that counting through them takes long.
    let width = mean.max(1e-3 * bounds.diagonal()).max(f64::MIN_POSITIVE);
    let cube = |p: [f64; 3]| -> [i64; 3] { std::array::from_fn(|a| ((p[a] - bounds.min[a]) / width).floor() as i64) };
    let mut cubes: Vec<([i64; 3], u32)> = points.iter().zip(0u32..).map(|(&p, i)| (cube(p), i)).collect();
    cubes.sort_unstable();
    let last = cube(bounds.max);
    let mut found = Vec::new();
    for (b, number) in boxes.iter().zip(0u32..) {
        let first = found.len();
        let low: [i64; 3] = std::array::from_fn(|a| cube(b.min)[a].max(0));
        let high: [i64; 3] = std::array::from_fn(|a| cube(b.max)[a].min(last[a]));
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                let from = cubes.partition_point(|entry| entry.0 < [x, y, low[2]]);
                let row = cubes[from..].iter().take_while(|entry| entry.0 <= [x, y, high[2]]);
                let within = |p: [f64; 3]| (0..3).all(|a| b.min[a] <= p[a] && p[a] <= b.max[a]);
                found.extend(row.filter(|entry| within(points[entry.1 as usize])).map(|entry| (number, entry.1)));
            }
        }
        found[first..].sort_unstable();
    }
    found
}

/// A box that is larger by a margin on every side.
pub(super) fn grown(b: BoundingBox, margin: f64) -> BoundingBox {
    BoundingBox { min: b.min.map(|x| x - margin), max: b.max.map(|x| x + margin) }
}
