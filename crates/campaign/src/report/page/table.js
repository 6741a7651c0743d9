// All simulations with everything that is known of them.

/** The columns: a name, a value to sort by, and what stands in the cell. */
function columnsOf(data) {
  const all = [
    { name: "number", of: (at) => data.simulations[at].number, cell: (at) => numberCell(data, at), always: true },
    ...data.factors.map((f) => ({ name: f.name, label: withUnit(f.label, f.unit), of: (at) => f.values[at], always: f.varies, varies: f.varies })),
    { name: "status", of: (at) => data.simulations[at].status, cell: (at) => make("span", { class: `status ${data.succeeded(at) ? "good" : data.simulations[at].status === "to do" ? "open" : "bad"}` }, data.simulations[at].status), always: true },
    { name: "reason", of: (at) => data.simulations[at].reason || null, cell: (at) => reasonCell(data.simulations[at].reason) },
    { name: "elements by kind", of: (at) => data.simulations[at].elements || null },
    ...data.quantities.map((q) => ({ name: q.name, label: withUnit(q.name, q.unit), of: (at) => q.values[at], title: q.about })),
  ];
  if (data.machines.length) all.push({ name: "threads", of: (at) => data.simulations[at].threads ?? null });
  return all.filter((c) => c.always || data.simulations.some((_, at) => c.of(at) !== null));
}

function numberCell(data, at) {
  const { number, link } = data.simulations[at];
  return link ? make("a", { href: link, title: "folder of its results" }, `#${number}`) : `#${number}`;
}

function reasonCell(reason) {
  if (!reason) return "";
  const [first, ...rest] = reason.split("\n");
  return rest.length || first.length > 70 ? make("details", {}, make("summary", {}, first.slice(0, 70) + (first.length > 70 ? "…" : "")), make("pre", {}, reason)) : first;
}

/** Missing values come last, whichever way one sorts. */
function compared(a, b, down) {
  if (a === null || b === null) return (a === null) - (b === null);
  const order = typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b), "en", { numeric: true });
  return down ? -order : order;
}

function tableView(data) {
  const host = make("section", { class: "card", id: "simulations" });
  const controls = make("div", { class: "menus" });
  const scroll = make("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Table of simulations" });
  const notes = make("div", { class: "notes" });
  host.append(make("h2", {}, "Simulations"), controls, scroll, notes);
  const columns = columnsOf(data);
  const statuses = [...new Set(data.simulations.map((s) => s.status))];

  const chips = make("div", { role: "group", class: "filter", "aria-label": "status" });
  for (const status of statuses) {
    const count = data.simulations.filter((s) => s.status === status).length;
    const chip = make("button", { type: "button", class: "chip", "aria-pressed": String(!chosen.statuses.has(status)), onclick: () => {
      if (!chosen.statuses.delete(status)) chosen.statuses.add(status);
      chip.setAttribute("aria-pressed", String(!chosen.statuses.has(status)));
      paint();
    } }, `${status} ${count}`);
    chips.append(chip);
  }
  controls.append(
    make("label", { class: "menu" }, make("span", {}, "search"), make("input", { type: "search", value: chosen.search, placeholder: "in every column", oninput: (event) => { chosen.search = event.target.value; paint(); } })),
    menu("columns", [{ value: "varying", text: "those that differ" }, { value: "all", text: "all" }], chosen.columns, (v) => { chosen.columns = v; paint(); }),
    chips);

  const differs = (c) => {
    const first = c.of(0);
    return data.simulations.some((_, at) => c.of(at) !== first);
  };
  const paint = (focus = null) => {
    const kept = columns.filter((c) => c.always || chosen.columns === "all" || differs(c));
    const words = chosen.search.toLowerCase().split(/\s+/).filter(Boolean);
    const text = (at) => columns.map((c) => `${c.of(at) ?? ""} ${typeof c.of(at) === "number" ? formatted(c.of(at)) : ""}`).join(" ").toLowerCase();
    const found = visible(data).filter((at) => !chosen.statuses.has(data.simulations[at].status) && (!words.length || words.every((w) => text(at).includes(w))));
    const sorting = columns.find((c) => c.name === chosen.sort.column) ?? columns[0];
    found.sort((a, b) => compared(sorting.of(a), sorting.of(b), chosen.sort.down) || a - b);
    const heads = kept.map((c) => {
      const sorted = c === sorting;
      const button = make("button", { type: "button", title: c.title, onclick: () => {
        chosen.sort = { column: c.name, down: sorted && !chosen.sort.down };
        paint(c.name);
      } }, c.label ?? c.name, make("span", { class: "arrow", "aria-hidden": "true" }, sorted ? (chosen.sort.down ? " ↓" : " ↑") : ""));
      return make("th", { scope: "col", "aria-sort": sorted ? (chosen.sort.down ? "descending" : "ascending") : "none", "data-column": c.name }, button);
    });
    const rows = found.slice(0, chosen.rows).map((at) => make("tr", { id: `simulation-${data.simulations[at].number}` }, ...kept.map((c) => {
      const value = c.of(at);
      const missing = value === null || value === "";
      const cell = c.cell && !missing ? c.cell(at) : missing ? "–" : shown(typeof value === "number" && !Number.isInteger(value) ? Number(value.toPrecision(6)) : value);
      return make("td", { class: `${typeof value === "number" ? "number" : ""}${missing ? " none" : ""}` }, cell);
    })));
    scroll.replaceChildren(make("table", {}, make("thead", {}, make("tr", {}, ...heads)), make("tbody", {}, ...rows)));
    if (focus) scroll.querySelector(`th[data-column="${CSS.escape(focus)}"] button`)?.focus();
    notes.replaceChildren(make("p", { "aria-live": "polite" }, `${found.length} of ${data.simulations.length} simulations.`));
    if (found.length > chosen.rows) notes.append(make("button", { type: "button", class: "chip", onclick: () => { chosen.rows += 1000; paint(); } }, `show ${Math.min(1000, found.length - chosen.rows)} more`));
  };
  const pick = (at) => {
    const number = data.simulations[at].number;
    const row = () => document.getElementById(`simulation-${number}`);
    if (!row()) {
      chosen.search = "";
      controls.querySelector("input[type=search]").value = "";
      chosen.rows = Infinity;
      paint();
    }
    document.querySelectorAll("tr.picked").forEach((r) => r.classList.remove("picked"));
    row()?.classList.add("picked");
    row()?.scrollIntoView({ block: "center", behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth" });
  };
  return { host, draw: () => paint(), pick };
}
