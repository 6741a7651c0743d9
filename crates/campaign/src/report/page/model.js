// The group as the page sees it: factors, quantities, simulations by index, and what is chosen.

/** Whatever is chosen; it survives new data. */
const chosen = {
  filters: new Map(), // name of a factor → set of values that are shown, or { low, high }
  statuses: new Set(), // statuses that are hidden in the table
  search: "",
  y: null, x: null, logX: null, logY: null,
  error: null, size: null, time: null,
  curves: "finest",
  columns: "varying",
  sort: { column: "number", down: false },
  rows: 200,
  hidden: { quantity: new Set(), deflection: new Set(), resolution: new Set(), cost: new Set() },
};

/** Adds to the data what follows from them. */
function model(data) {
  const distinct = (values) => {
    const all = [...new Set(values.filter((v) => v !== null))];
    return all.every((v) => typeof v === "number") ? all.sort((a, b) => a - b) : all;
  };
  const last = (name) => name.split(".").at(-1);
  const names = data.factors.map((f) => last(f.name));
  data.factors.forEach((f, k) => {
    f.distinct = distinct(f.values);
    f.numeric = f.distinct.length > 0 && f.distinct.every((v) => typeof v === "number");
    // `young` says enough, unless two parameters end so.
    f.label = names.filter((n) => n === names[k]).length > 1 ? f.name : names[k];
    f.varies = f.distinct.length > 1;
  });
  data.varying = data.factors.filter((f) => f.varies);
  data.byNumber = new Map(data.simulations.map((s, at) => [s.number, at]));
  data.succeeded = (at) => ["finished", "at rest"].includes(data.simulations[at].status);
  data.ofKind = (...kinds) => data.quantities.filter((q) => kinds.includes(q.kind));
  /** The factor with the most values: numbers before words. */
  const order = [...data.varying].sort((a, b) => b.distinct.length - a.distinct.length || Number(b.numeric) - Number(a.numeric));
  data.mostVaried = order[0] ?? data.factors[0] ?? null;
  return data;
}

/** A factor's value of a simulation in words. */
const factorText = (factor, at) => `${factor.label} ${shown(factor.values[at])}`;

/** What tells a simulation from the others, without the factors of `without`. */
const describe = (data, at, without = []) =>
  data.varying.filter((f) => !without.includes(f)).map((f) => (typeof f.values[at] === "number" ? `${f.label} ${shown(f.values[at])}` : shown(f.values[at]))).join(", ");

/** Indices of the simulations that the filters let through. */
function visible(data) {
  return data.simulations.map((_, at) => at).filter((at) => data.varying.every((f) => {
    const filter = chosen.filters.get(f.name);
    if (!filter) return true;
    const value = f.values[at];
    if (filter instanceof Set) return filter.has(value);
    return value !== null && value >= filter.low && value <= filter.high;
  }));
}

/**
 * Curves: simulations that agree in all factors but those of `along`.
 *
 * Colour and marker follow the factor with the most values among those that are left, dashes the others together, so that
 * what belongs together looks alike. Drawn factors (of a hypercube) tell nothing apart: all of their samples are one cloud, unless `drawnToo`.
 */
function grouped(data, indices, along, drawnToo = false) {
  const splitting = data.varying.filter((f) => !along.includes(f) && (drawnToo || !f.drawn));
  const bySize = [...splitting].sort((a, b) => Number(a.numeric) - Number(b.numeric) || b.distinct.length - a.distinct.length);
  const main = bySize[0] ?? null;
  const others = splitting.filter((f) => f !== main);
  const groups = new Map();
  const dashes = new Map();
  const dashOf = (at) => {
    const key = JSON.stringify(others.map((f) => f.values[at]));
    if (!dashes.has(key)) dashes.set(key, dashes.size);
    return dashes.get(key);
  };
  // All simulations are asked, so that a curve keeps its look when filters change.
  data.simulations.forEach((_, at) => {
    const key = JSON.stringify(splitting.map((f) => f.values[at]));
    if (!groups.has(key)) {
      const colour = main ? Math.max(0, main.distinct.indexOf(main.values[at])) : 0;
      const label = splitting.map((f) => (f.numeric ? factorText(f, at) : shown(f.values[at]))).join(", ") || "all simulations";
      groups.set(key, { key, label, style: { colour, dash: dashOf(at) }, members: [] });
    }
    groups.get(key).members.push(at);
  });
  const shownOnes = new Set(indices);
  for (const g of groups.values()) g.members = g.members.filter((at) => shownOnes.has(at));
  return [...groups.values()].filter((g) => g.members.length)
    .sort((a, b) => a.style.colour - b.style.colour || a.style.dash - b.style.dash);
}
