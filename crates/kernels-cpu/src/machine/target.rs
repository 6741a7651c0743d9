//! Instructions of each instruction set, by what they do.

use super::allocate::{Form, Registers};
use super::flow::What;
use iced_x86::{Code, Register};
use souple_kernels::LANES;

/// Registers and the size of numbers that code is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// AVX2 and FMA, 4 doubles per register.
    Avx2,
    /// AVX-512F and VL, 8 doubles per register.
    Avx512,
    /// AVX2 and FMA, 8 singles per register.
    Avx2Single,
}

impl Target {
    /// Bytes of a number.
    pub(crate) fn number(self) -> u32 {
        if self == Target::Avx2Single { 4 } else { 8 }
    }

    /// Bytes of a vector register.
    pub(crate) fn vector(self) -> u32 {
        if self == Target::Avx512 { 64 } else { 32 }
    }

    /// Numbers in a vector register.
    pub(crate) fn lanes(self) -> u32 {
        self.vector() / self.number()
    }

    /// Passes that a group of lanes takes.
    pub(crate) fn halves(self) -> u32 {
        LANES as u32 / self.lanes()
    }

    /// Bytes that a constant or a uniform value takes: all lanes where arithmetic cannot spread a scalar.
    pub(crate) fn constant(self) -> u32 {
        if self == Target::Avx512 { 8 } else { 32 }
    }

    /// What the allocation needs to know.
    pub(crate) fn registers(self) -> Registers {
        let wide = self == Target::Avx512;
        Registers {
            count: if wide { 32 } else { 16 },
            spreads: wide,
            wide_constants: !wide,
            gather_spare: match self {
                Target::Avx2 => 1,
                Target::Avx512 => 4,
                Target::Avx2Single => 2,
            },
        }
    }

    /// A vector register at full width.
    pub(crate) fn register(self, number: u8) -> Register {
        let first = if self == Target::Avx512 { Register::ZMM0 } else { Register::YMM0 };
        first + u32::from(number)
    }

    fn pick(self, avx2: Code, avx512: Code, single: Code) -> Code {
        match self {
            Target::Avx2 => avx2,
            Target::Avx512 => avx512,
            Target::Avx2Single => single,
        }
    }

    /// Reads a vector from memory.
    pub(crate) fn load(self) -> Code {
        self.pick(Code::VEX_Vmovupd_ymm_ymmm256, Code::EVEX_Vmovupd_zmm_k1z_zmmm512, Code::VEX_Vmovups_ymm_ymmm256)
    }

    /// Copies a register.
    pub(crate) fn copy(self) -> Code {
        self.pick(Code::VEX_Vmovapd_ymm_ymmm256, Code::EVEX_Vmovapd_zmm_k1z_zmmm512, Code::VEX_Vmovaps_ymm_ymmm256)
    }

    /// Writes a vector to memory.
    pub(crate) fn store(self) -> Code {
        self.pick(Code::VEX_Vmovupd_ymmm256_ymm, Code::EVEX_Vmovupd_zmmm512_k1z_zmm, Code::VEX_Vmovups_ymmm256_ymm)
    }

    /// Reads a scalar into all lanes.
    pub(crate) fn spread(self) -> Code {
        self.pick(
            Code::VEX_Vbroadcastsd_ymm_m64,
            Code::EVEX_Vbroadcastsd_zmm_k1z_xmmm64,
            Code::VEX_Vbroadcastss_ymm_m32,
        )
    }

    /// √.
    pub(crate) fn sqrt(self) -> Code {
        self.pick(
            Code::VEX_Vsqrtpd_ymm_ymmm256,
            Code::EVEX_Vsqrtpd_zmm_k1z_zmmm512b64_er,
            Code::VEX_Vsqrtps_ymm_ymmm256,
        )
    }

    /// Arithmetic of two operands.
    pub(crate) fn two(self, what: What) -> Code {
        match what {
            What::Add => self.pick(
                Code::VEX_Vaddpd_ymm_ymm_ymmm256,
                Code::EVEX_Vaddpd_zmm_k1z_zmm_zmmm512b64_er,
                Code::VEX_Vaddps_ymm_ymm_ymmm256,
            ),
            What::Sub => self.pick(
                Code::VEX_Vsubpd_ymm_ymm_ymmm256,
                Code::EVEX_Vsubpd_zmm_k1z_zmm_zmmm512b64_er,
                Code::VEX_Vsubps_ymm_ymm_ymmm256,
            ),
            What::Mul => self.pick(
                Code::VEX_Vmulpd_ymm_ymm_ymmm256,
                Code::EVEX_Vmulpd_zmm_k1z_zmm_zmmm512b64_er,
                Code::VEX_Vmulps_ymm_ymm_ymmm256,
            ),
            What::Div => self.pick(
                Code::VEX_Vdivpd_ymm_ymm_ymmm256,
                Code::EVEX_Vdivpd_zmm_k1z_zmm_zmmm512b64_er,
                Code::VEX_Vdivps_ymm_ymm_ymmm256,
            ),
            What::Xor => self.pick(
                Code::VEX_Vxorpd_ymm_ymm_ymmm256,
                Code::EVEX_Vpxorq_zmm_k1z_zmm_zmmm512b64,
                Code::VEX_Vxorps_ymm_ymm_ymmm256,
            ),
            other => unreachable!("{other:?} is not arithmetic of two operands"),
        }
    }

    /// A fused multiply-add.
    pub(crate) fn fused(self, minus_product: bool, minus_addend: bool, form: Form) -> Code {
        macro_rules! forms {
            ($a:ident $b:ident $c:ident, $d:ident $e:ident $f:ident, $g:ident $h:ident $i:ident) => {
                match form {
                    Form::Factor132 => self.pick(Code::$a, Code::$b, Code::$c),
                    Form::Factor213 => self.pick(Code::$d, Code::$e, Code::$f),
                    Form::Addend231 => self.pick(Code::$g, Code::$h, Code::$i),
                }
            };
        }
        match (minus_product, minus_addend) {
            (false, false) => forms!(
                VEX_Vfmadd132pd_ymm_ymm_ymmm256 EVEX_Vfmadd132pd_zmm_k1z_zmm_zmmm512b64_er VEX_Vfmadd132ps_ymm_ymm_ymmm256,
                VEX_Vfmadd213pd_ymm_ymm_ymmm256 EVEX_Vfmadd213pd_zmm_k1z_zmm_zmmm512b64_er VEX_Vfmadd213ps_ymm_ymm_ymmm256,
                VEX_Vfmadd231pd_ymm_ymm_ymmm256 EVEX_Vfmadd231pd_zmm_k1z_zmm_zmmm512b64_er VEX_Vfmadd231ps_ymm_ymm_ymmm256
            ),
            (false, true) => forms!(
                VEX_Vfmsub132pd_ymm_ymm_ymmm256 EVEX_Vfmsub132pd_zmm_k1z_zmm_zmmm512b64_er VEX_Vfmsub132ps_ymm_ymm_ymmm256,
                VEX_Vfmsub213pd_ymm_ymm_ymmm256 EVEX_Vfmsub213pd_zmm_k1z_zmm_zmmm512b64_er VEX_Vfmsub213ps_ymm_ymm_ymmm256,
                VEX_Vfmsub231pd_ymm_ymm_ymmm256 EVEX_Vfmsub231pd_zmm_k1z_zmm_zmmm512b64_er VEX_Vfmsub231ps_ymm_ymm_ymmm256
            ),
            (true, false) => forms!(
                VEX_Vfnmadd132pd_ymm_ymm_ymmm256 EVEX_Vfnmadd132pd_zmm_k1z_zmm_zmmm512b64_er VEX_Vfnmadd132ps_ymm_ymm_ymmm256,
                VEX_Vfnmadd213pd_ymm_ymm_ymmm256 EVEX_Vfnmadd213pd_zmm_k1z_zmm_zmmm512b64_er VEX_Vfnmadd213ps_ymm_ymm_ymmm256,
                VEX_Vfnmadd231pd_ymm_ymm_ymmm256 EVEX_Vfnmadd231pd_zmm_k1z_zmm_zmmm512b64_er VEX_Vfnmadd231ps_ymm_ymm_ymmm256
            ),
            (true, true) => forms!(
                VEX_Vfnmsub132pd_ymm_ymm_ymmm256 EVEX_Vfnmsub132pd_zmm_k1z_zmm_zmmm512b64_er VEX_Vfnmsub132ps_ymm_ymm_ymmm256,
                VEX_Vfnmsub213pd_ymm_ymm_ymmm256 EVEX_Vfnmsub213pd_zmm_k1z_zmm_zmmm512b64_er VEX_Vfnmsub213ps_ymm_ymm_ymmm256,
                VEX_Vfnmsub231pd_ymm_ymm_ymmm256 EVEX_Vfnmsub231pd_zmm_k1z_zmm_zmmm512b64_er VEX_Vfnmsub231ps_ymm_ymm_ymmm256
            ),
        }
    }
}
