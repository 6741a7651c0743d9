//! Viscous products, and tangents made positive.
//!
//! Both are further families of programs beside those of the law ([`crate::companion`]); what they share with the elastic
//! products (gathering, partial contributions, sums per node in a fixed order) is that of [`Elements`].

use crate::AssemblyMap;
use crate::companion::{Companion, Family};
use crate::elements::{Block, Destination, Elements};
use crate::projection::make_positive;
use souple_kernels::{Aligned, Backend, CompileError, LANES};
use souple_program::Costs;
use souple_solver::SymmetricBlocks;

/// Which derivative of the forces products and matrices use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Tangent {
    /// The derivative itself: Newton converges quadratically, but the matrix may have negative curvature.
    #[default]
    Exact,
    /// With the moduli of each quadrature point replaced by the nearest positive semi-definite ones: the stiffness matrix
    /// is never indefinite, and every Newton step leads downhill.
    Projected,
}

impl Elements {
    /// The tangent that was chosen.
    pub fn tangent(&self) -> Tangent {
        self.tangent
    }

    /// Chooses the tangent; derives and compiles what it needs.
    ///
    /// [`Elements::linearise`] must be called before the next product or assembly.
    ///
    /// # Errors
    /// When the backend refuses a program.
    pub fn set_tangent(&mut self, tangent: Tangent, backend: &dyn Backend, costs: Costs) -> Result<(), CompileError> {
        self.tangent = tangent;
        for block in &mut self.blocks {
            block.projected = match tangent {
                Tangent::Exact => None,
                Tangent::Projected => {
                    let lanes = block.groups * LANES;
                    let mut companion = Companion::projected(&block.derived, backend, costs, lanes)?;
                    block.set_up_companion(&mut companion);
                    Some(companion)
                }
            };
        }
        Ok(())
    }

    /// Computes the moduli at `u` and makes them positive.
    pub(crate) fn project_moduli(&mut self, u: &[f64]) {
        let dimension = self.dimension;
        for block in &mut self.blocks {
            let companion = block.projected.as_ref().expect("projected tangents have their programs");
            let kernel = companion.moduli.clone().expect("the projected family computes moduli");
            block.run(&kernel, Family::Projected, Some(u), None, Destination::Moduli, &self.threads, &mut self.scratch);
            let output = &kernel.program().outputs[0];
            let (entries, rows) = (output.len, output.total(kernel.program().points));
            // Entries of H: rows for the axes of space, columns for those of the element.
            let size = dimension * block.spec.element.dimension();
            let companion = block.projected.as_mut().expect("as above");
            let mut tasks: Vec<&mut [f64]> = companion.given.chunks_mut(64 * rows * LANES).collect();
            self.threads.run(&mut tasks, |groups| {
                let mut lower = vec![0.0; entries];
                for point in groups.chunks_mut(entries * LANES) {
                    for lane in 0..LANES {
                        for (entry, l) in lower.iter_mut().enumerate() {
                            *l = point[entry * LANES + lane];
                        }
                        make_positive(&mut lower, size);
                        for (entry, l) in lower.iter().enumerate() {
                            point[entry * LANES + lane] = *l;
                        }
                    }
                }
            });
            // Moduli of a linear law are the same at all points and were computed once; their readers want them at each.
            let apply = companion.apply.program();
            let wanted = apply.input("moduli").map_or(rows, |b| apply.inputs[b].total(apply.points));
            if wanted != rows {
                let once = std::mem::take(&mut companion.given);
                let mut spread = Aligned::zeros(once.len() / rows * wanted);
                for (group, points) in once.chunks(rows * LANES).zip(spread.chunks_mut(wanted * LANES)) {
                    points.chunks_mut(rows * LANES).for_each(|point| point.copy_from_slice(group));
                }
                companion.given = spread;
            }
        }
    }

    /// Whether any element is viscous.
    pub fn is_viscous(&self) -> bool {
        self.blocks.iter().any(|b| b.viscous.is_some())
    }

    pub(crate) fn set_up_viscosity(&mut self, backend: &dyn Backend, costs: Costs) -> Result<(), CompileError> {
        for block in &mut self.blocks {
            if block.spec.viscosity.is_none_or(|v| v == [0.0; 2]) {
                continue;
            }
            let mut companion = Companion::viscous(&block.derived, backend, costs, block.groups * LANES)?;
            block.set_up_companion(&mut companion);
            block.viscous = Some(companion);
        }
        Ok(())
    }

    /// Prepares [`Elements::add_damping`] at `u`.
    pub fn linearise_damping(&mut self, u: &[f64]) {
        for block in &mut self.blocks {
            let Some(kernel) = block.viscous.as_ref().and_then(|v| v.linearise.clone()) else { continue };
            block.run(&kernel, Family::Viscous, Some(u), None, Destination::Step, &self.threads, &mut self.scratch);
        }
    }

    /// `out += scale · C v` with the viscous matrix C in N s/m at the state of the last [`Elements::linearise_damping`].
    pub fn add_damping(&mut self, scale: f64, v: &[f64], out: &mut [f64]) {
        for block in &mut self.blocks {
            match &block.viscous {
                None => block.forget_contributions(),
                Some(viscous) => {
                    let kernel = viscous.apply.clone();
                    let (threads, scratch) = (&self.threads, &mut self.scratch);
                    block.run(&kernel, Family::Viscous, None, Some(v), Destination::Partial, threads, scratch);
                }
            }
        }
        self.collect(scale, out);
    }

    /// Overwrites `matrix` by C at `u`.
    pub fn assemble_damping(&mut self, u: &[f64], map: &AssemblyMap, matrix: &mut SymmetricBlocks) {
        let kernel_of = |block: &Block| block.viscous.as_ref().map(|v| (v.blocks.clone(), Family::Viscous));
        self.assemble_with(u, map, matrix, &kernel_of);
    }
}
