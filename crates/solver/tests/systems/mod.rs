//! The system that the tests of this crate integrate: a chain of masses with springs and pendulums.
//!
//! ```text
//! m ü_i = s(u_{i+1} − u_i) − s(u_i − u_{i−1}) − g sin u_i − α m u̇_i + δ (u̇_{i+1} − 2 u̇_i + u̇_{i−1}),
//! s(d) = k d + k₃ d³,   u_{−1} = u_n = 0
//! ```

use souple_solver::{
    CgOptions, CgWorkspace, Combination, Failure, FixedUnknowns, Identity, LinearReport, NoProjection, OperatorFromFn,
    Projector, SecondOrder, Serial, cg,
};

/// Prescribed (displacement, velocity) at a time.
pub(crate) type Motion = fn(f64) -> (f64, f64);

pub(crate) struct Chain {
    pub(crate) mass: Vec<f64>,
    pub(crate) stiffness: f64,
    pub(crate) cubic: f64,
    pub(crate) gravity: f64,
    pub(crate) mass_damping: f64,
    pub(crate) spring_damping: f64,
    /// Adds this × the mass of each spring's two ends as a consistent coupling.
    pub(crate) mass_coupling: f64,
    pub(crate) moved: Vec<(usize, Motion)>,
    /// Springs longer than this are refused.
    pub(crate) longest: f64,
    pub(crate) options: CgOptions,
    linearised: Vec<f64>,
}

impl Chain {
    pub(crate) fn new(len: usize) -> Self {
        Self {
            mass: vec![1.0; len],
            stiffness: 1.0,
            cubic: 0.0,
            gravity: 0.0,
            mass_damping: 0.0,
            spring_damping: 0.0,
            mass_coupling: 0.0,
            moved: Vec::new(),
            longest: f64::INFINITY,
            options: CgOptions { relative_tolerance: 1e-14, absolute_tolerance: 1e-300, max_iterations: 200 },
            linearised: vec![0.0; len],
        }
    }

    pub(crate) fn fixed(&self) -> FixedUnknowns {
        FixedUnknowns { indices: self.moved.iter().map(|&(index, _)| index).collect() }
    }

    #[allow(dead_code, reason = "each test file uses a part of this system")]
    pub(crate) fn energy(&self, u: &[f64], v: &[f64]) -> f64 {
        let kinetic: f64 = self.mass.iter().zip(v).map(|(m, v)| 0.5 * m * v * v).sum();
        let springs: f64 = (0..=u.len())
            .map(|i| {
                let d = stretch(u, i);
                0.5 * self.stiffness * d * d + 0.25 * self.cubic * d.powi(4)
            })
            .sum();
        let pendulums: f64 = u.iter().map(|u| self.gravity * (1.0 - u.cos())).sum();
        kinetic + springs + pendulums
    }

    fn mass_product(&self, x: &[f64], y: &mut [f64]) {
        for i in 0..x.len() {
            y[i] = self.mass[i] * x[i];
        }
        for i in 1..x.len() {
            y[i] += self.mass_coupling * x[i - 1];
            y[i - 1] += self.mass_coupling * x[i];
        }
    }

    fn stiffness_product(&self, x: &[f64], y: &mut [f64]) {
        for i in 0..x.len() {
            y[i] = self.gravity * self.linearised[i].cos() * x[i];
        }
        for i in 0..=x.len() {
            let d = stretch(&self.linearised, i);
            let tension = (self.stiffness + 3.0 * self.cubic * d * d) * stretch(x, i);
            spread(-tension, i, y);
        }
    }

    fn damping_product(&self, x: &[f64], y: &mut [f64]) {
        for i in 0..x.len() {
            y[i] = self.mass_damping * self.mass[i] * x[i];
        }
        for i in 0..=x.len() {
            spread(-self.spring_damping * stretch(x, i), i, y);
        }
    }
}

/// Lengthening of spring i, between unknowns i − 1 and i; both ends of the chain are walls.
fn stretch(u: &[f64], i: usize) -> f64 {
    let right = if i < u.len() { u[i] } else { 0.0 };
    let left = if i > 0 { u[i - 1] } else { 0.0 };
    right - left
}

/// Adds a tension of spring i to the forces on its ends.
fn spread(tension: f64, i: usize, force: &mut [f64]) {
    if i < force.len() {
        force[i] -= tension;
    }
    if i > 0 {
        force[i - 1] += tension;
    }
}

impl SecondOrder for Chain {
    fn len(&self) -> usize {
        self.mass.len()
    }

    fn force(&mut self, _t: f64, u: &[f64], v: &[f64], out: &mut [f64]) -> Result<(), Failure> {
        for i in 0..u.len() {
            out[i] = -self.gravity * u[i].sin() - self.mass_damping * self.mass[i] * v[i];
        }
        for i in 0..=u.len() {
            let d = stretch(u, i);
            if d.abs() > self.longest {
                return Err(Failure::inadmissible(Some(i), format!("spring {i} is stretched by {d}")));
            }
            let tension = self.stiffness * d + self.cubic * d.powi(3) + self.spring_damping * stretch(v, i);
            spread(tension, i, out);
        }
        Ok(())
    }

    fn mass_apply(&mut self, x: &[f64], y: &mut [f64]) {
        self.mass_product(x, y);
    }

    fn mass_solve(&mut self, rhs: &[f64], x: &mut [f64]) -> LinearReport {
        let operator = OperatorFromFn { len: x.len(), product: |x: &[f64], y: &mut [f64]| self.mass_product(x, y) };
        cg(&operator, &Identity, &self.fixed(), &Serial, rhs, x, &self.options, &mut CgWorkspace::new(rhs.len()))
    }

    fn linearise(&mut self, _t: f64, u: &[f64], _v: &[f64]) -> Result<(), Failure> {
        self.linearised.copy_from_slice(u);
        Ok(())
    }

    fn stiffness_apply(&mut self, x: &[f64], y: &mut [f64]) {
        self.stiffness_product(x, y);
    }

    fn damping_apply(&mut self, x: &[f64], y: &mut [f64]) {
        self.damping_product(x, y);
    }

    fn solve(&mut self, combination: Combination, rhs: &[f64], x: &mut [f64]) -> LinearReport {
        let Combination { mass, damping, stiffness } = combination;
        let operator = OperatorFromFn {
            len: x.len(),
            product: |x: &[f64], y: &mut [f64]| {
                let mut part = vec![0.0; x.len()];
                self.mass_product(x, y);
                y.iter_mut().for_each(|y| *y *= mass);
                self.damping_product(x, &mut part);
                y.iter_mut().zip(&part).for_each(|(y, part)| *y += damping * part);
                self.stiffness_product(x, &mut part);
                y.iter_mut().zip(&part).for_each(|(y, part)| *y += stiffness * part);
            },
        };
        let mut workspace = CgWorkspace::new(rhs.len());
        if self.moved.is_empty() {
            cg(&operator, &Identity, &NoProjection, &Serial, rhs, x, &self.options, &mut workspace)
        } else {
            cg(&operator, &Identity, &self.fixed(), &Serial, rhs, x, &self.options, &mut workspace)
        }
    }

    fn project(&self, v: &mut [f64]) {
        self.fixed().project(v);
    }

    fn prescribe(&self, t: f64, u: &mut [f64], v: &mut [f64]) {
        for &(index, motion) in &self.moved {
            (u[index], v[index]) = motion(t);
        }
    }

    fn admissible(&mut self, _t: f64, u: &[f64], _v: &[f64]) -> Result<(), Failure> {
        match (0..=u.len()).find(|&i| stretch(u, i).abs() > self.longest) {
            Some(i) => Err(Failure::inadmissible(Some(i), format!("spring {i} is too long"))),
            None => Ok(()),
        }
    }
}
