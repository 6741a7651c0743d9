//! The largest time step with which a method is stable.
//!
//! Each mode of the linearised system behaves like ü + d u̇ + ω² u = 0.
//! A method multiplies it by some matrix per step, and is stable while that matrix does not grow:
//!
//! | method | h below | note |
//! |---|---|---|
//! | symplectic Euler | (√(d² + 4ω²) − d)/ω² | 2/ω without damping, less with it: damping is taken at the old velocity |
//! | explicit Euler | d/ω² for d < 2ω, else 4/(d + √(d² − 4ω²)) | without damping no step is stable, and we refuse |
//! | RK2 | where ∣1 + z + z²/2∣ = 1, z = h (−d ± √(d² − 4ω²))/2 | without damping no step is stable, and we refuse |
//! | RK4 | where ∣1 + z + z²/2 + z³/6 + z⁴/24∣ = 1 | 2√2/ω without damping |
//! | Newmark, 2β < γ | 1/(ω √(γ/2 − β)) | 2/ω for β = 0, γ = ½ |
//! | all others | any | |
//!
//! *Which mode decides.* For symplectic Euler and Newmark the bound falls with both d and ω, so the largest ω and the
//! largest d, taken together, are safe whatever the damping.
//! For the Runge–Kutta methods (explicit Euler is one) damping helps fast modes, so two modes are looked at: that of the
//! largest ω with its own d, and that of the largest d with its own ω. With Rayleigh damping, d = α + β ω², these decide;
//! with other damping the answer is an estimate, and [`CriticalStep::exact_damping`] says so.
//!
//! A stiffness that is not positive (a buckled state) grows in truth and not through the method; only its positive
//! modes limit the step.
//!
//! Reference: T. J. R. Hughes, "The Finite Element Method", 1987, §9.1–9.2.

use crate::failure::Failure;
use crate::lanczos::{LanczosOptions, LargestEigenvalue, Pencil, largest_eigenvalue};
use crate::method::Method;
use crate::second_order::SecondOrder;
use crate::vector::{Serial, VectorOps};

/// Which steps are stable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepBound {
    /// Every step.
    Unconditional,
    /// Steps up to this many seconds.
    UpTo(f64),
    /// No step: the method lets an undamped (or hardly damped) mode grow however short the step.
    NoStep,
}

/// The stability of a method on a system about one state.
#[derive(Clone, Debug, PartialEq)]
pub struct CriticalStep {
    /// Which steps are stable.
    pub bound: StepBound,
    /// Largest frequency ω in rad/s (error bound of the estimate included).
    pub frequency: f64,
    /// Largest damping d = max vᵀDv / vᵀMv in 1/s (error bound of the estimate included).
    pub damping: f64,
    /// Products with stiffness and damping.
    pub products: usize,
    /// Whether both eigenvalues met their tolerance.
    pub converged: bool,
    /// Whether the bound holds for any damping, rather than for Rayleigh damping only.
    pub exact_damping: bool,
}

/// Finds the critical step of a method about a state.
///
/// # Errors
/// A [`Failure`] when the system cannot be linearised there or its mass cannot be inverted.
pub fn critical_step(
    system: &mut dyn SecondOrder,
    t: f64,
    u: &[f64],
    v: &[f64],
    method: Method,
    options: &LanczosOptions,
) -> Result<CriticalStep, Failure> {
    system.linearise(t, u, v)?;
    let mut fastest = vec![0.0; system.len()];
    let mut most_damped = vec![0.0; system.len()];
    let stiff = largest_eigenvalue(&mut Stiffness(system), options, &mut fastest)?;
    let damped = largest_eigenvalue(&mut Damping(system), options, &mut most_damped)?;
    let frequency = upper(&stiff).sqrt();
    let damping = upper(&damped);

    let (bound, exact_damping) = match method {
        Method::ExplicitEuler | Method::Rk2 | Method::Rk4 => {
            let of_fastest = rayleigh_quotient(&mut Damping(system), &fastest);
            let of_most_damped = rayleigh_quotient(&mut Stiffness(system), &most_damped).sqrt();
            let bounds = [(frequency, of_fastest), (of_most_damped, damping)].map(|(w, d)| stable_step(method, w, d));
            (tighter(bounds[0], bounds[1]), damping == 0.0)
        }
        _ => (stable_step(method, frequency, damping), true),
    };
    Ok(CriticalStep {
        bound,
        frequency,
        damping,
        products: stiff.products + damped.products,
        converged: stiff.converged && damped.converged,
        exact_damping,
    })
}

/// The bound of a method on the single mode ü + d u̇ + ω² u = 0, ω in rad/s and d in 1/s, neither negative.
pub fn stable_step(method: Method, frequency: f64, damping: f64) -> StepBound {
    let (w, d) = (frequency, damping);
    match method {
        _ if w == 0.0 && d == 0.0 => StepBound::Unconditional,
        // The same as in the table, written so that nothing cancels.
        Method::SymplecticEuler => StepBound::UpTo(4.0 / ((d * d + 4.0 * w * w).sqrt() + d)),
        Method::ExplicitEuler => explicit_bound(w, d, 1),
        Method::Rk2 => explicit_bound(w, d, 2),
        Method::Rk4 => explicit_bound(w, d, 4),
        Method::Newmark { beta, gamma } if 2.0 * beta < gamma && w > 0.0 => {
            StepBound::UpTo(1.0 / (w * (0.5 * gamma - beta).sqrt()))
        }
        Method::ImplicitEuler | Method::ImplicitMidpoint | Method::Bdf2 | Method::Newmark { .. } => {
            StepBound::Unconditional
        }
    }
}

/// The bound of a Runge–Kutta method whose stability function is the exponential series up to `order`.
fn explicit_bound(w: f64, d: f64, order: usize) -> StepBound {
    let discriminant = d * d - 4.0 * w * w;
    // The root of μ² + d μ + ω² = 0 of largest magnitude; of a complex pair one is as good as the other.
    let (re, im) = if discriminant < 0.0 {
        (-0.5 * d, 0.5 * (-discriminant).sqrt())
    } else {
        (-0.5 * (d + discriminant.sqrt()), 0.0)
    };
    let size = re.hypot(im);
    let (re, im) = (re / size, im / size);
    if order == 1 {
        // |1 + z|² = 1 + 2 Re z + |z|²
        return if re < 0.0 { StepBound::UpTo(-2.0 * re / size) } else { StepBound::NoStep };
    }
    // Along the ray z = s (re, im): walk out to the first unstable point, then bisect.
    let growth = |s: f64| growth(s * re, s * im, order);
    let mut stable = 1e-3;
    if growth(stable) > 0.0 {
        return StepBound::NoStep;
    }
    let mut unstable = stable;
    while growth(unstable) <= 0.0 {
        stable = unstable;
        unstable *= 1.01;
    }
    for _ in 0..60 {
        let middle = 0.5 * (stable + unstable);
        if growth(middle) <= 0.0 {
            stable = middle;
        } else {
            unstable = middle;
        }
    }
    StepBound::UpTo(stable / size)
}

/// |R(z)|² − 1 with R(z) = 1 + w, w = z + z²/2 + …, as 2 Re w + |w|²: exact near zero, where it decides.
fn growth(re: f64, im: f64, order: usize) -> f64 {
    let (mut term_re, mut term_im) = (1.0, 0.0);
    let (mut w_re, mut w_im) = (0.0, 0.0);
    for k in 1..=order {
        let scale = 1.0 / k as f64;
        (term_re, term_im) = ((term_re * re - term_im * im) * scale, (term_re * im + term_im * re) * scale);
        w_re += term_re;
        w_im += term_im;
    }
    2.0 * w_re + w_re * w_re + w_im * w_im
}

fn tighter(a: StepBound, b: StepBound) -> StepBound {
    match (a, b) {
        (StepBound::NoStep, _) | (_, StepBound::NoStep) => StepBound::NoStep,
        (StepBound::Unconditional, other) | (other, StepBound::Unconditional) => other,
        (StepBound::UpTo(a), StepBound::UpTo(b)) => StepBound::UpTo(a.min(b)),
    }
}

/// The estimate plus its error: a step that is a little too short is the safe side.
fn upper(eigenvalue: &LargestEigenvalue) -> f64 {
    (eigenvalue.value + eigenvalue.error).max(0.0)
}

/// xᵀ A x for a vector with xᵀ M x = 1 (or zero), not below zero.
fn rayleigh_quotient(pencil: &mut dyn Pencil, x: &[f64]) -> f64 {
    let mut product = vec![0.0; x.len()];
    pencil.multiply(x, &mut product);
    Serial.dot(x, &product).max(0.0)
}

/// K x = λ M x
struct Stiffness<'a>(&'a mut dyn SecondOrder);
/// D x = λ M x
struct Damping<'a>(&'a mut dyn SecondOrder);

impl Pencil for Stiffness<'_> {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn multiply(&mut self, x: &[f64], y: &mut [f64]) {
        self.0.stiffness_apply(x, y);
        self.0.project(y);
    }

    fn mass_multiply(&mut self, x: &[f64], y: &mut [f64]) {
        self.0.mass_apply(x, y);
        self.0.project(y);
    }

    fn mass_solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), Failure> {
        mass_solve(self.0, b, x)
    }

    fn project(&self, v: &mut [f64]) {
        self.0.project(v);
    }
}

impl Pencil for Damping<'_> {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn multiply(&mut self, x: &[f64], y: &mut [f64]) {
        self.0.damping_apply(x, y);
        self.0.project(y);
    }

    fn mass_multiply(&mut self, x: &[f64], y: &mut [f64]) {
        self.0.mass_apply(x, y);
        self.0.project(y);
    }

    fn mass_solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), Failure> {
        mass_solve(self.0, b, x)
    }

    fn project(&self, v: &mut [f64]) {
        self.0.project(v);
    }
}

fn mass_solve(system: &mut dyn SecondOrder, b: &[f64], x: &mut [f64]) -> Result<(), Failure> {
    let report = system.mass_solve(b, x);
    if report.usable() {
        Ok(())
    } else {
        Err(Failure {
            kind: crate::failure::FailureKind::LinearSolve,
            place: None,
            message: format!("the mass cannot be inverted: {:?}", report.status),
        })
    }
}
