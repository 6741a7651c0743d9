//! Three classic tests of a material, done on one law: a bar with free sides, simple shear, and equal stretch in all
//! directions.

use super::dense::solved;
use super::largest;
use crate::response::{IDENTITY, Response, Tensor, determinant};
use std::fmt::Write as _;

/// Which test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveKind {
    /// A bar along x: nominal stress P₁₁ over the stretch of its axis, all other stresses zero.
    Uniaxial,
    /// F = I + γ e₁⊗e₂: nominal shear stress P₁₂ over γ.
    SimpleShear,
    /// F = J^(1/3) I: mean Cauchy stress tr σ / 3 over J.
    Volumetric,
}

impl CurveKind {
    /// Title of its drawing.
    pub fn title(self) -> &'static str {
        match self {
            CurveKind::Uniaxial => "Uniaxial stress, free sides",
            CurveKind::SimpleShear => "Simple shear",
            CurveKind::Volumetric => "Change of volume",
        }
    }

    /// What is prescribed.
    pub fn abscissa(self) -> &'static str {
        match self {
            CurveKind::Uniaxial => "stretch",
            CurveKind::SimpleShear => "shear γ",
            CurveKind::Volumetric => "volume ratio J",
        }
    }

    /// What answers, in pascals.
    pub fn ordinate(self) -> &'static str {
        match self {
            CurveKind::Uniaxial => "nominal stress",
            CurveKind::SimpleShear => "nominal shear stress",
            CurveKind::Volumetric => "mean stress",
        }
    }

    /// The abscissa of the rest shape.
    fn rest(self) -> f64 {
        if self == CurveKind::SimpleShear { 0.0 } else { 1.0 }
    }
}

/// One state of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Stretch, shear or volume ratio.
    pub abscissa: f64,
    /// Stress in Pa.
    pub ordinate: f64,
    /// The deformation gradient.
    pub f: Tensor,
}

/// One test.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Which one.
    pub kind: CurveKind,
    /// States by increasing abscissa; the rest shape is among them.
    pub points: Vec<CurvePoint>,
    /// Where and why it ends before its range does, a sentence for each end.
    pub ended: Vec<String>,
}

impl Curve {
    /// Abscissa and ordinate, a line each, separated by a tab; names and units in the first line.
    pub fn table(&self) -> String {
        let mut table = format!("{}\t{} [Pa]\n", self.kind.abscissa(), self.kind.ordinate());
        for point in &self.points {
            writeln!(table, "{}\t{:e}", point.abscissa, point.ordinate).expect("strings can be written to");
        }
        table
    }

    /// The abscissae, below and above rest, from which on more deformation meets less stress: the law is no
    /// description of a material beyond. The nearest to rest on each side; none where stress only grows.
    pub fn softens_at(&self) -> Vec<f64> {
        let rest = self.kind.rest();
        let falling = |pair: &&[CurvePoint]| pair[1].ordinate < pair[0].ordinate;
        let below = self.points.windows(2).rev().filter(|p| p[1].abscissa <= rest).find(falling).map(|p| p[1].abscissa);
        let above = self.points.windows(2).filter(|p| p[0].abscissa >= rest).find(falling).map(|p| p[0].abscissa);
        below.into_iter().chain(above).collect()
    }
}

/// How far the tests go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ranges {
    /// Least and largest stretch, around 1.
    pub stretch: (f64, f64),
    /// Least and largest shear, around 0.
    pub shear: (f64, f64),
    /// Least and largest volume ratio, around 1.
    pub volume: (f64, f64),
    /// Number of steps from rest to each end.
    pub steps: usize,
}

impl Default for Ranges {
    fn default() -> Ranges {
        Ranges { stretch: (0.5, 2.0), shear: (-1.0, 1.0), volume: (0.5, 1.5), steps: 40 }
    }
}

/// All three tests.
pub fn curves(response: &Response, ranges: &Ranges) -> Vec<Curve> {
    let kinds = [
        (CurveKind::Uniaxial, ranges.stretch),
        (CurveKind::SimpleShear, ranges.shear),
        (CurveKind::Volumetric, ranges.volume),
    ];
    kinds.into_iter().map(|(kind, range)| curve(response, kind, range, ranges.steps)).collect()
}

/// From rest to one end, then to the other.
fn curve(response: &Response, kind: CurveKind, range: (f64, f64), steps: usize) -> Curve {
    let mut ended = Vec::new();
    let mut branch = |end: f64| {
        let mut points: Vec<CurvePoint> = Vec::with_capacity(steps + 1);
        for k in 0..=steps {
            let abscissa = kind.rest() + (end - kind.rest()) * k as f64 / steps.max(1) as f64;
            let before = points.last().map_or(IDENTITY, |p| p.f);
            match state(response, kind, abscissa, before) {
                Ok(point) => points.push(point),
                Err(reason) => {
                    ended.push(format!("ends before {} = {abscissa:.4}: {reason}", kind.abscissa()));
                    break;
                }
            }
        }
        points
    };
    let (mut low, high) = (branch(range.0), branch(range.1));
    low.reverse();
    // Both branches begin at rest.
    low.extend(high.into_iter().skip(1));
    Curve { kind, points: low, ended }
}

fn state(response: &Response, kind: CurveKind, abscissa: f64, before: Tensor) -> Result<CurvePoint, &'static str> {
    let mut f = IDENTITY;
    match kind {
        CurveKind::Uniaxial => f = free_sides(response, abscissa, before)?,
        CurveKind::SimpleShear => f[0][1] = abscissa,
        CurveKind::Volumetric => (0..3).for_each(|i| f[i][i] = abscissa.cbrt()),
    }
    let stress = response.stress(&f);
    let ordinate = match kind {
        CurveKind::Uniaxial => stress[0][0],
        CurveKind::SimpleShear => stress[0][1],
        // σ = P Fᵀ / J
        CurveKind::Volumetric => {
            stress.iter().flatten().zip(f.iter().flatten()).map(|(p, f)| p * f).sum::<f64>() / (3.0 * determinant(&f))
        }
    };
    // Beyond a pole of the energy, its derivatives may be numbers again; they mean nothing there.
    match (response.energy(&f).is_finite(), ordinate.is_finite()) {
        (true, true) => Ok(CurvePoint { abscissa, ordinate, f }),
        (false, _) => Err("the energy is not finite"),
        (true, false) => Err("the stress is not finite"),
    }
}

/// The entries of F that free sides leave open. A rotation is fixed by the zeros below the diagonal; with these five
/// stresses zero, balance of moments makes the others zero too, but for P₁₁.
const OPEN: [(usize, usize); 5] = [(1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// The deformation of a bar stretched along x, by Newton's method from a neighbouring state.
fn free_sides(response: &Response, stretch: f64, before: Tensor) -> Result<Tensor, &'static str> {
    const ITERATIONS: usize = 60;
    let scale = largest(&response.tangent(&IDENTITY).concat());
    let residual = |f: &Tensor| {
        let stress = response.stress(f);
        // A step must not jump over a pole of the energy.
        let outside = !response.energy(f).is_finite();
        OPEN.map(|(i, j)| if outside { f64::INFINITY } else { stress[i][j] })
    };
    let mut f = before;
    f[0][0] = stretch;
    let mut r = residual(&f);
    for _ in 0..ITERATIONS {
        if largest(&r) <= 1e-12 * scale {
            return Ok(f);
        }
        let tangent = response.tangent(&f);
        let jacobian = OPEN.map(|(i, j)| OPEN.map(|(k, l)| tangent[3 * i + j][3 * k + l]));
        let Some(step) = solved(jacobian, r) else { break };
        // Halve until the sides pull less and have not passed through each other.
        let mut size = 1.0;
        let moved = loop {
            let mut moved = f;
            OPEN.iter().zip(step).for_each(|(&(i, j), s)| moved[i][j] -= size * s);
            let next = residual(&moved);
            let upright = moved[1][1] > 0.0 && moved[2][2] > 0.0;
            if upright && largest(&next) < largest(&r) {
                break Some((moved, next));
            }
            size *= 0.5;
            if size < 1e-8 {
                break None;
            }
        };
        match moved {
            Some((next, left)) => (f, r) = (next, left),
            None => break,
        }
    }
    // Round-off decides how small the stress of the sides can get.
    if largest(&r) <= 1e-8 * scale { Ok(f) } else { Err("no width of the bar leaves its sides free of stress") }
}
