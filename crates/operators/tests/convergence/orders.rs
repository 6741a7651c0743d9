//! The orders that come out, for every element of the registry.
//!
//! Theory: on meshes whose elements approach parallelepipeds, or for elements that hold all polynomials of their degree
//! in *physical* coordinates whatever their shape, ‖u_h − u‖ falls as h^(p+1) in L² and as h^p in energy (Ciarlet,
//! "The Finite Element Method for Elliptic Problems", 1978, theorems 3.2.5 and 4.3.4 for curved elements).
//! Serendipity elements of degree two hold them only where they are images of their cell under an affine map; on
//! trapezoids that stay trapezoids, one order is lost in both norms (Arnold, Boffi and Falk, "Approximation by
//! quadrilateral finite elements", Math. Comp. 71 (2002) 909–922).

use crate::cube::Distortion;
use crate::field::Field;
use crate::problem::{Errors, solve};
use souple_elements::{Element, Family};
use souple_laws::Law;

/// How much an observed order may be below the theoretical one: meshes are coarse, so that the tests are quick.
const BELOW: f64 = 0.15;
/// How much it may be above: more would say that what is measured is not the interpolation.
const ABOVE: f64 = 0.3;

/// Errors on two meshes, and the orders between them.
struct Row {
    law: &'static Law,
    element: &'static Element,
    cells: [usize; 2],
    finest: Errors,
    order: Errors,
}

impl Row {
    fn measure(law: &'static Law, element: &'static Element, cells: [usize; 2], distortion: Distortion) -> Row {
        let field = Field::new(law, element.dimension());
        let [coarse, finest] = cells.map(|n| solve(&field, law, element, n, distortion));
        let ratio = cells[1] as f64 / cells[0] as f64;
        let order = |of: fn(&Errors) -> f64| (of(&coarse) / of(&finest)).ln() / ratio.ln();
        let order = Errors { displacement: order(|e| e.displacement), energy: order(|e| e.energy) };
        Row { law, element, cells, finest, order }
    }

    /// The row of the table, printed and compared with the one in docs/validation.md where there is one.
    fn report(&self, distortion: Distortion) {
        let (coarse, fine) = (self.cells[0], self.cells[1]);
        let shapes = match distortion {
            Distortion::Smooth => "smooth",
            Distortion::Trapezoids => "trapezoids",
        };
        let head = format!("| {} | {} | {shapes} | {coarse}, {fine} |", self.element.id, self.law.name);
        let numbers = [self.finest.displacement, self.order.displacement, self.finest.energy, self.order.energy];
        let [u, du, e, de] = numbers;
        let line = format!("{head} {u:.1e} | {du:.2} | {e:.1e} | {de:.2} |");
        println!("{line}");
        let page = include_str!("../../../../docs/validation.md");
        let Some(known) = page.lines().find_map(|known| known.strip_prefix(&head)) else { return };
        let known: Vec<f64> = known.split('|').filter_map(|cell| cell.trim().parse().ok()).collect();
        assert_eq!(known.len(), 4, "docs/validation.md: four numbers after `{head}`");
        // Errors have two digits there, orders two decimals.
        let same = |k: usize, tolerance: f64| (known[k] - numbers[k]).abs() <= tolerance;
        let agree = same(0, 0.06 * u) && same(1, 0.011) && same(2, 0.06 * e) && same(3, 0.011);
        assert!(agree, "docs/validation.md says otherwise; the row is now\n{line}");
    }

    fn expect(&self, displacement: f64, energy: f64) {
        let cases = [("L²", self.order.displacement, displacement), ("energy", self.order.energy, energy)];
        for (norm, found, expected) in cases {
            let what = format!("{} with {}: order {found:.3} in {norm}", self.element.id, self.law.name);
            assert!(found >= expected - BELOW, "{what}, {expected} expected");
            assert!(found <= expected + ABOVE, "{what}, no more than {expected} expected");
        }
    }
}

/// Every element of a family has the order of its degree, on smoothly distorted meshes with curved elements.
fn family(family: Family) {
    let hooke = souple_laws::by_id("hooke").unwrap();
    for &element in souple_elements::all().iter().filter(|e| e.family == family) {
        let cells = match (family.dimension(), element.degree) {
            (1 | 2, _) => [8, 16],
            (_, 1) => [6, 12],
            (_, 2) => [4, 8],
            _ => [3, 6],
        };
        let row = Row::measure(hooke, element, cells, Distortion::Smooth);
        row.report(Distortion::Smooth);
        let p = f64::from(element.degree);
        row.expect(p + 1.0, p);
    }
}

/// One element of degree two of each family has its order with a law that is not linear, at strains of up to a third.
fn nonlinear(family: Family) {
    let law = souple_laws::by_id("neo-hookean").unwrap();
    let element = souple_elements::all().iter().find(|e| e.family == family && e.degree == 2).unwrap();
    let cells = if family.dimension() < 3 { [8, 16] } else { [3, 6] };
    let row = Row::measure(law, element, cells, Distortion::Smooth);
    row.report(Distortion::Smooth);
    row.expect(3.0, 2.0);
}

/// One test per family, so that they run beside each other.
macro_rules! families {
    ($($name:ident: $family:ident),* $(,)?) => {
        $(mod $name {
            #[test]
            fn linear() {
                super::family(souple_elements::Family::$family);
            }

            #[test]
            fn nonlinear() {
                super::nonlinear(souple_elements::Family::$family);
            }
        })*

        /// No family is forgotten.
        #[test]
        fn every_family_is_tested() {
            assert_eq!([$(Family::$family),*], Family::ALL);
        }
    };
}

families! {
    edges: Edge,
    triangles: Triangle,
    quadrangles: Quadrangle,
    tetrahedra: Tetrahedron,
    hexahedra: Hexahedron,
    prisms: Prism,
    pyramids: Pyramid,
}

/// On trapezoids that stay trapezoids, quadrangles that hold all products of their degree keep their order, and the
/// serendipity quadrangle loses one: what theory says, and a reason to prefer `quad9` where meshes are bad.
#[test]
fn trapezoids_cost_serendipity_elements_an_order() {
    let hooke = souple_laws::by_id("hooke").unwrap();
    for (id, cells, displacement, energy) in
        [("quad4", [8, 16], 2.0, 1.0), ("quad9", [8, 16], 3.0, 2.0), ("quad8", [32, 64], 2.0, 1.0)]
    {
        let element = souple_elements::by_id(id).unwrap();
        let row = Row::measure(hooke, element, cells, Distortion::Trapezoids);
        row.report(Distortion::Trapezoids);
        row.expect(displacement, energy);
    }
}
