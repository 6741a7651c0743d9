// From values to places on a drawing.

/** A scale from values to places [from, to]; `categories` in their order instead of numbers. */
function scale(values, { log = false, categories = null, from, to, ticks, zero = false }) {
  if (categories) {
    const step = (to - from) / Math.max(categories.length, 1);
    const place = (v) => from + (categories.indexOf(v) + 0.5) * step;
    return { place, ticks: categories, text: shown, categories };
  }
  let low = Math.min(...values);
  let high = Math.max(...values);
  if (!values.length) [low, high] = log ? [1, 10] : [0, 1];
  if (zero && !log) [low, high] = [Math.min(low, 0), Math.max(high, 0)];
  if (log) {
    if (low === high) [low, high] = [low / 2, high * 2];
    const margin = (high / low) ** 0.04;
    [low, high] = [low / margin, high * margin];
    const [a, b] = [Math.log(low), Math.log(high)];
    const place = (v) => from + ((Math.log(v) - a) / (b - a)) * (to - from);
    return { place, ticks: logTicks(low, high, ticks), text: (v) => formatted(v, 3) };
  }
  if (low === high) [low, high] = low === 0 ? [-1, 1] : [low - Math.abs(low) / 2, high + Math.abs(high) / 2];
  const margin = (high - low) * 0.04;
  [low, high] = [low - (zero && low === 0 ? 0 : margin), high + (zero && high === 0 ? 0 : margin)];
  const place = (v) => from + ((v - low) / (high - low)) * (to - from);
  return { place, ticks: linearTicks(low, high, ticks), text: (v) => formatted(v, 6) };
}

/** Slope of the straight line through (log x, log y) by least squares; null where three different x are missing. */
function fittedSlope(points) {
  const logs = points.filter((p) => p.x > 0 && p.y > 0).map((p) => [Math.log(p.x), Math.log(p.y)]);
  if (new Set(logs.map((p) => p[0])).size < 3) return null;
  const mean = (k) => logs.reduce((sum, p) => sum + p[k], 0) / logs.length;
  const [mx, my] = [mean(0), mean(1)];
  const slope = logs.reduce((s, p) => s + (p[0] - mx) * (p[1] - my), 0) / logs.reduce((s, p) => s + (p[0] - mx) ** 2, 0);
  return { slope, at: (x) => Math.exp(my + slope * (Math.log(x) - mx)) };
}

/** The points that no other one beats in both x and y, by x. */
function paretoFront(points) {
  const sorted = [...points].sort((a, b) => a.x - b.x || a.y - b.y);
  let best = Infinity;
  return sorted.filter((p) => {
    if (p.y >= best) return false;
    best = p.y;
    return true;
  });
}
