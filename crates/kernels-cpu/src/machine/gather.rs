//! Reading rows of a shared array: the numbers of one item lie side by side, the registers want lanes side by side.
//!
//! Rows of three, four lanes (two for `z`, with 64-bit loads): nothing beyond a row is read.
//!
//! ```text
//! p = x₀ y₀ | x₂ y₂      two loads of 128 bits
//! q = x₁ y₁ | x₃ y₃      two more
//! x = unpack low  p q = x₀ x₁ | x₂ x₃
//! y = unpack high p q = y₀ y₁ | y₂ y₃
//! ```
//!
//! Eight lanes are two such fours put together before they are unpacked. Singles take the processor's own gather.

use super::emit::{Emitter, memory};
use super::target::Target;
use iced_x86::{Code, Instruction, MemoryOperand, Register};
use souple_kernels::LANES;

/// General registers for the row numbers of four lanes. The first may hold the address of the rows: it is loaded last.
const ROWS: [Register; 4] = [Register::RAX, Register::RCX, Register::RDX, Register::R8];
const ROWS32: [Register; 4] = [Register::EAX, Register::ECX, Register::EDX, Register::R8D];

/// Gathers a row (or with `axis` one place of it) into registers.
pub(crate) fn gather(
    e: &mut Emitter<'_>,
    rows: (Option<Register>, MemoryOperand),
    shared: Register,
    place: u32,
    width: u32,
    axis: Option<u32>,
    to: [u8; 3],
    spare: [u8; 4],
) {
    let g = Gather { rows, shared, place, width };
    let at = |axis: u32| i64::from(axis * e.target.number());
    match (e.target, axis, width) {
        (Target::Avx2Single, Some(axis), _) => g.singles(e, at(axis), to[0], spare),
        (Target::Avx2Single, None, _) => {
            for axis in 0..width {
                g.singles(e, i64::from(axis * 4), to[axis as usize], spare);
            }
        }
        (_, Some(axis), _) => g.column(e, at(axis), to[0], spare),
        (_, None, 1) => g.column(e, 0, to[0], spare),
        (Target::Avx512, None, _) => {
            let [p, p_high, q_high, z_high] = spare;
            let [x, q, z] = to;
            g.numbers(e, 0);
            g.pairs(e, p, q);
            if width == 3 {
                g.four(e, 16, z, x);
            }
            g.numbers(e, 4);
            g.pairs(e, p_high, q_high);
            upper(e, p, p_high);
            upper(e, q, q_high);
            if width == 3 {
                g.four(e, 16, z_high, x);
                upper(e, z, z_high);
            }
            unpack(e, p, q, x);
        }
        (Target::Avx2, None, _) => {
            let [x, q, z] = to;
            g.numbers(e, 0);
            g.pairs(e, spare[0], q);
            unpack(e, spare[0], q, x);
            if width == 3 {
                g.four(e, 16, z, spare[0]);
            }
        }
    }
}

struct Gather {
    rows: (Option<Register>, MemoryOperand),
    shared: Register,
    place: u32,
    width: u32,
}

fn xmm(number: u8) -> Register {
    Register::XMM0 + u32::from(number)
}

fn ymm(number: u8) -> Register {
    Register::YMM0 + u32::from(number)
}

/// One of two encodings of the same instruction: the short one reaches sixteen registers, the long one thirty-two.
fn pick(e: &Emitter<'_>, vex: Code, evex: Code) -> Code {
    if e.target == Target::Avx512 { evex } else { vex }
}

/// Puts the low half of `from` into the high half of `to`.
fn upper(e: &mut Emitter<'_>, to: u8, from: u8) {
    let z = Register::ZMM0 + u32::from(to);
    e.push(Instruction::with4(Code::EVEX_Vinsertf64x4_zmm_k1z_zmm_ymmm256_imm8, z, z, ymm(from), 1));
}

/// From p and q: x in its own register, y in q's.
fn unpack(e: &mut Emitter<'_>, p: u8, q: u8, x: u8) {
    let [p, q, x] = [p, q, x].map(|number| e.target.register(number));
    let low = pick(e, Code::VEX_Vunpcklpd_ymm_ymm_ymmm256, Code::EVEX_Vunpcklpd_zmm_k1z_zmm_zmmm512b64);
    let high = pick(e, Code::VEX_Vunpckhpd_ymm_ymm_ymmm256, Code::EVEX_Vunpckhpd_zmm_k1z_zmm_zmmm512b64);
    e.push(Instruction::with3(low, x, p, q));
    e.push(Instruction::with3(high, q, p, q));
}

impl Gather {
    /// The address of the rows in a register.
    fn base(&self, e: &mut Emitter<'_>) -> Register {
        match self.rows.0 {
            Some(register) => register,
            None => {
                e.push(Instruction::with2(Code::Mov_r64_rm64, ROWS[0], self.rows.1));
                ROWS[0]
            }
        }
    }

    /// Row numbers of four lanes from `lane` on, times the width where the address cannot do that.
    fn numbers(&self, e: &mut Emitter<'_>, lane: u32) {
        let base = self.base(e);
        let at = i64::from(self.place) * LANES as i64 * 4;
        for k in [1, 2, 3, 0] {
            let from = memory(base, at + 4 * i64::from(lane + k as u32));
            e.push(Instruction::with2(Code::Mov_r32_rm32, ROWS32[k], from));
        }
        for row in ROWS {
            match self.width {
                1 => {}
                2 => e.push(Instruction::with2(Code::Add_r64_rm64, row, row)),
                3 => {
                    let thrice = MemoryOperand::with_base_index_scale(row, row, 2);
                    e.push(Instruction::with2(Code::Lea_r64_m, row, thrice));
                }
                width => e.push(Instruction::with3(Code::Imul_r64_rm64_imm32, row, row, width as i32)),
            }
        }
    }

    fn at(&self, k: usize, offset: i64) -> MemoryOperand {
        MemoryOperand::with_base_index_scale_displ_size(self.shared, ROWS[k], 8, offset, u32::from(offset != 0))
    }

    /// p = x₀ y₀ | x₂ y₂ and q = x₁ y₁ | x₃ y₃.
    fn pairs(&self, e: &mut Emitter<'_>, p: u8, q: u8) {
        let load = pick(e, Code::VEX_Vmovupd_xmm_xmmm128, Code::EVEX_Vmovupd_xmm_k1z_xmmm128);
        let insert =
            pick(e, Code::VEX_Vinsertf128_ymm_ymm_xmmm128_imm8, Code::EVEX_Vinsertf32x4_ymm_k1z_ymm_xmmm128_imm8);
        for (to, k) in [(p, 0), (q, 1)] {
            e.push(Instruction::with2(load, xmm(to), self.at(k, 0)));
            e.push(Instruction::with4(insert, ymm(to), ymm(to), self.at(k + 2, 0), 1));
        }
    }

    /// One place of four rows, using t.
    fn four(&self, e: &mut Emitter<'_>, offset: i64, to: u8, t: u8) {
        let low = pick(e, Code::VEX_Vmovsd_xmm_m64, Code::EVEX_Vmovsd_xmm_k1z_m64);
        let high = pick(e, Code::VEX_Vmovhpd_xmm_xmm_m64, Code::EVEX_Vmovhpd_xmm_xmm_m64);
        let insert =
            pick(e, Code::VEX_Vinsertf128_ymm_ymm_xmmm128_imm8, Code::EVEX_Vinsertf32x4_ymm_k1z_ymm_xmmm128_imm8);
        for (to, k) in [(to, 0), (t, 2)] {
            e.push(Instruction::with2(low, xmm(to), self.at(k, offset)));
            e.push(Instruction::with3(high, xmm(to), xmm(to), self.at(k + 1, offset)));
        }
        e.push(Instruction::with4(insert, ymm(to), ymm(to), xmm(t), 1));
    }

    /// One place of the rows of all lanes.
    fn column(&self, e: &mut Emitter<'_>, offset: i64, to: u8, spare: [u8; 4]) {
        self.numbers(e, 0);
        self.four(e, offset, to, spare[0]);
        if e.target == Target::Avx512 {
            self.numbers(e, 4);
            self.four(e, offset, spare[1], spare[0]);
            upper(e, to, spare[1]);
        }
    }

    /// One place of eight rows of singles.
    fn singles(&self, e: &mut Emitter<'_>, offset: i64, to: u8, spare: [u8; 4]) {
        let base = self.base(e);
        let [index, mask, ..] = spare.map(ymm);
        let rows = memory(base, i64::from(self.place) * LANES as i64 * 4);
        e.push(Instruction::with2(Code::VEX_Vmovups_ymm_ymmm256, index, rows));
        let to = ymm(to);
        if self.width > 1 {
            // Row number times width: exact, since the caller checked that it fits 31 bits.
            let wide = ROWS32[1];
            e.push(Instruction::with2(Code::Mov_r32_imm32, wide, self.width));
            e.push(Instruction::with2(Code::VEX_Vmovd_xmm_rm32, xmm(spare[1]), wide));
            e.push(Instruction::with2(Code::VEX_Vpbroadcastd_ymm_xmmm32, mask, xmm(spare[1])));
            e.push(Instruction::with3(Code::VEX_Vpmulld_ymm_ymm_ymmm256, index, index, mask));
        }
        e.push(Instruction::with3(Code::VEX_Vpcmpeqd_ymm_ymm_ymmm256, mask, mask, mask));
        let from =
            MemoryOperand::with_base_index_scale_displ_size(self.shared, index, 4, offset, u32::from(offset != 0));
        e.push(Instruction::with3(Code::VEX_Vgatherdps_ymm_vm32y_ymm, to, from, mask));
    }
}
