//! The numbers that lanes hold: doubles, and singles for work that can afford them.

use crate::contract::{LANES, Scratch};

/// A number of a lane. Implemented for `f64` and `f32`; nothing else can be.
pub trait Number: Copy + Default + PartialEq + std::fmt::Debug + Send + Sync + sealed::Sealed + 'static {
    /// Zero.
    const ZERO: Self;
    /// Bytes that it takes.
    const SIZE: usize = size_of::<Self>();

    /// Rounds a constant.
    fn from_f64(value: f64) -> Self;
    /// Exactly as a double.
    fn to_f64(self) -> f64;
    /// Its bits in a word of 64, as often as they fit.
    fn word(self) -> u64;
    /// a + b.
    fn add(self, b: Self) -> Self;
    /// a − b.
    fn sub(self, b: Self) -> Self;
    /// a · b.
    fn mul(self, b: Self) -> Self;
    /// −a.
    fn neg(self) -> Self;
    /// a · b + c, rounded once.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// 1 / a.
    fn recip(self) -> Self;
    /// √a.
    fn sqrt(self) -> Self;
    /// ln a.
    fn ln(self) -> Self;
    /// eᵃ.
    fn exp(self) -> Self;
    /// aᵇ.
    fn powf(self, b: Self) -> Self;
    /// Its part of the scratch memory.
    fn slots(scratch: &mut Scratch) -> &mut Vec<[Self; LANES]>;
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f64 {}
    impl Sealed for f32 {}
}

macro_rules! number {
    ($t:ty, $slots:ident, $word:expr) => {
        impl Number for $t {
            const ZERO: $t = 0.0;

            #[inline(always)]
            fn from_f64(value: f64) -> $t {
                value as $t
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self.into()
            }
            #[inline(always)]
            fn word(self) -> u64 {
                $word(self)
            }
            #[inline(always)]
            fn add(self, b: $t) -> $t {
                self + b
            }
            #[inline(always)]
            fn sub(self, b: $t) -> $t {
                self - b
            }
            #[inline(always)]
            fn mul(self, b: $t) -> $t {
                self * b
            }
            #[inline(always)]
            fn neg(self) -> $t {
                -self
            }
            #[inline(always)]
            fn mul_add(self, b: $t, c: $t) -> $t {
                <$t>::mul_add(self, b, c)
            }
            #[inline(always)]
            fn recip(self) -> $t {
                1.0 / self
            }
            #[inline(always)]
            fn sqrt(self) -> $t {
                <$t>::sqrt(self)
            }
            #[inline(always)]
            fn ln(self) -> $t {
                <$t>::ln(self)
            }
            #[inline(always)]
            fn exp(self) -> $t {
                <$t>::exp(self)
            }
            #[inline(always)]
            fn powf(self, b: $t) -> $t {
                <$t>::powf(self, b)
            }
            #[inline(always)]
            fn slots(scratch: &mut Scratch) -> &mut Vec<[$t; LANES]> {
                &mut scratch.$slots
            }
        }
    };
}

number!(f64, slots, f64::to_bits);
number!(f32, singles, |x: f32| u64::from(x.to_bits()) << 32 | u64::from(x.to_bits()));
