// Binary messages: a header in JSON that names arrays, then the arrays, little-endian, each at a multiple of four bytes.

const TYPES = { f32: Float32Array, u32: Uint32Array, u16: Uint16Array };
const text = new TextDecoder();

/** The header of a message, with its arrays by name. */
export function decode(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(text.decode(new Uint8Array(buffer, 4, length)));
  const arrays = {};
  let at = 4 + length;
  for (const { name, type, length } of header.arrays) {
    arrays[name] = new TYPES[type](buffer, at, length);
    at += Math.ceil(arrays[name].byteLength / 4) * 4;
  }
  return { header, arrays };
}
