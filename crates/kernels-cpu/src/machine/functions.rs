//! The functions that machine code calls, on the lanes of its call area.

use super::emit::Layout;
use super::flow::Function;
use super::target::Target;

const LANES: usize = souple_kernels::LANES;
/// Doubles from the first argument to the second.
const SECOND: usize = Layout::ARGUMENT as usize / size_of::<f64>();

/// Address of a function for the lanes of a target.
pub(crate) fn address(target: Target, function: Function) -> u64 {
    let f: extern "sysv64" fn(*mut f64) = match (function, target) {
        (Function::Ln, Target::Avx512) => one::<LANES, LN>,
        (Function::Exp, Target::Avx512) => one::<LANES, EXP>,
        (Function::Pow, Target::Avx512) => power::<LANES>,
        (Function::Ln, Target::Avx2) => one::<4, LN>,
        (Function::Exp, Target::Avx2) => one::<4, EXP>,
        (Function::Pow, Target::Avx2) => power::<4>,
        (Function::Ln, Target::Avx2Single) => singles::<LN>,
        (Function::Exp, Target::Avx2Single) => singles::<EXP>,
        (Function::Pow, Target::Avx2Single) => power_of_singles,
    };
    f as *const () as u64
}

const LN: u8 = 0;
const EXP: u8 = 1;

/// a ← f(a) for N lanes.
extern "sysv64" fn one<const N: usize, const F: u8>(area: *mut f64) {
    // SAFETY: machine code passes its call area, whose first argument has room for eight lanes.
    let a = unsafe { std::slice::from_raw_parts_mut(area, N) };
    for x in a {
        *x = if F == LN { x.ln() } else { x.exp() };
    }
}

/// a ← aᵇ for N lanes.
extern "sysv64" fn power<const N: usize>(area: *mut f64) {
    // SAFETY: machine code passes its call area, which has room for two arguments of eight lanes.
    let area = unsafe { std::slice::from_raw_parts_mut(area, SECOND + N) };
    let (a, b) = area.split_at_mut(SECOND);
    for (x, y) in a.iter_mut().zip(b) {
        *x = x.powf(*y);
    }
}

/// a ← f(a) for eight singles.
extern "sysv64" fn singles<const F: u8>(area: *mut f64) {
    // SAFETY: machine code passes its call area, whose first argument has room for eight lanes.
    let a = unsafe { std::slice::from_raw_parts_mut(area.cast::<f32>(), LANES) };
    for x in a {
        *x = if F == LN { x.ln() } else { x.exp() };
    }
}

/// a ← aᵇ for eight singles.
extern "sysv64" fn power_of_singles(area: *mut f64) {
    // SAFETY: machine code passes its call area, which has room for two arguments of 64 bytes.
    let area = unsafe { std::slice::from_raw_parts_mut(area.cast::<f32>(), 2 * SECOND + LANES) };
    let (a, b) = area.split_at_mut(2 * SECOND);
    for (x, y) in a.iter_mut().zip(b) {
        *x = x.powf(*y);
    }
}
