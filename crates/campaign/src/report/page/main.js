// The page from top to bottom.

function heading(data) {
  const count = (status) => data.simulations.filter((s) => s.status === status).length;
  const statuses = [...new Set(data.simulations.map((s) => s.status))];
  const wall = byName(data, "wall time");
  const total = wall ? wall.values.reduce((sum, v) => sum + (v ?? 0), 0) : null;
  const tile = (value, text, look = "") => make("div", { class: `tile ${look}` }, make("b", {}, value), make("span", {}, text));
  const look = (s) => (["finished", "at rest"].includes(s) ? "good" : s === "to do" ? "" : "bad");
  return make("header", {},
    make("p", { class: "kind" }, "Campaign report"),
    make("h1", {}, data.name),
    make("p", { class: "about" }, [`${data.simulations.length} simulations`, data.varying.map((f) => `${f.distinct.length} × ${f.label}`).join(", "), data.machines.map((m) => m.processor).join("; ")].filter(Boolean).join(" · ")),
    make("div", { class: "tiles" }, ...statuses.map((s) => tile(String(count(s)), s, look(s))), total === null ? null : tile(total < 120 ? `${formatted(total, 3)} s` : `${formatted(total / 60, 3)} min`, "of processes")));
}

/** What did not come to its end, with the reasons; nothing where all did. */
function failures(data, pick) {
  const bad = data.simulations.map((_, at) => at).filter((at) => !data.succeeded(at) && data.simulations[at].status !== "to do");
  if (!bad.length) return null;
  const groups = new Map();
  for (const at of bad) {
    const s = data.simulations[at];
    const key = `${s.status}: ${s.reason.split("\n")[0]}`;
    groups.set(key, [...(groups.get(key) ?? []), at]);
  }
  const rows = [...groups].map(([key, list]) => make("tr", {},
    make("td", {}, make("span", { class: "status bad" }, data.simulations[list[0]].status)),
    make("td", {}, key.slice(key.indexOf(": ") + 2)),
    make("td", {}, ...list.slice(0, 20).flatMap((at) => [make("button", { type: "button", class: "link", title: describe(data, at), onclick: () => pick(at) }, `#${data.simulations[at].number}`), " "]), list.length > 20 ? `and ${list.length - 20} more` : null)));
  return make("section", { class: "card" }, make("h2", {}, "Did not come to their end"),
    make("div", { class: "scroll" }, make("table", { class: "small" }, make("thead", {}, make("tr", {}, make("th", {}, "status"), make("th", {}, "reason"), make("th", {}, "simulations"))), make("tbody", {}, ...rows))));
}

function origins(data) {
  const variation = (p) => ({
    list: `${p.count} values`,
    adding: `from ${shown(p.first)} to ${shown(p.last)}, adding ${shown(p.step)}: ${p.count} values`,
    multiplying: `from ${shown(p.first)} to ${shown(p.last)}, times ${shown(p.step)}: ${p.count} values`,
    "latin hypercube": `${p.count} drawn between ${shown(p.first)} and ${shown(p.last)} (Latin hypercube)`,
  })[p.variation] ?? p.variation;
  const table = (heads, rows) => make("div", { class: "scroll" }, make("table", { class: "small" }, make("thead", {}, make("tr", {}, ...heads.map((h) => make("th", {}, h)))), make("tbody", {}, ...rows.map((cells) => make("tr", {}, ...cells.map((c) => make("td", {}, c)))))));
  const host = make("section", { class: "card" }, make("h2", {}, "Where it comes from"));
  if (data.parameters.length) host.append(make("h3", {}, "Parameters"), table(["name", "unit", "values"], data.parameters.map((p) => [make("code", {}, p.name), printedUnit(p.unit) || "–", variation(p)])));
  if (data.bars.length) host.append(make("h3", {}, "Bars"), table(["name", "sections"], data.bars.map((b) => [b.name, b.sections.map(([until, law, element, quadrature]) => `to ${shown(until)}: ${law}, ${element}${quadrature ? ` (quadrature ${quadrature})` : ""}`).join("; ")])));
  if (data.machines.length) host.append(make("h3", {}, "Machines"), table(["name", "processor", "threads", "system"], data.machines.map((m) => [m.host, m.processor, String(m.cores), m.system])));
  if (data.programs.length) host.append(make("h3", {}, "Programs (SHA-256)"), make("ul", {}, ...data.programs.map((p) => make("li", {}, make("code", {}, p)))));
  host.append(make("h3", {}, "Description"), make("p", {}, make("code", {}, `${data.folder}/${data.source}`)),
    make("details", {}, make("summary", {}, "base scene"), make("pre", {}, data.scene)));
  return host;
}

function show(data) {
  const page = document.getElementById("report");
  const parts = [];
  const changed = () => parts.forEach((p) => p.draw());
  const table = tableView(data);
  parts.push(quantityView(data, table.pick), deflectionView(data, table.pick), errorView(data, table.pick), table);
  page.replaceChildren(...[heading(data), failures(data, table.pick), filters(data, changed), ...parts.map((p) => p.host), origins(data)].filter(Boolean));
  changed();
}

/** Asks for new data as long as the page is looked at; the answer "not modified" costs nothing. */
function follow(address) {
  let version = null;
  const state = make("p", { class: "live", role: "status" });
  document.body.append(state);
  const ask = async () => {
    try {
      if (document.visibilityState === "visible") {
        const answer = await fetch(address, { headers: version ? { "If-None-Match": version } : {}, cache: "no-store" });
        if (answer.status === 200) {
          version = answer.headers.get("ETag");
          show(model(await answer.json()));
        } else if (answer.status !== 304) throw new Error(`status ${answer.status}`);
        state.textContent = "live";
      }
    } catch (error) {
      state.textContent = `the server does not answer (${error.message}); what is shown is the last that it said`;
    }
    setTimeout(ask, 2000);
  };
  ask();
}

const data = JSON.parse(document.getElementById("data").textContent);
show(model(data));
if (data.live) follow(data.live);
