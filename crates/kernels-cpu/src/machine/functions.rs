//! The functions that machine code calls, on the lanes of its call area: all lanes at once.

use super::elementary::{exp, ln, ordinary_exp, ordinary_ln, ordinary_pow, pow};
use super::emit::Layout;
use super::flow::Function;
use super::target::Target;

const LANES: usize = souple_kernels::LANES;
/// Doubles from the first argument to the second.
const SECOND: usize = Layout::ARGUMENT as usize / size_of::<f64>();

/// Function on a call area.
type Called = unsafe extern "sysv64" fn(*mut f64);

/// Address of a function for the lanes of a target.
pub(crate) fn address(target: Target, function: Function) -> u64 {
    // Emulated code of a wider set runs where only these are, or not even these.
    let wide = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
    let f = if wide { wide::function(target, function) } else { narrow::function(target, function) };
    f as *const () as u64
}

const LN: u8 = 0;
const EXP: u8 = 1;

/// ln or exp of N lanes.
#[inline(always)]
fn unary<const N: usize, const F: u8>(x: [f64; N]) -> [f64; N] {
    let mut y = x;
    let mut ordinary = true;
    for k in 0..N {
        y[k] = if F == LN { ln(x[k]) } else { exp(x[k]) };
        ordinary &= if F == LN { ordinary_ln(x[k]) } else { ordinary_exp(x[k]) };
    }
    if !ordinary {
        for k in 0..N {
            match F {
                LN if !ordinary_ln(x[k]) => y[k] = x[k].ln(),
                EXP if !ordinary_exp(x[k]) => y[k] = x[k].exp(),
                _ => {}
            }
        }
    }
    y
}

/// Powers of N lanes.
#[inline(always)]
fn powers<const N: usize>(x: [f64; N], y: [f64; N]) -> [f64; N] {
    let mut z = x;
    let mut ordinary = true;
    for k in 0..N {
        z[k] = pow(x[k], y[k]);
        ordinary &= ordinary_pow(x[k], y[k]);
    }
    if !ordinary {
        for k in 0..N {
            if !ordinary_pow(x[k], y[k]) {
                z[k] = x[k].powf(y[k]);
            }
        }
    }
    z
}

/// The functions as they are called, compiled with the attributes given. Values stay in registers from the call area and
/// back: every copy in between would cost the time of a store and a load.
macro_rules! called {
    ($(#[$attribute:meta])* $name:ident, $about:literal) => {
        #[doc = $about]
        mod $name {
            use super::*;

            pub(super) fn function(target: Target, function: Function) -> Called {
                match (target, function) {
                    (Target::Avx2, Function::Ln) => one::<4, LN>,
                    (Target::Avx2, Function::Exp) => one::<4, EXP>,
                    (Target::Avx2, Function::Pow) => power::<4>,
                    (Target::Avx512, Function::Ln) => one::<LANES, LN>,
                    (Target::Avx512, Function::Exp) => one::<LANES, EXP>,
                    (Target::Avx512, Function::Pow) => power::<LANES>,
                    (Target::Avx2Single, Function::Ln) => singles::<LN>,
                    (Target::Avx2Single, Function::Exp) => singles::<EXP>,
                    (Target::Avx2Single, Function::Pow) => power_of_singles,
                }
            }

            /// a ← f(a) for N lanes.
            $(#[$attribute])*
            unsafe extern "sysv64" fn one<const N: usize, const F: u8>(area: *mut f64) {
                // SAFETY: machine code passes its call area, whose first argument has room for eight lanes.
                let a = unsafe { &mut *area.cast::<[f64; N]>() };
                *a = unary::<N, F>(*a);
            }

            /// a ← aᵇ for N lanes.
            $(#[$attribute])*
            unsafe extern "sysv64" fn power<const N: usize>(area: *mut f64) {
                // SAFETY: machine code passes its call area, which has room for two arguments of eight lanes.
                let (a, b) = unsafe { (&mut *area.cast::<[f64; N]>(), &*area.add(SECOND).cast::<[f64; N]>()) };
                *a = powers::<N>(*a, *b);
            }

            /// a ← f(a) for eight singles, rounded from doubles.
            $(#[$attribute])*
            unsafe extern "sysv64" fn singles<const F: u8>(area: *mut f64) {
                // SAFETY: machine code passes its call area, whose first argument has room for eight lanes.
                let a = unsafe { &mut *area.cast::<[f32; LANES]>() };
                *a = unary::<LANES, F>(a.map(f64::from)).map(|x| x as f32);
            }

            /// a ← aᵇ for eight singles, rounded from doubles.
            $(#[$attribute])*
            unsafe extern "sysv64" fn power_of_singles(area: *mut f64) {
                // SAFETY: machine code passes its call area, which has room for two arguments of 64 bytes.
                let (a, b) = unsafe { (&mut *area.cast::<[f32; LANES]>(), &*area.add(SECOND).cast::<[f32; LANES]>()) };
                *a = powers::<LANES>(a.map(f64::from), b.map(f64::from)).map(|x| x as f32);
            }
        }
    };
}

called!(
    #[target_feature(enable = "avx2,fma")]
    wide,
    "For processors with AVX2 and FMA."
);
called!(narrow, "For any processor.");

#[cfg(test)]
mod tests {
    use super::*;

    /// Calls a function on an area as machine code does.
    fn call(f: Called, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        let mut area = [0.0; 2 * SECOND];
        area[..4].copy_from_slice(&a);
        area[SECOND..SECOND + 4].copy_from_slice(&b);
        // SAFETY: the area has room for two arguments, and the functions asked for suit this processor.
        unsafe { f(area.as_mut_ptr()) };
        [area[0], area[1], area[2], area[3]]
    }

    /// The functions that this processor gets.
    fn here(function: Function, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        let wide = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        let of = if wide { wide::function } else { narrow::function };
        call(of(Target::Avx2, function), a, b)
    }

    /// Every special argument in every lane, beside ordinary ones: as the standard library has it, and neighbours are
    /// not touched.
    #[test]
    fn special_arguments_are_those_of_the_standard_library() {
        let special = [
            0.0,
            -0.0,
            -1.0,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
            5e-324,
            1e-310,
            f64::MIN_POSITIVE,
            f64::MAX,
            f64::MIN,
            1000.0,
            -1000.0,
            709.7,
            -745.0,
            -708.5,
            2.0,
            -3.0,
            1.0,
        ];
        // Exactly, or both not a number, or a unit apart.
        let same = |got: f64, want: f64| {
            got == want || (got.is_nan() && want.is_nan()) || (got - want).abs() <= 2.0 * f64::EPSILON * want.abs()
        };
        let check = |name: &str, x: f64, y: f64, got: f64, want: f64| {
            assert!(same(got, want), "{name} of {x:e}, {y:e}: {got:e} instead of {want:e}");
            assert!(want != 0.0 || got.is_sign_positive() == want.is_sign_positive(), "sign of {name} of {x:e}, {y:e}");
        };
        for x in special {
            for lane in 0..4 {
                let mut a = [0.3; 4];
                a[lane] = x;
                let (logarithms, powers) = (here(Function::Ln, a, a), here(Function::Exp, a, a));
                for k in 0..4 {
                    check("ln", a[k], 0.0, logarithms[k], a[k].ln());
                    check("exp", a[k], 0.0, powers[k], a[k].exp());
                }
                for y in special {
                    let mut b = [1.7; 4];
                    b[lane] = y;
                    let powers = here(Function::Pow, a, b);
                    (0..4).for_each(|k| check("pow", a[k], b[k], powers[k], a[k].powf(b[k])));
                }
            }
        }
    }

    /// Without AVX2 the same bits come out.
    #[test]
    fn instruction_sets_agree() {
        for k in 0..2000 {
            let x: [f64; 4] = std::array::from_fn(|lane| 0.01 * f64::from(4 * k + lane as i32) + 0.001);
            let y = x.map(|x| 3.0 - 0.2 * x);
            for function in [Function::Ln, Function::Exp, Function::Pow] {
                assert_eq!(here(function, x, y), call(narrow::function(Target::Avx2, function), x, y), "{function:?}");
            }
        }
    }
}
