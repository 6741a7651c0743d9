//! Colours: one per family of elements, a list for laws and bodies, and maps for numbers.
//!
//! The maps are perceptually uniform: equal steps of the number look equally large, and their lightness rises all the way,
//! so that they can be read in grey and by the colour-blind. They are eleven equidistant samples of *viridis* and *magma*
//! of matplotlib (S. van der Walt and N. Smith, released under CC0), interpolated linearly in sRGB.

use souple_simulation::elements::Family;

/// Red, green, blue, each from 0 to 255, in sRGB.
pub type Colour = [u8; 3];

/// The colour of a family of elements, the same in every picture of the project.
pub fn family(family: Family) -> Colour {
    match family {
        Family::Hexahedron => [0xe0, 0xab, 0x45],
        Family::Prism => [0x3b, 0x6f, 0xb5],
        Family::Pyramid => [0x4f, 0x9d, 0x69],
        Family::Tetrahedron => [0xc0, 0x60, 0x5a],
        Family::Quadrangle => [0x8f, 0x6b, 0xb0],
        Family::Triangle => [0x4a, 0xa5, 0xb8],
        Family::Edge => [0x6d, 0x53, 0x3f],
    }
}

/// Colours that are told apart, for laws, materials and bodies; after the last the first comes again.
/// (Okabe and Ito, 2008, in another order, without black.)
pub fn category(index: usize) -> Colour {
    const LIST: [Colour; 7] =
        [[86, 180, 233], [230, 159, 0], [0, 158, 115], [204, 121, 167], [240, 228, 66], [0, 114, 178], [213, 94, 0]];
    LIST[index % LIST.len()]
}

/// Selected and warned of.
pub const MARKED: Colour = [0xff, 0x2d, 0x9b];
/// Held regions.
pub const HELD: Colour = [0x30, 0x30, 0x38];
/// Edges of elements.
pub const EDGE: Colour = [0x33, 0x30, 0x2e];
/// Springs of hands and tools.
pub const HAND: Colour = [0xd8, 0x1b, 0x60];
/// What has no colour of its own.
pub const PLAIN: Colour = [0xd9, 0xc9, 0xb0];
/// Behind everything.
pub const BACKGROUND: Colour = [0xf1, 0xf3, 0xf5];

/// A map from numbers to colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Map {
    /// Dark blue, green, yellow.
    Viridis,
    /// Black, purple, orange, white.
    Magma,
}

impl Map {
    /// Both maps.
    pub const ALL: [Map; 2] = [Map::Viridis, Map::Magma];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Map::Viridis => "viridis",
            Map::Magma => "magma",
        }
    }

    fn samples(self) -> [u32; 11] {
        match self {
            Map::Viridis => [
                0x440154, 0x482576, 0x414487, 0x35608d, 0x2a788e, 0x21908c, 0x22a884, 0x43bf71, 0x7ad151, 0xbbdf27,
                0xfde725,
            ],
            Map::Magma => [
                0x000004, 0x140e36, 0x3b0f70, 0x641a80, 0x8c2981, 0xb73779, 0xde4968, 0xf7705c, 0xfe9f6d, 0xfecf92,
                0xfcfdbf,
            ],
        }
    }

    /// The colour of a number from 0 to 1; numbers beyond take the ends.
    pub fn at(self, x: f32) -> Colour {
        let samples = self.samples();
        let x = if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) } * (samples.len() - 1) as f32;
        let below = (x as usize).min(samples.len() - 2);
        let share = x - below as f32;
        let channel = |at: usize, shift: u32| f32::from((samples[at] >> shift) as u8);
        [16, 8, 0].map(|shift| {
            let (a, b) = (channel(below, shift), channel(below + 1, shift));
            (a + share * (b - a)).round() as u8
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE lightness L* of a colour.
    fn lightness(colour: Colour) -> f32 {
        let linear = colour.map(|c| {
            let c = f32::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        });
        let y = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
        if y > 0.008856 { 116.0 * y.cbrt() - 16.0 } else { 903.3 * y }
    }

    /// Lightness rises along every map, and nearly evenly.
    #[test]
    fn maps_rise_evenly() {
        for map in Map::ALL {
            let all: Vec<f32> = (0..=20).map(|k| lightness(map.at(k as f32 / 20.0))).collect();
            let mean = (all[20] - all[0]) / 20.0;
            for step in all.windows(2).map(|w| w[1] - w[0]) {
                assert!(step > 0.3 * mean && step < 1.9 * mean, "{map:?}: {step} of {mean}");
            }
        }
    }

    /// Families look different in colour.
    #[test]
    fn families_are_told_apart() {
        for (k, &a) in Family::ALL.iter().enumerate() {
            for &b in &Family::ALL[..k] {
                let apart: i32 = (0..3).map(|c| (i32::from(family(a)[c]) - i32::from(family(b)[c])).abs()).sum();
                assert!(apart > 60, "{a:?} and {b:?}");
            }
        }
    }
}
