// Numbers, units and ticks, as people read them.

const SUPERSCRIPTS = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

const raised = (n) => String(n).replace(/[-0-9]/g, (c) => SUPERSCRIPTS[c]);

/** A number with four digits; very large and very small ones as a multiple of a power of ten. */
function formatted(x, digits = 4) {
  if (x === null || x === undefined || Number.isNaN(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 1e5 || size < 1e-3) {
    const [mantissa, exponent] = x.toExponential(digits - 1).split("e");
    const short = String(Number(mantissa)).replace("-", "−");
    const power = `10${raised(Number(exponent))}`;
    if (short === "1") return power;
    return short === "−1" ? `−${power}` : `${short} × ${power}`;
  }
  return String(Number(x.toPrecision(digits))).replace("-", "−");
}

/** `kg/m^3` as it is printed. */
const printedUnit = (unit) => unit.replace(/\^(-?\d+)/g, (_, n) => raised(n)).replace(" ", " ");

/** A value of a parameter: a number with its digits, or a text. */
const shown = (value) => (typeof value === "number" ? formatted(value, 6) : value === null ? "–" : String(value));

/** A name with its unit behind it. */
const withUnit = (name, unit) => (unit ? `${name} (${printedUnit(unit)})` : name);

/** Round numbers between two bounds, about `count` of them. */
function linearTicks(low, high, count) {
  const raw = (high - low) / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].find((m) => m * power >= raw * 0.999) * power;
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k += 1) {
    ticks.push(Math.abs(k) < 1e-12 ? 0 : Number((k * step).toPrecision(12)));
  }
  return ticks;
}

/** Powers of ten between two bounds; where there are few, also their multiples by 2 and 5. */
function logTicks(low, high, count) {
  const [first, last] = [Math.floor(Math.log10(low) - 1e-9), Math.ceil(Math.log10(high) + 1e-9)];
  const between = (ticks) => ticks.filter((t) => t >= low * (1 - 1e-9) && t <= high * (1 + 1e-9));
  const all = (multiples, every) => {
    const ticks = [];
    for (let e = first; e <= last; e += every) multiples.forEach((m) => ticks.push(m * 10 ** e));
    return between(ticks);
  };
  for (const multiples of [[1, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 5], [1, 3]]) {
    const ticks = all(multiples, 1);
    if (ticks.length <= count) return ticks;
  }
  const every = Math.max(1, Math.ceil(all([1], 1).length / Math.max(count, 2)));
  return all([1], every);
}

/** An element with attributes and children; texts are set as texts, never as markup. */
function make(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) element.setAttribute(key, value === true ? "" : value);
  }
  element.append(...children.filter((c) => c !== null && c !== undefined));
  return element;
}

/** The same for a drawing. */
function draw(name, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}
