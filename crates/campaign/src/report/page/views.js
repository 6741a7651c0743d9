// The three kinds of graphs.

/** The quantities of some kinds as entries of a menu. */
const entries = (list, group) => list.map((q) => ({ value: q.name, text: withUnit(q.name, q.unit), group }));

const kinds = { time: "time", error: "error", measure: "measurement", size: "size" };

const byName = (data, name) => data.quantities.find((q) => q.name === name) ?? null;

/** What an axis shows: a quantity or a factor. */
function axisOf(data, name) {
  const quantity = byName(data, name);
  if (quantity) return { label: quantity.name, unit: quantity.unit, of: (at) => quantity.values[at], quantity };
  const factor = data.factors.find((f) => f.name === name);
  return { label: factor.label, unit: factor.unit, of: (at) => factor.values[at], factor, categories: factor.numeric ? null : factor.distinct };
}

/** Logarithmic from itself where values are multiplied or spread over more than a factor of 30. */
function spreads(values) {
  const numbers = values.filter((v) => typeof v === "number");
  return numbers.length > 0 && numbers.every((v) => v > 0) && Math.max(...numbers) / Math.min(...numbers) > 30;
}

const section = (title, about) => {
  const host = make("section", { class: "card" });
  const menus = make("div", { class: "menus" });
  const graph = make("div", { class: "graph" });
  const notes = make("div", { class: "notes" });
  host.append(make("h2", {}, title), make("p", { class: "about" }, about), menus, graph, notes);
  return { host, menus, graph, notes };
};

/** Says which simulations a graph leaves out, and why. */
function missing(data, notes, indices, has, without = () => "no value") {
  const out = indices.filter((at) => !has(at));
  if (!out.length) return;
  const reasons = new Map();
  for (const at of out) {
    const { status } = data.simulations[at];
    const why = data.succeeded(at) ? without(at) : status;
    reasons.set(why, [...(reasons.get(why) ?? []), data.simulations[at].number]);
  }
  const text = [...reasons].map(([why, numbers]) => `${why}: ${numbers.slice(0, 12).map((n) => `#${n}`).join(", ")}${numbers.length > 12 ? ` and ${numbers.length - 12} more` : ""}`).join("; ");
  const harmless = [...reasons.keys()].every((why) => why === "the finest itself" || why === "to do");
  notes.append(make("p", { class: harmless ? "" : "missing" }, `${out.length} of ${indices.length} simulations are not drawn (${text}).`));
}

/** (a) A quantity against a parameter, one curve per combination of the others. */
function quantityView(data, pick) {
  const { host, menus, graph, notes } = section("One quantity", "One curve for each combination of everything else that varies.");
  const good = (name) => byName(data, name) || data.factors.some((f) => f.name === name);
  const first = ["steps per second", "time per step", "wall time"].find((n) => byName(data, n)) ?? data.quantities[0]?.name;
  if (!good(chosen.y)) chosen.y = first ?? null;
  if (!good(chosen.x)) chosen.x = data.mostVaried?.name ?? null;
  if (!chosen.y || !chosen.x) {
    graph.append(make("p", { class: "empty" }, "Nothing varies here, or nothing was measured yet."));
    return { host, draw: () => {} };
  }
  const ofKinds = (...list) => list.flatMap((k) => entries(data.ofKind(k), kinds[k]));
  const xs = [...data.varying.map((f) => ({ value: f.name, text: withUnit(f.label, f.unit), group: "parameter" })), ...ofKinds("size", "time", "error", "measure")];
  const paint = () => {
    const [x, y] = [axisOf(data, chosen.x), axisOf(data, chosen.y)];
    const indices = visible(data);
    const logX = !x.categories && (chosen.logX ?? (x.factor?.multiplying || spreads(indices.map(x.of))));
    const logY = chosen.logY ?? spreads(indices.map(y.of));
    menus.replaceChildren(...[
      menu("vertical", ofKinds("time", "error", "measure", "size"), chosen.y, (v) => { chosen.y = v; chosen.logY = null; paint(); }),
      menu("horizontal", xs, chosen.x, (v) => { chosen.x = v; chosen.logX = null; chosen.hidden.quantity.clear(); paint(); }),
      x.categories ? null : tick("log horizontal", logX, (v) => { chosen.logX = v; paint(); }),
      tick("log vertical", logY, (v) => { chosen.logY = v; paint(); })].filter(Boolean));
    // A size follows from the parameters of the mesh: these do not tell curves apart then.
    const along = x.factor ? [x.factor] : data.varying.filter((f) => f.numerical && follows(data, f, x.of));
    const has = (at) => x.of(at) !== null && y.of(at) !== null;
    const series = grouped(data, indices, along).map((g) => ({
      ...g,
      line: !along.some((f) => f.drawn) && !g.members.some((at) => data.varying.some((f) => f.drawn)),
      points: ordered(g.members.filter(has).map((at) => point(data, at, x.of(at), y.of(at), along)), x.categories),
    })).filter((s) => s.points.length);
    chart(graph, { name: `${chosen.y} against ${chosen.x}`, x: { ...x, log: logX }, y: { ...y, log: logY, zero: !logY && y.quantity?.kind === "time" }, series }, chosen.hidden.quantity, pick);
    notes.replaceChildren();
    if (y.quantity?.about) notes.append(make("p", {}, `${y.label}: ${y.quantity.about}.`));
    missing(data, notes, indices, has);
  };
  return { host, draw: paint };
}

/** Whether a quantity changes with a factor where everything else is the same. */
function follows(data, factor, of) {
  const seen = new Map();
  return data.simulations.some((_, at) => {
    if (of(at) === null) return false;
    const key = JSON.stringify(data.varying.filter((f) => f !== factor).map((f) => f.values[at]));
    if (!seen.has(key)) seen.set(key, of(at));
    return seen.get(key) !== of(at);
  }) && factor.name !== "bar" && factor.name !== "device" && factor.name !== "machine";
}

const point = (data, at, x, y, along) => {
  const s = data.simulations[at];
  const notes = [describe(data, at, along), s.elements].filter(Boolean);
  if (along.length && !along.some((f) => f.values[at] === x)) notes.push(along.map((f) => factorText(f, at)).join(", "));
  return { x, y, simulation: at, title: `#${s.number}`, notes };
};

const ordered = (points, categories) => points.sort((a, b) => (categories ? categories.indexOf(a.x) - categories.indexOf(b.x) : a.x - b.x));

/** (b) Deflection curves over each other, with beam theory. */
function deflectionView(data, pick) {
  const { host, menus, graph, notes } = section("Deflection", "Where the axis of the bar goes.");
  if (!data.curves.length) {
    graph.append(make("p", { class: "empty" }, "No simulation has a deflection curve: a probe with quantity = \"deflection curve\" makes one."));
    return { host, draw: () => {} };
  }
  const curveOf = new Map(data.curves.map((c) => [c.at, c]));
  const nodes = byName(data, "nodes");
  const paint = () => {
    menus.replaceChildren(menu("simulations", [{ value: "finest", text: "the finest of each kind" }, { value: "all", text: "all that are shown" }], chosen.curves, (v) => {
      chosen.curves = v;
      chosen.hidden.deflection.clear();
      paint();
    }));
    const indices = visible(data).filter((at) => curveOf.has(at));
    const along = chosen.curves === "finest" ? data.varying.filter((f) => f.numerical && nodes && follows(data, f, (at) => nodes.values[at])) : [];
    // Samples of a hypercube are different bars.
    const groups = grouped(data, indices, along, true);
    const size = (at) => nodes?.values[at] ?? 0;
    const series = groups.map((g) => {
      const at = g.members.reduce((best, other) => (size(other) > size(best) ? other : best));
      const { x, w } = curveOf.get(at);
      const number = `#${data.simulations[at].number}`;
      return { ...g, label: along.length ? `${g.label} (${number})` : g.label, line: true, drawn: at, points: x.map((v, k) => ({ x: v, y: w[k], simulation: at, title: `${number} ${g.label}` })) };
    });
    const present = new Set(series.map((s) => s.drawn));
    const beams = data.beams.filter((b) => b.simulations.some((at) => present.has(at)));
    for (const beam of beams) {
      const at = beam.simulations.find((k) => present.has(k));
      const which = beams.length > 1 ? ` (${physics(data, at)})` : "";
      for (const [name, values, dash] of [["Euler–Bernoulli", beam.euler_bernoulli, 2], ["Timoshenko", beam.timoshenko, 0]]) {
        const key = JSON.stringify([name, beam.simulations[0]]);
        series.push({ key, label: name + which, style: { colour: 0, dash }, bare: true, closed: true, line: true, points: beam.x.map((x, k) => ({ x, y: values[k], title: name + which })) });
      }
    }
    chart(graph, { name: "Deflection along the bar", x: { label: "place along the bar", unit: "m" }, y: { label: "deflection", unit: "m", zero: true }, series }, chosen.hidden.deflection, pick);
    notes.replaceChildren();
    if (beams.length) {
      const worst = Math.max(...beams.map((b) => b.tip_over_length));
      const large = worst > 0.05 ? " That is large: laws that follow large rotations leave beam theory here, as they should." : "";
      notes.append(make("p", {}, `Euler–Bernoulli and Timoshenko: a beam of the same material and section under its own weight, for small deflections. Its tip sinks by ${formatted(100 * worst, 3)} % of its length.${large}`));
    }
    missing(data, notes, visible(data), (at) => curveOf.has(at));
  };
  return { host, draw: paint };
}

/** The values of what is computed, without how. */
const physics = (data, at) => data.varying.filter((f) => !f.numerical).map((f) => (f.numeric ? factorText(f, at) : shown(f.values[at]))).join(", ") || `#${data.simulations[at].number}`;

/** (c) Error against resolution and against time, with the Pareto front. */
function errorView(data, pick) {
  const { host, menus, graph, notes } = section("Error", "Against resolution: the slope is the order of convergence. Against time: what is on the Pareto front is beaten by no other simulation in both.");
  const errors = data.ofKind("error");
  const sizes = data.ofKind("size");
  const times = data.ofKind("time").filter((q) => q.name !== "steps per second");
  if (!errors.length || !sizes.length || !times.length) {
    graph.append(make("p", { class: "empty" }, "No simulation has an error: there is no closed form for it, no finer simulation of the same problem, and no [[expect]] in the scene."));
    return { host, draw: () => {} };
  }
  const or = (list, name, first) => (list.some((q) => q.name === name) ? name : first.find((n) => list.some((q) => q.name === n)) ?? list[0].name);
  const pair = make("div", { class: "pair" });
  const [left, right] = [make("div", {}), make("div", {})];
  pair.append(left, right);
  graph.append(pair);
  const paint = () => {
    // What converges to zero first: beam theory is itself an approximation.
    const finest = errors.map((q) => q.name).filter((n) => n.endsWith("against the finest"));
    chosen.error = or(errors, chosen.error, [...finest.filter((n) => n.includes("displacement")), ...finest]);
    chosen.size = or(sizes, chosen.size, ["cell size", "nodes"]);
    chosen.time = or(times, chosen.time, ["wall time"]);
    menus.replaceChildren(
      menu("error", entries(errors), chosen.error, (v) => { chosen.error = v; paint(); }),
      menu("resolution", entries(sizes), chosen.size, (v) => { chosen.size = v; paint(); }),
      menu("time", entries(times), chosen.time, (v) => { chosen.time = v; paint(); }));
    const [error, size, time] = [chosen.error, chosen.size, chosen.time].map((n) => axisOf(data, n));
    const indices = visible(data);
    const along = data.varying.filter((f) => f.numerical && follows(data, f, size.of));
    const groups = grouped(data, indices, along);
    const series = (axis, slopes) => groups.map((g) => {
      const members = g.members.filter((at) => axis.of(at) !== null && error.of(at) !== null);
      // Along a curve the resolution grows, also where times go up and down.
      members.sort((a, b) => size.of(a) - size.of(b));
      const points = members.map((at) => withReference(data, at, point(data, at, axis.of(at), error.of(at), along)));
      const cloud = data.varying.some((f) => f.drawn);
      return { ...g, line: !cloud, points, slope: slopes && !cloud ? fittedSlope(points) : null };
    }).filter((s) => s.points.length);
    // The menu says which error; beside a narrow graph there is no room for its name.
    const label = { ...error, label: "error", log: true };
    chart(left, { name: `${error.label} against ${size.label}`, x: { ...size, log: true }, y: label, series: series(size, true) }, chosen.hidden.resolution, pick);
    const costs = series(time, false);
    const front = paretoFront(costs.flatMap((s) => s.points.map((p) => ({ ...p, label: s.label }))).filter((p) => p.x > 0 && p.y > 0));
    chart(right, { name: `${error.label} against ${time.label}`, x: { ...time, log: true }, y: label, series: costs, front }, chosen.hidden.cost, pick);
    notes.replaceChildren(make("p", {}, `${error.label}: ${error.quantity.about}.`));
    const several = data.varying.filter((f) => !f.numerical && new Set(indices.map((at) => f.values[at])).size > 1);
    if (front.length && several.length) notes.append(make("p", {}, `The front is that of several problems together: choose one value of ${several.map((f) => f.label).join(" and ")} above to judge methods by one.`));
    if (front.length) notes.append(best(data, front, time, error, pick));
    const finestItself = (at) => (chosen.error.endsWith("against the finest") && data.simulations.some((s) => s.reference === data.simulations[at].number) ? "the finest itself" : "no value");
    missing(data, notes, indices, (at) => error.of(at) !== null && size.of(at) !== null && time.of(at) !== null, finestItself);
  };
  return { host, draw: paint };
}

function withReference(data, at, p) {
  const { reference } = data.simulations[at];
  return chosen.error.endsWith("against the finest") && reference !== null && reference !== undefined ? { ...p, notes: [...p.notes, `against #${reference}`] } : p;
}

/** The Pareto front in words: what to take, by the time that one has. */
function best(data, front, time, error, pick) {
  const rows = front.map((p) => make("tr", {},
    make("td", { class: "number" }, formatted(p.x, 3)), make("td", { class: "number" }, formatted(p.y, 3)),
    make("td", {}, make("button", { type: "button", class: "link", onclick: () => pick(p.simulation) }, `#${data.simulations[p.simulation].number}`), ` ${describe(data, p.simulation)}`)));
  return make("details", { open: front.length <= 8 },
    make("summary", {}, "Pareto front: the most exact for its time"),
    make("div", { class: "scroll" }, make("table", { class: "small" },
      make("thead", {}, make("tr", {}, make("th", { class: "number" }, withUnit(time.label, time.unit)), make("th", { class: "number" }, withUnit(error.label, error.unit)), make("th", {}, "simulation"))),
      make("tbody", {}, ...rows))));
}
