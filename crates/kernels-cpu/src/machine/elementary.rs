//! ln, exp and pow without branches, so that a compiler makes vectors of loops over lanes.
//!
//! ```text
//! exp x:   k = round(x / ln 2),  r = x − k ln 2,  2ᵏ Σ rⁿ/n!                                |r| ≤ ln 2 / 2
//! ln x:    x = 2ᵏ m,  m in [√½, √2),  s = (m − 1)/(m + 1),  k ln 2 + 2 Σ s²ⁿ⁺¹/(2n + 1)     |s| ≤ 0.172
//! xʸ:      exp(y ln x), the logarithm and its product with y in pairs of doubles
//! ```
//!
//! Each holds for ordinary arguments, which [`ordinary_exp`] and its like tell; for others (zero, negative, subnormal,
//! infinite, not a number, results that overflow) the standard library is asked.
//! What they are not: correctly rounded. They are within a unit in the last place; tests measure it.
//!
//! Why not tables: a lookup per lane is a gather, and a few more terms cost less.

use std::f64::consts::LOG2_E;

/// ln 2 in two parts, the first so short that its products with exponents are exact.
const LN2: [f64; 2] = [f64::from_bits(0x3fe6_2e42_fee0_0000), 1.908_214_929_270_587_7e-10];

/// What 2/3 lost when it was rounded.
const TWO_THIRDS_LOST: f64 = 3.700_743_415_417_188e-17;

/// Adding this rounds to a whole number, which then stands in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Bits of the double next to √½.
const SQRT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
const ONE: u64 = 0x3ff0_0000_0000_0000;
const FRACTION: u64 = (1 << 52) - 1;

/// 1/n! from n = 2 on.
const INVERSE_FACTORIALS: [f64; 12] = {
    let mut list = [0.5; 12];
    let mut factorial = 2.0;
    let mut k = 1;
    while k < 12 {
        factorial *= (k + 2) as f64;
        list[k] = 1.0 / factorial;
        k += 1;
    }
    list
};

/// 2/(2n + 1) from n = `first` on.
const fn odd(first: usize) -> [f64; 12] {
    let mut list = [0.0; 12];
    let mut k = 0;
    while k < 12 {
        list[k] = 2.0 / (2 * (first + k) + 1) as f64;
        k += 1;
    }
    list
}

/// Σ cₙ xⁿ by halves of halves (Estrin): every step waits for one before it, where Horner's scheme has a chain of all.
#[inline(always)]
fn twelve(c: &[f64; 12], x: f64) -> f64 {
    let square = x * x;
    let fourth = square * square;
    let pair = |k: usize| c[k + 1].mul_add(x, c[k]);
    let quad = |k: usize| pair(k + 2).mul_add(square, pair(k));
    quad(8).mul_add(fourth * fourth, quad(4).mul_add(fourth, quad(0)))
}

/// Whether [`exp`] holds for this argument.
#[inline(always)]
pub(super) fn ordinary_exp(x: f64) -> bool {
    x.abs() <= 700.0
}

/// Whether [`ln`] holds for this argument.
#[inline(always)]
pub(super) fn ordinary_ln(x: f64) -> bool {
    (f64::MIN_POSITIVE..=f64::MAX).contains(&x)
}

/// Whether [`pow`] holds for these arguments: a positive base, and a power between 2⁻¹⁰⁰⁰ and 2¹⁰⁰⁰.
#[inline(always)]
pub(super) fn ordinary_pow(x: f64, y: f64) -> bool {
    // Not a number where y is infinite and ln x zero, and then not ordinary either.
    ordinary_ln(x) && (y * ln(x)).abs() <= 690.0
}

/// eˣ.
#[inline(always)]
pub(super) fn exp(x: f64) -> f64 {
    exp_of_pair(x, 0.0)
}

/// e^(x + low), low being far smaller than x.
#[inline(always)]
fn exp_of_pair(x: f64, low: f64) -> f64 {
    let shifted = x.mul_add(LOG2_E, ROUND);
    let k = shifted - ROUND;
    let r = k.mul_add(-LN2[0], x);
    let rest = k.mul_add(-LN2[1], low);
    // r + rest rounded, and what rounding lost.
    let sum = r + rest;
    let lost = (r - sum) + rest;
    let p = twelve(&INVERSE_FACTORIALS, sum);
    // 1 + (sum + sum² p), with what was lost.
    let e = 1.0 + (sum.mul_add(sum * p, lost) + sum);
    e * f64::from_bits((shifted.to_bits() << 52).wrapping_add(ONE))
}

/// The exponent k and m − 1 of x = 2ᵏ m.
#[inline(always)]
fn parts(x: f64) -> (f64, f64) {
    let above = x.to_bits().wrapping_add(ONE - SQRT_HALF);
    let m = f64::from_bits((above & FRACTION).wrapping_add(SQRT_HALF));
    // The biased exponent as the fraction of 2⁵².
    let k = f64::from_bits((above >> 52) | 0x4330_0000_0000_0000) - (4_503_599_627_370_496.0 + 1023.0);
    (k, m - 1.0)
}

/// ln x.
#[inline(always)]
pub(super) fn ln(x: f64) -> f64 {
    let (k, f) = parts(x);
    let s = f / (2.0 + f);
    let w = s * s;
    let r = w * twelve(&odd(1), w);
    // 2s + s r = f − (f²/2 − s (f²/2 + r)): f is exact, and the rest is small beside it.
    let half = 0.5 * f * f;
    let small = s.mul_add(half + r, k * LN2[1]);
    k.mul_add(LN2[0], f - (half - small))
}

/// a + b exactly, for |a| ≥ |b|.
#[inline(always)]
fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    [sum, (a - sum) + b]
}

/// (a + a′)(b + b′) as a pair.
#[inline(always)]
fn times(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let p = a[0] * b[0];
    [p, a[0].mul_add(b[0], -p) + a[0].mul_add(b[1], a[1] * b[0])]
}

/// xʸ.
#[inline(always)]
pub(super) fn pow(x: f64, y: f64) -> f64 {
    let (k, f) = parts(x);
    // s with what its division and the sum below lost.
    let below = two_sum(2.0, f);
    let s = f / below[0];
    let s = [s, ((-s).mul_add(below[0], f) - s * below[1]) / below[0]];
    let w = times(s, s);
    // 2/3 + w (2/5 + …), then 2 + w (…), then s (…).
    let third = two_sum(2.0 / 3.0, w[0] * twelve(&odd(2), w[0]));
    let third = [third[0], third[1] + TWO_THIRDS_LOST];
    let inner = times(w, third);
    let two = two_sum(2.0, inner[0]);
    let fraction = times(s, [two[0], two[1] + inner[1]]);
    let whole = two_sum(k * LN2[0], fraction[0]);
    // k ln 2 is zero or greater than the fraction: at least 0.69 against at most 0.35.
    let logarithm = if k == 0.0 { fraction } else { [whole[0], whole[1] + k.mul_add(LN2[1], fraction[1])] };
    let logarithm = two_sum(logarithm[0], logarithm[1]);
    let product = times(logarithm, [y, 0.0]);
    let exponent = two_sum(product[0], product[1]);
    exp_of_pair(exponent[0], exponent[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use souple_kernels::conformance::Random;
    use std::f64::consts::LN_2;

    /// A number as the sum of two doubles, good to a hundred bits.
    type Pair = [f64; 2];

    fn sum(a: Pair, b: Pair) -> Pair {
        let s = a[0] + b[0];
        let t = s - a[0];
        let lost = (a[0] - (s - t)) + (b[0] - t);
        two_sum(s, lost + a[1] + b[1])
    }

    fn product(a: Pair, b: Pair) -> Pair {
        let [p, lost] = times(a, b);
        two_sum(p, lost)
    }

    const LN_2_PAIR: Pair = [LN_2, 2.319_046_813_846_299_6e-17];

    /// e^x by its series at (x − k ln 2)/512, squared nine times: (value, k), to be scaled by 2ᵏ.
    fn exp_of(x: Pair) -> (Pair, i32) {
        let k = (x[0] / LN_2).round();
        let r = sum(x, product([-k, 0.0], LN_2_PAIR));
        let r = [r[0] / 512.0, r[1] / 512.0];
        let mut value = [1.0, 0.0];
        for n in (1..=14).rev() {
            let over = {
                let q = r[0] / f64::from(n);
                let rest = (-q).mul_add(f64::from(n), r[0]);
                [q, (rest + r[1]) / f64::from(n)]
            };
            value = sum([1.0, 0.0], product(over, value));
        }
        for _ in 0..9 {
            value = product(value, value);
        }
        (value, k as i32)
    }

    fn ln_of(x: f64) -> Pair {
        let f = x - 1.0;
        if f.abs() < 1e-6 {
            // f − f²/2 + f³/3 − f⁴/4
            let square = product([f, 0.0], [f, 0.0]);
            let cube = f * f * f;
            let low = sum([cube / 3.0, 0.0], [-0.25 * cube * f, 0.0]);
            return sum([f, 0.0], sum([-0.5 * square[0], -0.5 * square[1]], low));
        }
        let guess = x.ln();
        let (value, k) = exp_of([-guess, 0.0]);
        // x = 2ᵏ' m keeps the product in range.
        let half = 2f64.powi(k / 2);
        let scaled = product([x * half, 0.0], [value[0], value[1]]);
        let rest = 2f64.powi(k - k / 2);
        let e = sum([scaled[0] * rest, scaled[1] * rest], [-1.0, 0.0]);
        sum([guess, 0.0], sum(e, [-0.5 * e[0] * e[0], 0.0]))
    }

    /// Distance in units in the last place of the true value 2ᵏ (a + b).
    fn units(got: f64, (truth, k): (Pair, i32)) -> f64 {
        let got = got * 2f64.powi(-k / 2) * 2f64.powi(-(k - k / 2));
        let exponent = ((truth[0].to_bits() >> 52) & 0x7ff) as i32 - 1023 - 52;
        ((got - truth[0]) - truth[1]).abs() / 2f64.powi(exponent)
    }

    fn worst(count: usize, mut case: impl FnMut(&mut Random) -> (f64, (Pair, i32))) -> f64 {
        let mut random = Random::new(29);
        (0..count)
            .map(|_| case(&mut random))
            .map(|(got, truth)| units(got, truth))
            // A NaN must not be lost.
            .fold(0.0, |w, u| if u <= w { w } else { u })
    }

    /// Any finite positive double, small and large ones as often as those near one.
    fn positive(random: &mut Random) -> f64 {
        match random.below(3) {
            0 => random.between(0.5, 2.0),
            1 => 1.0 + random.between(-1.0, 1.0) * 10f64.powf(random.between(-15.0, 0.0)) * 0.9,
            _ => 2f64.powf(random.between(-1021.0, 1023.0)),
        }
    }

    /// eˣ is within a unit in the last place over its whole range.
    #[test]
    fn exp_is_right_to_a_unit() {
        let found = worst(200_000, |random| {
            let scale = 10f64.powf(random.between(-18.0, 2.84));
            let x = random.between(-1.0, 1.0) * scale.min(700.0);
            (exp(x), exp_of([x, 0.0]))
        });
        assert!(found < 0.9, "{found} units in the last place");
        assert_eq!((exp(0.0), exp(-0.0)), (1.0, 1.0));
    }

    /// So is ln x, also beside one, where it vanishes.
    #[test]
    fn ln_is_right_to_a_unit() {
        let found = worst(200_000, |random| {
            let x = positive(random);
            (ln(x), (ln_of(x), 0))
        });
        assert!(found < 1.0, "{found} units in the last place");
        assert_eq!(ln(1.0).to_bits(), 0);
        assert!(ordinary_ln(f64::MIN_POSITIVE) && ordinary_ln(f64::MAX));
        assert!(
            (ln(f64::MAX) - f64::MAX.ln()).abs() < 2e-13
                && (ln(f64::MIN_POSITIVE) - f64::MIN_POSITIVE.ln()).abs() < 2e-13
        );
    }

    /// And xʸ, however large the power.
    #[test]
    fn pow_is_right_to_a_unit() {
        let found = worst(200_000, |random| {
            let x = positive(random);
            let most = 689.9 / ln(x).abs().max(1e-300);
            let y = match random.below(3) {
                0 => (f64::from(random.below(9) as u32) - 4.0).clamp(-most, most),
                _ => random.between(-1.0, 1.0) * most.min(10f64.powf(random.between(-3.0, 17.0))) * 0.999,
            };
            assert!(ordinary_pow(x, y), "{x} to {y}");
            let logarithm = ln_of(x);
            (pow(x, y), exp_of(product(logarithm, [y, 0.0])))
        });
        assert!(found < 1.0, "{found} units in the last place");
        assert_eq!((pow(7.3, 0.0), pow(1.0, 5e300), pow(3.0, 2.0)), (1.0, 1.0, 9.0));
    }
}
