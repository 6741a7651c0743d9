//! The largest eigenvalue of A x = λ M x, by the Lanczos recurrence in the inner product of M.
//!
//! ```text
//! M⁻¹ A Q = Q T + β_k q_{k+1} e_kᵀ,   Qᵀ M Q = I,   T tridiagonal
//! ```
//!
//! The largest eigenvalue θ of T approaches that of the pencil from below, and there is an eigenvalue within
//! β_k |s_k| of θ, s the eigenvector of T.
//! Vectors are not reorthogonalised: that repeats eigenvalues that have converged but moves none.
//!
//! The start vector is fixed (pseudo-random entries from a constant seed): same system, same bits.
//!
//! Reference: B. N. Parlett, "The Symmetric Eigenvalue Problem", 1980, ch. 13.

use crate::failure::{Failure, FailureKind};
use crate::vector::{Serial, VectorOps};

/// The products that the recurrence needs, on the range of a projection.
pub trait Pencil {
    /// Number of unknowns.
    fn len(&self) -> usize;

    /// Whether there are no unknowns.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// y ← P A x
    fn multiply(&mut self, x: &[f64], y: &mut [f64]);

    /// y ← P M x
    fn mass_multiply(&mut self, x: &[f64], y: &mut [f64]);

    /// Solves P M P x = b.
    ///
    /// # Errors
    /// A [`Failure`] when the mass cannot be inverted.
    fn mass_solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), Failure>;

    /// v ← P v
    fn project(&self, v: &mut [f64]);
}

/// When to stop.
#[derive(Clone, Debug, PartialEq)]
pub struct LanczosOptions {
    /// Stop when the error bound is below this × the eigenvalue.
    pub relative_tolerance: f64,
    /// Products at most.
    pub max_products: usize,
}

impl Default for LanczosOptions {
    fn default() -> Self {
        Self { relative_tolerance: 1e-3, max_products: 200 }
    }
}

/// An eigenvalue and how well it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct LargestEigenvalue {
    /// The estimate θ, never above the largest eigenvalue but for rounding.
    pub value: f64,
    /// Distance from θ within which there is an eigenvalue.
    pub error: f64,
    /// Products with A.
    pub products: usize,
    /// Whether the tolerance was met.
    pub converged: bool,
}

/// Finds the largest eigenvalue, and writes an approximate eigenvector x with xᵀ M x = 1 into `vector`.
///
/// # Errors
/// A [`Failure`] when the mass cannot be inverted or a product is not finite.
pub fn largest_eigenvalue(
    pencil: &mut dyn Pencil,
    options: &LanczosOptions,
    vector: &mut [f64],
) -> Result<LargestEigenvalue, Failure> {
    vector.fill(0.0);
    let mut run = Recurrence::start(pencil)?;
    if run.exhausted {
        return Ok(LargestEigenvalue { value: 0.0, error: 0.0, products: 0, converged: true });
    }
    let (mut value, mut error) = (0.0f64, f64::INFINITY);
    let mut converged = false;
    let mut weights = Vec::new();
    for product in 1..=options.max_products.max(1) {
        run.advance(pencil)?;
        value = largest_of_tridiagonal(&run.alpha, &run.beta);
        weights = tridiagonal_eigenvector(&run.alpha, &run.beta, value);
        let residual = run.beta[product - 1];
        error = residual * weights[product - 1].abs();
        converged = run.exhausted || error <= options.relative_tolerance * value.abs();
        if converged {
            break;
        }
    }
    let products = run.alpha.len();
    // The basis was not kept; the same recurrence gives the same vectors once more.
    let mut run = Recurrence::start(pencil)?;
    for &weight in &weights {
        Serial.axpy(weight, &run.q, vector);
        run.advance(pencil)?;
    }
    Ok(LargestEigenvalue { value, error, products, converged })
}

struct Recurrence {
    q: Vec<f64>,
    before: Vec<f64>,
    w: Vec<f64>,
    product: Vec<f64>,
    alpha: Vec<f64>,
    /// beta[k] couples vectors k and k + 1.
    beta: Vec<f64>,
    /// The vectors so far span an invariant space.
    exhausted: bool,
}

impl Recurrence {
    fn start(pencil: &mut dyn Pencil) -> Result<Self, Failure> {
        let len = pencil.len();
        let mut run = Self {
            q: pseudo_random(len),
            before: vec![0.0; len],
            w: vec![0.0; len],
            product: vec![0.0; len],
            alpha: Vec::new(),
            beta: Vec::new(),
            exhausted: false,
        };
        pencil.project(&mut run.q);
        pencil.mass_multiply(&run.q, &mut run.product);
        let norm = Serial.dot(&run.q, &run.product).sqrt();
        check(norm)?;
        run.exhausted = norm == 0.0;
        if !run.exhausted {
            run.q.iter_mut().for_each(|q| *q /= norm);
        }
        Ok(run)
    }

    fn advance(&mut self, pencil: &mut dyn Pencil) -> Result<(), Failure> {
        pencil.multiply(&self.q, &mut self.product);
        let alpha = Serial.dot(&self.q, &self.product);
        check(alpha)?;
        let scale = alpha.abs();
        self.w.fill(0.0);
        pencil.mass_solve(&self.product, &mut self.w)?;
        let previous = self.beta.last().copied().unwrap_or(0.0);
        for i in 0..self.w.len() {
            self.w[i] -= alpha * self.q[i] + previous * self.before[i];
        }
        pencil.mass_multiply(&self.w, &mut self.product);
        let beta = Serial.dot(&self.w, &self.product).max(0.0).sqrt();
        check(beta)?;
        self.alpha.push(alpha);
        self.beta.push(beta);
        // Below this, the new direction is the rounding of the old ones.
        if beta <= 1e-14 * (scale + previous) || beta == 0.0 {
            self.exhausted = true;
            return Ok(());
        }
        std::mem::swap(&mut self.q, &mut self.before);
        for (q, w) in self.q.iter_mut().zip(&self.w) {
            *q = w / beta;
        }
        Ok(())
    }
}

fn check(value: f64) -> Result<(), Failure> {
    if value.is_finite() {
        return Ok(());
    }
    Err(Failure {
        kind: FailureKind::NotFinite,
        place: None,
        message: "a matrix product is not finite, or the mass is not positive; no eigenvalue can be estimated".into(),
    })
}

/// Entries in [−1, 1) from a linear congruential generator with a fixed seed (Knuth's constants).
fn pseudo_random(len: usize) -> Vec<f64> {
    let mut state = 0x5EED_u64;
    (0..len)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        })
        .collect()
}

/// Largest eigenvalue of the tridiagonal matrix with diagonal `alpha` and off-diagonal `beta[..n − 1]`, by bisection on
/// the number of eigenvalues below a point (the negative pivots of T − x I).
fn largest_of_tridiagonal(alpha: &[f64], beta: &[f64]) -> f64 {
    let n = alpha.len();
    let off = |i: usize| if i + 1 < n { beta[i].abs() } else { 0.0 };
    // Gershgorin's discs hold every eigenvalue.
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for i in 0..n {
        let radius = off(i) + if i > 0 { off(i - 1) } else { 0.0 };
        low = low.min(alpha[i] - radius);
        high = high.max(alpha[i] + radius);
    }
    let below = |x: f64| {
        let mut count = 0;
        let mut pivot = 1.0;
        for i in 0..n {
            let coupling = if i > 0 { beta[i - 1] * beta[i - 1] } else { 0.0 };
            pivot = alpha[i] - x - coupling / pivot;
            if pivot == 0.0 {
                pivot = -f64::MIN_POSITIVE;
            }
            count += usize::from(pivot < 0.0);
        }
        count
    };
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if below(middle) == n {
            high = middle;
        } else {
            low = middle;
        }
    }
}

/// Unit eigenvector of an extreme eigenvalue, by the recurrence from the last component up: it grows in that direction,
/// so rounding does not.
fn tridiagonal_eigenvector(alpha: &[f64], beta: &[f64], value: f64) -> Vec<f64> {
    let n = alpha.len();
    let mut s = vec![0.0; n];
    s[n - 1] = 1.0;
    for i in (1..n).rev() {
        let next = if i + 1 < n { beta[i] * s[i + 1] } else { 0.0 };
        s[i - 1] = ((value - alpha[i]) * s[i] - next) / beta[i - 1];
        if s[i - 1].abs() > 1e100 {
            s[i - 1..].iter_mut().for_each(|entry| *entry *= 1e-100);
        }
    }
    let norm = s.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
    s.iter_mut().for_each(|entry| *entry /= norm);
    s
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bisection and recurrence find the closed-form largest eigenpair of the second difference matrix.
    #[test]
    fn tridiagonal_eigenpair() {
        for n in [1, 2, 5, 40] {
            let (alpha, beta) = (vec![2.0; n], vec![-1.0; n]);
            let angle = std::f64::consts::PI / (n as f64 + 1.0);
            let expected = 2.0 - 2.0 * (n as f64 * angle).cos();
            let value = largest_of_tridiagonal(&alpha, &beta);
            assert!((value - expected).abs() < 1e-13, "n = {n}: {value} is not {expected}");
            let s = tridiagonal_eigenvector(&alpha, &beta, value);
            for i in 0..n {
                let left = if i > 0 { s[i - 1] } else { 0.0 };
                let right = if i + 1 < n { s[i + 1] } else { 0.0 };
                assert!((2.0 * s[i] - left - right - expected * s[i]).abs() < 1e-12, "n = {n}, row {i}");
            }
        }
    }
}
