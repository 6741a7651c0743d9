//! What colours may show, and which colours: those of the window, so that pictures of both read alike.

use souple_simulation::ElementField;
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

/// Eleven equidistant samples of the map *viridis* (S. van der Walt and N. Smith, released under CC0), lowest first.
pub const VIRIDIS: [u32; 11] =
    [0x440154, 0x482576, 0x414487, 0x35608d, 0x2a788e, 0x21908c, 0x22a884, 0x43bf71, 0x7ad151, 0xbbdf27, 0xfde725];

/// What colours may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// What commands call it.
    pub key: &'static str,
    /// What people read.
    pub name: &'static str,
    /// SI unit; empty where there is none.
    pub unit: &'static str,
    /// The field that the simulation must compute; pages know the rest.
    pub field: Option<ElementField>,
}

/// Everything that colours may show.
pub fn choices() -> Vec<Choice> {
    let plain = |key, name, unit| Choice { key, name, unit, field: None };
    let mut all = vec![
        plain("element", "element", ""),
        plain("law", "law", ""),
        plain("material", "material", ""),
        plain("body", "body", ""),
        plain("displacement", "displacement", "m"),
    ];
    for field in ElementField::ALL {
        all.push(Choice { key: key(field), name: field.name(), unit: field.unit(), field: Some(field) });
    }
    all
}

/// What commands call a field.
pub fn key(field: ElementField) -> &'static str {
    match field {
        ElementField::VonMises => "von-mises",
        ElementField::VolumeRatio => "volume-ratio",
        ElementField::SmallestJ => "smallest-j",
        ElementField::EnergyDensity => "energy-density",
        ElementField::LargestStretch => "largest-stretch",
        ElementField::SmallestStretch => "smallest-stretch",
        ElementField::LengthChange => "r-l",
        ElementField::VolumeChange => "r-a",
        ElementField::MeanForce => "r-s",
    }
}

/// `#rrggbb`
pub fn hexadecimal(colour: Colour) -> String {
    let [r, g, b] = colour;
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Colours and names of what colours show are those of the window, line by line.
    #[test]
    fn colours_are_those_of_the_window() {
        let here = include_str!("colours.rs");
        let palette = include_str!("../../viewer/src/palette.rs");
        let colouring = include_str!("../../viewer/src/colouring.rs");
        let families = here.lines().filter(|l| l.trim_start().starts_with("Family::"));
        let keys = here.lines().filter(|l| l.trim_start().starts_with("ElementField::"));
        let found: Vec<&str> = families.filter(|line| palette.contains(line.trim())).collect();
        assert_eq!(found.len(), Family::ALL.len());
        let found: Vec<&str> = keys.filter(|line| colouring.contains(line.trim())).collect();
        assert_eq!(found.len(), ElementField::ALL.len());
        let list = here.lines().find(|l| l.contains("[[86, 180")).unwrap();
        assert!(palette.contains(list));
        assert!(VIRIDIS.iter().all(|sample| palette.contains(&format!("0x{sample:06x}"))));
    }
}
