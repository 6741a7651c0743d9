// Which simulations all graphs and the table show.

/** Above this number of values a factor is filtered by bounds. */
const CHIPS_AT_MOST = 16;

function filters(data, changed) {
  const host = make("section", { class: "filters", "aria-label": "Filters" });
  const rows = data.varying.map((f) => (f.numeric && f.distinct.length > CHIPS_AT_MOST ? bounds(f, changed) : chips(f, changed)));
  if (!rows.length) return host;
  host.append(make("h2", {}, "Show"), make("div", { class: "rows" }, ...rows));
  return host;
}

function chips(factor, changed) {
  const group = make("div", { role: "group", class: "filter", "aria-label": factor.name }, make("span", { class: "name", title: factor.name }, withUnit(factor.label, factor.unit)));
  const all = factor.distinct;
  const paint = () => {
    const set = chosen.filters.get(factor.name);
    group.querySelectorAll("button").forEach((b, k) => b.setAttribute("aria-pressed", String(!set || set.has(all[k]))));
  };
  for (const value of all) {
    group.append(make("button", { type: "button", class: "chip", onclick: () => {
      // From all, a click leaves this one; the last one that goes brings all back.
      const set = chosen.filters.get(factor.name) ?? new Set();
      if (set.has(value)) set.delete(value);
      else set.add(value);
      if (set.size === 0 || set.size === all.length) chosen.filters.delete(factor.name);
      else chosen.filters.set(factor.name, set);
      paint();
      changed();
    } }, shown(value)));
  }
  paint();
  return group;
}

function bounds(factor, changed) {
  const [low, high] = [factor.distinct[0], factor.distinct.at(-1)];
  const present = chosen.filters.get(factor.name) ?? { low, high };
  const input = (which) => make("input", { type: "number", step: "any", value: present[which], "aria-label": `${factor.label}, ${which === "low" ? "from" : "to"}`, onchange: (event) => {
    const filter = chosen.filters.get(factor.name) ?? { low, high };
    filter[which] = event.target.value === "" ? (which === "low" ? low : high) : Number(event.target.value);
    if (filter.low <= low && filter.high >= high) chosen.filters.delete(factor.name);
    else chosen.filters.set(factor.name, filter);
    changed();
  } });
  return make("div", { role: "group", class: "filter", "aria-label": factor.name },
    make("span", { class: "name", title: factor.name }, withUnit(factor.label, factor.unit)), input("low"), " to ", input("high"));
}

/** A menu. */
function menu(label, options, value, change) {
  const select = make("select", { onchange: (event) => change(event.target.value) });
  for (const { value: v, text, group } of options) {
    let parent = select;
    if (group) {
      parent = [...select.querySelectorAll("optgroup")].find((g) => g.label === group);
      if (!parent) select.append(parent = make("optgroup", { label: group }));
    }
    parent.append(make("option", { value: v, selected: v === value }, text));
  }
  return make("label", { class: "menu" }, make("span", {}, label), select);
}

function tick(label, value, change) {
  return make("label", { class: "tick" }, make("input", { type: "checkbox", checked: value, onchange: (event) => change(event.target.checked) }), make("span", {}, label));
}
