//! An emulator of the instructions that the generator emits, so that code for instruction sets that this processor
//! lacks is run too, and so that every access to memory is checked against what the kernel was given.
//!
//! It reads bytes through the assembler crate's decoder and shares nothing with the generator: an instruction that is
//! not listed here stops the test.

use super::emit::{Assembly, Layout};
use super::flow::{Arrival, Source};
use super::kernel::{assemble, check, frame};
use super::target::Target;
use iced_x86::{Decoder, DecoderOptions, Instruction, Mnemonic, OpKind, Register};
use souple_kernels::plan::plan;
use souple_kernels::{About, Backend, CompileError, Input, Kernel, Number, Scratch, execute};
use souple_program::{Program, verify};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// A backend that emulates the code of a target.
pub(crate) struct Emulated {
    about: About,
    target: Target,
}

impl Emulated {
    pub(crate) fn new(target: Target) -> Emulated {
        Emulated { about: About { name: format!("{target:?}"), description: "emulated machine code".into() }, target }
    }
}

impl Backend for Emulated {
    fn about(&self) -> &About {
        &self.about
    }

    fn compile(&self, program: &Program) -> Result<Arc<dyn Kernel>, CompileError> {
        verify(program)?;
        Ok(Arc::new(Emulation { program: program.clone(), target: self.target }))
    }

    fn compile_singles(&self, program: &Program) -> Result<Arc<dyn Kernel<f32>>, CompileError> {
        verify(program)?;
        Ok(Arc::new(Emulation { program: program.clone(), target: self.target }))
    }
}

struct Emulation {
    program: Program,
    target: Target,
}

impl<T: Number> Kernel<T> for Emulation {
    fn program(&self) -> &Program {
        &self.program
    }

    fn run(&self, scratch: &mut Scratch, groups: usize, inputs: &[Input<'_, T>], outputs: &mut [&mut [T]]) {
        assert_eq!(T::SIZE, self.target.number() as usize, "numbers of the target");
        check(&self.program, groups, inputs, outputs);
        let arrivals: Vec<Arrival> = inputs.iter().map(Arrival::of).collect();
        let Some((flow, assembly)) = assemble(self.target, &self.program, &arrivals) else {
            return execute::<T, true>(&self.program, &plan(&self.program), scratch, groups, inputs, outputs);
        };
        let mut pool = vec![[0u64; 8]; assembly.pool.len() / 64 + 1];
        for (word, bytes) in pool.as_flattened_mut().iter_mut().zip(assembly.pool.chunks(8)) {
            let mut whole = [0; 8];
            whole[..bytes.len()].copy_from_slice(bytes);
            *word = u64::from_le_bytes(whole);
        }
        let pool_at = pool.as_ptr().expose_provenance() as u64;
        let block = frame(self.target, &flow, assembly.layout, pool_at, scratch, groups, inputs, outputs);
        let mut memory = Memory::default();
        memory.readable.push(pool_at..pool_at + assembly.pool.len() as u64);
        let frame_at = block.expose_provenance() as u64;
        memory.writable.push(frame_at..frame_at + u64::from(assembly.layout.size));
        let of = |address: usize, bytes: usize| address as u64..(address + bytes) as u64;
        for stream in &flow.streams {
            match stream.source {
                Source::Output(b) => {
                    let o: &mut [T] = outputs[b as usize];
                    memory.writable.push(of(o.as_mut_ptr().expose_provenance(), size_of_val(o)));
                }
                Source::Input(b) | Source::Rows(b) | Source::Shared(b) | Source::Points(b) => {
                    match inputs[b as usize] {
                        Input::Lanes(v) | Input::Uniform(v) => {
                            memory.readable.push(of(v.as_ptr().expose_provenance(), size_of_val(v)));
                        }
                        Input::Gathered { values, rows, .. } => {
                            memory.readable.push(of(values.as_ptr().expose_provenance(), size_of_val(values)));
                            memory.readable.push(of(rows.as_ptr().expose_provenance(), size_of_val(rows)));
                        }
                    }
                }
            }
        }
        Processor::new(memory, frame_at).run(&assembly);
    }
}

/// What the code may touch.
#[derive(Default)]
struct Memory {
    readable: Vec<Range<u64>>,
    writable: Vec<Range<u64>>,
}

impl Memory {
    fn read<const N: usize>(&self, at: u64) -> [u8; N] {
        let inside = |r: &Range<u64>| r.start <= at && at + N as u64 <= r.end;
        let allowed = self.readable.iter().chain(&self.writable).any(inside);
        assert!(allowed, "reads {N} bytes at {at:#x}, outside of every buffer");
        // SAFETY: the bytes lie in a buffer that the caller lent for this run.
        unsafe { std::ptr::with_exposed_provenance::<[u8; N]>(at as usize).read_unaligned() }
    }

    fn write<const N: usize>(&self, at: u64, bytes: [u8; N]) {
        let allowed = self.writable.iter().any(|r| r.start <= at && at + N as u64 <= r.end);
        assert!(allowed, "writes {N} bytes at {at:#x}, outside of every output");
        // SAFETY: the bytes lie in an output or in the frame, lent exclusively for this run.
        unsafe { std::ptr::with_exposed_provenance_mut::<[u8; N]>(at as usize).write_unaligned(bytes) }
    }
}

/// Words of 64 bits of a vector register.
type Vector = [u64; 8];

struct Processor {
    general: [u64; 16],
    vector: [Vector; 32],
    stack: Vec<u64>,
    zero: bool,
    memory: Memory,
}

fn doubles(a: Vector, b: Vector, f: impl Fn(f64, f64) -> f64) -> Vector {
    std::array::from_fn(|k| f(f64::from_bits(a[k]), f64::from_bits(b[k])).to_bits())
}

fn halves(word: u64) -> [u32; 2] {
    [word as u32, (word >> 32) as u32]
}

fn whole(halves: [u32; 2]) -> u64 {
    u64::from(halves[0]) | u64::from(halves[1]) << 32
}

fn integers(a: Vector, b: Vector, f: impl Fn(u32, u32) -> u32) -> Vector {
    std::array::from_fn(|k| {
        let (x, y) = (halves(a[k]), halves(b[k]));
        whole([f(x[0], y[0]), f(x[1], y[1])])
    })
}

fn singles(a: Vector, b: Vector, f: impl Fn(f32, f32) -> f32) -> Vector {
    integers(a, b, |x, y| f(f32::from_bits(x), f32::from_bits(y)).to_bits())
}

/// Bytes of a vector register.
fn width(r: Register) -> usize {
    if r.is_zmm() {
        64
    } else if r.is_ymm() {
        32
    } else {
        assert!(r.is_xmm(), "{r:?} is no vector register");
        16
    }
}

/// Number of a register within its kind.
fn number(r: Register) -> usize {
    let kinds = [Register::RAX, Register::EAX, Register::XMM0, Register::YMM0, Register::ZMM0];
    let first = kinds.into_iter().filter(|first| *first as usize <= r as usize).max_by_key(|first| *first as usize);
    r as usize - first.expect("no register comes before all kinds") as usize
}

impl Processor {
    fn new(memory: Memory, frame: u64) -> Processor {
        let mut general = [0x5555_5555_5555_5555; 16];
        general[Register::RDI as usize - Register::RAX as usize] = frame;
        Processor { general, vector: [[u64::MAX; 8]; 32], stack: vec![0], zero: false, memory }
    }

    fn run(&mut self, assembly: &Assembly) {
        let mut decoder = Decoder::new(64, &assembly.code, DecoderOptions::NONE);
        let code: Vec<Instruction> = decoder.iter().collect();
        let at: HashMap<u64, usize> = code.iter().enumerate().map(|(k, i)| (i.ip(), k)).collect();
        let kept: Vec<u64> = self.general.to_vec();
        let mut next = 0;
        loop {
            let i = code[next];
            next += 1;
            match i.mnemonic() {
                Mnemonic::Jne if self.zero => {}
                Mnemonic::Jne => next = at[&i.near_branch_target()],
                Mnemonic::Ret => break,
                _ => self.step(&i),
            }
        }
        assert_eq!(self.stack, [0], "the stack is as it was");
        for r in [Register::RBX, Register::RBP, Register::R12, Register::R13, Register::R14, Register::R15] {
            let number = r as usize - Register::RAX as usize;
            assert_eq!(self.general[number], kept[number], "{r:?} belongs to the caller");
        }
    }

    fn general(&self, r: Register) -> u64 {
        if r == Register::None {
            return 0;
        }
        let value = self.general[number(r)];
        if r.is_gpr32() { value & 0xffff_ffff } else { value }
    }

    fn set_general(&mut self, r: Register, value: u64) {
        self.general[number(r)] = if r.is_gpr32() { value & 0xffff_ffff } else { value };
    }

    fn address(&self, i: &Instruction) -> u64 {
        let index = self.general(i.memory_index()).wrapping_mul(i.memory_index_scale().into());
        self.general(i.memory_base()).wrapping_add(index).wrapping_add(i.memory_displacement64())
    }

    /// A general operand.
    fn integer(&self, i: &Instruction, k: u32) -> u64 {
        match i.op_kind(k) {
            OpKind::Register => self.general(i.op_register(k)),
            OpKind::Memory if i.op0_register().is_gpr32() => {
                u32::from_le_bytes(self.memory.read(self.address(i))).into()
            }
            OpKind::Memory => u64::from_le_bytes(self.memory.read(self.address(i))),
            _ => i.immediate(k),
        }
    }

    fn set_integer(&mut self, i: &Instruction, value: u64) {
        match i.op0_kind() {
            OpKind::Memory => self.memory.write(self.address(i), value.to_le_bytes()),
            _ => self.set_general(i.op0_register(), value),
        }
    }

    /// A vector operand, `bytes` long if it is in memory.
    fn operand(&self, i: &Instruction, k: u32, bytes: usize) -> Vector {
        if i.op_kind(k) == OpKind::Register {
            return self.vector[number(i.op_register(k))];
        }
        let at = self.address(i);
        if i.is_broadcast() {
            return [u64::from_le_bytes(self.memory.read(at)); 8];
        }
        let mut v = [0; 8];
        if bytes == 4 {
            v[0] = u32::from_le_bytes(self.memory.read(at)).into();
        }
        for k in 0..bytes / 8 {
            v[k] = u64::from_le_bytes(self.memory.read(at + 8 * k as u64));
        }
        v
    }

    /// Writes a vector register; what is beyond its width becomes zero.
    fn set(&mut self, r: Register, mut v: Vector) {
        v[width(r) / 8..].fill(0);
        self.vector[number(r)] = v;
    }

    fn step(&mut self, i: &Instruction) {
        use Mnemonic::*;
        let to = i.op0_register();
        match i.mnemonic() {
            Push => self.stack.push(self.general(to)),
            Pop => {
                let value = self.stack.pop().expect("the stack is not empty");
                self.set_general(to, value);
            }
            Mov => self.set_integer(i, self.integer(i, 1)),
            Lea => self.set_general(to, self.address(i)),
            Add => self.set_integer(i, self.integer(i, 0).wrapping_add(self.integer(i, 1))),
            Imul => self.set_general(to, self.integer(i, 1).wrapping_mul(self.integer(i, 2))),
            Dec => {
                let value = self.integer(i, 0).wrapping_sub(1);
                self.set_integer(i, value);
                self.zero = value == 0;
            }
            Call => {
                assert_eq!(self.stack.len() % 2, 0, "the stack is aligned at a call");
                let area = self.general(Register::RDI);
                let function = self.integer(i, 0);
                let pointer = std::ptr::with_exposed_provenance::<()>(function as usize);
                // SAFETY: the frame holds addresses of functions of this signature, and the area is in the frame.
                let f: extern "sysv64" fn(*mut f64) = unsafe { std::mem::transmute(pointer) };
                self.memory.read::<{ 2 * Layout::ARGUMENT as usize }>(area);
                f(std::ptr::with_exposed_provenance_mut(area as usize));
                // What the callee may change is changed.
                for r in [Register::RAX, Register::RCX, Register::RDX, Register::RSI, Register::RDI] {
                    self.set_general(r, 0x7777);
                }
                for r in [Register::R8, Register::R9, Register::R10, Register::R11] {
                    self.set_general(r, 0x7777);
                }
                self.vector = [[u64::MAX; 8]; 32];
            }
            // Asking for memory changes nothing.
            Vzeroupper | Prefetcht0 => {}
            _ => self.vector_step(i),
        }
    }

    fn vector_step(&mut self, i: &Instruction) {
        use Mnemonic::*;
        let to = i.op0_register();
        let bytes = if to == Register::None { width(i.op1_register()) } else { width(to) };
        let one = |p: &Self, bytes| p.operand(i, 1, bytes);
        let two = |p: &Self| (p.operand(i, 1, bytes), p.operand(i, 2, bytes));
        let result = match i.mnemonic() {
            Vmovupd | Vmovapd | Vmovups | Vmovaps if i.op0_kind() == OpKind::Memory => {
                let from = self.vector[number(i.op1_register())];
                let at = self.address(i);
                for k in 0..bytes / 8 {
                    self.memory.write(at + 8 * k as u64, from[k].to_le_bytes());
                }
                return;
            }
            Vmovupd | Vmovapd | Vmovups | Vmovaps => one(self, bytes),
            Vbroadcastsd => [one(self, 8)[0]; 8],
            Vbroadcastss => [whole([one(self, 4)[0] as u32; 2]); 8],
            Vaddpd => doubles(two(self).0, two(self).1, |a, b| a + b),
            Vsubpd => doubles(two(self).0, two(self).1, |a, b| a - b),
            Vmulpd => doubles(two(self).0, two(self).1, |a, b| a * b),
            Vdivpd => doubles(two(self).0, two(self).1, |a, b| a / b),
            Vaddps => singles(two(self).0, two(self).1, |a, b| a + b),
            Vsubps => singles(two(self).0, two(self).1, |a, b| a - b),
            Vmulps => singles(two(self).0, two(self).1, |a, b| a * b),
            Vdivps => singles(two(self).0, two(self).1, |a, b| a / b),
            Vxorpd | Vxorps | Vpxorq => integers(two(self).0, two(self).1, |a, b| a ^ b),
            Vsqrtpd => doubles(one(self, bytes), [0; 8], |a, _| a.sqrt()),
            Vsqrtps => singles(one(self, bytes), [0; 8], |a, _| a.sqrt()),
            Vmovsd => one(self, 8),
            Vmovhpd => {
                let (low, high) = (self.operand(i, 1, 16), self.operand(i, 2, 8));
                [low[0], high[0], 0, 0, 0, 0, 0, 0]
            }
            Vinsertf128 | Vinsertf32x4 => {
                let (mut v, high) = (self.operand(i, 1, 32), self.operand(i, 2, 16));
                assert_eq!((i.immediate8(), to.is_ymm()), (1, true), "{i:?}");
                v[2..4].copy_from_slice(&high[..2]);
                v
            }
            Vinsertf64x4 => {
                let (mut v, high) = (self.operand(i, 1, 64), self.operand(i, 2, 32));
                assert_eq!(i.immediate8(), 1);
                v[4..].copy_from_slice(&high[..4]);
                v
            }
            Vunpcklpd => {
                let (a, b) = two(self);
                std::array::from_fn(|k| if k % 2 == 0 { a[k] } else { b[k - 1] })
            }
            Vunpckhpd => {
                let (a, b) = two(self);
                std::array::from_fn(|k| if k % 2 == 0 { a[k + 1] } else { b[k] })
            }
            Vmovd => [self.integer_of_vector(i), 0, 0, 0, 0, 0, 0, 0],
            Vpbroadcastd => [whole([one(self, 4)[0] as u32; 2]); 8],
            Vpmulld => integers(two(self).0, two(self).1, u32::wrapping_mul),
            Vpcmpeqd => integers(two(self).0, two(self).1, |a, b| if a == b { u32::MAX } else { 0 }),
            Vgatherdps => return self.gather(i),
            _ => self.fused(i, bytes),
        };
        self.set(to, result);
    }

    fn integer_of_vector(&self, i: &Instruction) -> u64 {
        self.general(i.op1_register()) & 0xffff_ffff
    }

    fn gather(&mut self, i: &Instruction) {
        let (mask, index) = (number(i.op2_register()), number(i.memory_index()));
        assert!(mask != index && mask != number(i.op0_register()) && index != number(i.op0_register()));
        assert_eq!(self.vector[mask][..4], [u64::MAX; 4], "every lane is gathered");
        let base = self.general(i.memory_base()).wrapping_add(i.memory_displacement64());
        let scale = i64::from(i.memory_index_scale());
        let read = |row: u32| {
            let at = base.wrapping_add_signed(i64::from(row.cast_signed()) * scale);
            u32::from_le_bytes(self.memory.read(at))
        };
        let rows = self.vector[index];
        let mut v = [0; 8];
        for k in 0..4 {
            v[k] = whole(halves(rows[k]).map(read));
        }
        self.vector[mask] = [0; 8];
        self.set(i.op0_register(), v);
    }

    /// Fused multiply-adds: the digits say which operands are multiplied and which is added.
    fn fused(&self, i: &Instruction, bytes: usize) -> Vector {
        let name = format!("{:?}", i.mnemonic());
        let rest = name.strip_prefix("Vf").unwrap_or_else(|| panic!("the emulator does not know {i:?}"));
        let (minus_product, rest) = match rest.strip_prefix('n') {
            Some(rest) => (true, rest),
            None => (false, rest),
        };
        let minus_addend = rest.starts_with("msub");
        assert!(minus_addend || rest.starts_with("madd"), "the emulator does not know {i:?}");
        let digits: Vec<u32> = rest.chars().filter_map(|c| c.to_digit(10)).collect();
        let v = |digit: u32| self.operand(i, digit - 1, bytes);
        let (a, b, c) = (v(digits[0]), v(digits[1]), v(digits[2]));
        let sign = |negative: bool| if negative { -1.0 } else { 1.0 };
        let (p, s) = (sign(minus_product), sign(minus_addend));
        if rest.ends_with("pd") {
            std::array::from_fn(|k| {
                let [a, b, c] = [a[k], b[k], c[k]].map(f64::from_bits);
                (p * a).mul_add(b, s * c).to_bits()
            })
        } else {
            let (p, s) = (p as f32, s as f32);
            std::array::from_fn(|k| {
                let [a, b, c] = [a[k], b[k], c[k]].map(|w| halves(w).map(f32::from_bits));
                whole([0, 1].map(|h: usize| (p * a[h]).mul_add(b[h], s * c[h]).to_bits()))
            })
        }
    }
}
