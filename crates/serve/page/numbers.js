// Numbers as people read them: three digits, and the prefix that fits.

const PREFIXES = [[1e12, "T"], [1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]];

/** Three digits: "0.0123", "456", "1.2e9". */
export function plain(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size < 1e-3 || size >= 1e5) return value.toExponential(2).replace("e+", "e");
  const before = Math.floor(Math.log10(size));
  return String(Number(value.toFixed(Math.max(0, 2 - before))));
}

/** A number with its SI unit and a prefix: "20 kPa", "1.5 mm". */
export function withUnit(value, unit) {
  if (!unit) return plain(value);
  // Squares and kilograms do not take the prefix that their number would suggest.
  const fits = unit.startsWith("kg") || unit.includes("²") ? null : PREFIXES.find(([size]) => Math.abs(value) >= size * 0.9995);
  return fits ? `${plain(value / fits[0])} ${fits[1]}${unit}` : `${plain(value)} ${unit}`;
}
