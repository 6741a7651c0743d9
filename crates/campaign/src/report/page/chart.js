// One graph: axes, curves with markers, a legend whose entries toggle, values under the pointer and by arrow keys.
//
// A curve is told from the others by colour, shape of its markers and dashes, so that it also can be in print and by
// people who see colours differently.

const MARKERS = [
  (r) => `M${-r},0A${r},${r} 0 1 0 ${r},0A${r},${r} 0 1 0 ${-r},0Z`,
  (r) => `M${-r},${-r}H${r}V${r}H${-r}Z`,
  (r) => `M0,${-1.3 * r}L${1.2 * r},${0.9 * r}H${-1.2 * r}Z`,
  (r) => `M0,${-1.4 * r}L${1.4 * r},0L0,${1.4 * r}L${-1.4 * r},0Z`,
  (r) => `M0,${1.3 * r}L${1.2 * r},${-0.9 * r}H${-1.2 * r}Z`,
  (r) => `M${-r},${-r}L${r},${r}M${r},${-r}L${-r},${r}`,
  (r) => `M0,${-1.2 * r}V${1.2 * r}M${-1.2 * r},0H${1.2 * r}`,
  (r) => `M${-1.3 * r},0L${-0.5 * r},${-1.1 * r}H${0.5 * r}L${1.3 * r},0L${0.5 * r},${1.1 * r}H${-0.5 * r}Z`,
];
const DASHES = ["", "7 4", "2 3", "9 3 2 3", "12 3 2 3 2 3"];
const number2 = (x) => x.toFixed(2);

/** The look of a curve: `colour` and `dash` count from 0. */
const marker = (style, r) => draw("path", {
  d: MARKERS[style.colour % MARKERS.length](r),
  class: `marker c${style.colour % 8}${[5, 6].includes(style.colour % MARKERS.length) ? " open" : ""}`,
});

/**
 * A graph in `host`. `spec` gives
 *   x, y: { label, unit, log, categories, zero }
 *   series: [{ key, label, style, line, bare, points: [{ x, y, title, simulation }], slope, fit }]
 *   front: points of the Pareto front, or nothing
 *   name: what it shows, for readers of the screen
 */
function chart(host, spec, hidden, pick) {
  host.replaceChildren();
  const figure = make("div", { class: "drawing" });
  const tip = make("div", { class: "tip", hidden: true });
  const said = make("div", { class: "unseen", "aria-live": "polite" });
  const legend = make("div", { class: "legend", role: "group", "aria-label": "Curves" });
  figure.append(tip, said);
  host.append(figure, legend);
  let strong = null;

  const redraw = () => {
    figure.querySelector("svg")?.remove();
    const width = Math.max(280, figure.clientWidth);
    const height = Math.round(Math.min(460, Math.max(270, width * 0.56)));
    figure.prepend(drawing(spec, width, height, hidden, strong, { tip, said, pick }));
  };
  const emphasise = (key) => {
    strong = key;
    figure.querySelectorAll("g.series").forEach((g) => g.classList.toggle("weak", key !== null && g.dataset.key !== key));
    figure.querySelectorAll(".fit").forEach((g) => g.classList.toggle("seen", g.dataset.key === key));
  };
  for (const s of spec.series) {
    const swatch = draw("svg", { width: 34, height: 14, "aria-hidden": "true" },
      draw("path", { d: "M2,7H32", class: `line c${s.style.colour % 8}${s.closed ? " closed" : ""}`, "stroke-dasharray": DASHES[s.style.dash % DASHES.length] }));
    if (!s.bare) {
      const sign = marker(s.style, 4);
      sign.setAttribute("transform", "translate(17,7)");
      swatch.append(sign);
    }
    const button = make("button", { type: "button", "aria-pressed": String(!hidden.has(s.key)), title: "click: show or hide; double click: this one alone" },
      swatch, make("span", {}, s.label), s.slope ? make("span", { class: "slope" }, `slope ${formatted(s.slope.slope, 3)}`) : null);
    const pressed = () => legend.querySelectorAll("button").forEach((b, k) => b.setAttribute("aria-pressed", String(!hidden.has(spec.series[k].key))));
    button.addEventListener("click", () => {
      if (hidden.has(s.key)) hidden.delete(s.key);
      else hidden.add(s.key);
      pressed();
      redraw();
    });
    button.addEventListener("dblclick", () => {
      const alone = spec.series.every((t) => t.key === s.key || hidden.has(t.key));
      hidden.clear();
      if (!alone) spec.series.forEach((t) => t.key !== s.key && hidden.add(t.key));
      pressed();
      redraw();
    });
    for (const [event, key] of [["pointerenter", s.key], ["focus", s.key], ["pointerleave", null], ["blur", null]]) {
      button.addEventListener(event, () => emphasise(key));
    }
    legend.append(button);
  }
  if (spec.front?.length) {
    const swatch = draw("svg", { width: 34, height: 14, "aria-hidden": "true" }, draw("path", { d: "M2,7H32", class: "front" }));
    legend.append(make("span", { class: "entry" }, swatch, "Pareto front"));
  }
  redraw();
  let before = figure.clientWidth;
  const observer = new ResizeObserver(() => {
    if (!host.isConnected || !figure.isConnected) observer.disconnect();
    else if (figure.clientWidth !== before) {
      before = figure.clientWidth;
      redraw();
    }
  });
  observer.observe(figure);
}

/** Whether a point can be drawn on these axes. */
const drawable = (spec) => (p) =>
  (spec.x.categories || Number.isFinite(p.x)) && Number.isFinite(p.y) && !(spec.x.log && p.x <= 0) && !(spec.y.log && p.y <= 0);

function drawing(spec, width, height, hidden, strong, { tip, said, pick }) {
  const series = spec.series.filter((s) => !hidden.has(s.key)).map((s) => ({ ...s, points: s.points.filter(drawable(spec)) }));
  const points = series.flatMap((s) => s.points);
  const box = { left: 72, right: width - 14, top: 12, bottom: height - 52 };
  const y = scale(points.map((p) => p.y), { ...spec.y, from: box.bottom, to: box.top, ticks: Math.floor((box.bottom - box.top) / 42) });
  const x = scale(points.map((p) => p.x), { ...spec.x, from: box.left, to: box.right, ticks: Math.floor((box.right - box.left) / 78) });
  const svg = draw("svg", {
    viewBox: `0 0 ${width} ${height}`, width, height, tabindex: 0, role: "group",
    "aria-label": `${spec.name}. ${series.length} curves, ${points.length} points. Arrow keys go from point to point.`,
  });
  svg.append(axes(spec, x, y, box, width, height));
  if (!points.length) {
    svg.append(draw("text", { x: width / 2, y: (box.top + box.bottom) / 2, class: "nothing", "text-anchor": "middle" }, "no values to show"));
    return svg;
  }
  const front = (spec.front ?? []).filter(drawable(spec));
  if (front.length > 1) svg.append(draw("path", { d: path(front, x, y), class: "front" }));
  for (const s of series) {
    const group = draw("g", { class: `series${strong !== null && strong !== s.key ? " weak" : ""}` });
    group.dataset.key = s.key;
    if (s.line && s.points.length > 1) {
      group.append(draw("path", { d: path(s.points, x, y), class: `line c${s.style.colour % 8}${s.closed ? " closed" : ""}`, "stroke-dasharray": DASHES[s.style.dash % DASHES.length] }));
    }
    if (!s.bare) {
      const few = s.points.length * series.length < 400;
      for (const p of s.points) {
        const sign = marker(s.style, few ? 3.6 : 2.4);
        sign.setAttribute("transform", `translate(${number2(x.place(p.x))},${number2(y.place(p.y))})`);
        group.append(sign);
      }
    }
    svg.append(group);
    if (s.slope && s.points.length) {
      const ends = [s.points[0], s.points.at(-1)].map((p) => ({ x: p.x, y: s.slope.at(p.x) }));
      const fit = draw("path", { d: path(ends, x, y), class: "fit" });
      fit.dataset.key = s.key;
      svg.append(fit);
    }
  }
  for (const p of front) svg.append(draw("circle", { cx: number2(x.place(p.x)), cy: number2(y.place(p.y)), r: 7, class: "on-front" }));
  values(svg, spec, series, x, y, { tip, said, pick, width });
  return svg;
}

const path = (points, x, y) => points.map((p, k) => `${k ? "L" : "M"}${number2(x.place(p.x))},${number2(y.place(p.y))}`).join("");

function axes(spec, x, y, box, width, height) {
  const group = draw("g", { class: "axes", "aria-hidden": "true" });
  for (const tick of y.ticks) {
    const at = number2(y.place(tick));
    group.append(draw("path", { d: `M${box.left},${at}H${box.right}`, class: tick === 0 ? "grid zero" : "grid" }));
    group.append(draw("text", { x: box.left - 8, y: at, dy: "0.32em", "text-anchor": "end" }, y.text(tick)));
  }
  // Labels of categories that would touch each other are left out, every second, third, ….
  const room = (box.right - box.left) / Math.max(x.ticks.length, 1);
  const longest = Math.max(0, ...x.ticks.map((t) => x.text(t).length)) * 6.5 + 8;
  const every = Math.max(1, Math.ceil(longest / room));
  x.ticks.forEach((tick, k) => {
    const at = number2(x.place(tick));
    group.append(draw("path", { d: `M${at},${box.top}V${box.bottom}`, class: tick === 0 ? "grid zero" : "grid" }));
    if (k % every === 0) group.append(draw("text", { x: at, y: box.bottom + 18, "text-anchor": "middle" }, x.text(tick)));
  });
  group.append(draw("path", { d: `M${box.left},${box.top}V${box.bottom}H${box.right}`, class: "frame" }));
  group.append(draw("text", { x: (box.left + box.right) / 2, y: height - 10, class: "title", "text-anchor": "middle" }, withUnit(spec.x.label, spec.x.unit)));
  const middle = (box.top + box.bottom) / 2;
  group.append(draw("text", { x: 14, y: middle, class: "title", "text-anchor": "middle", transform: `rotate(-90 14 ${middle})` }, withUnit(spec.y.label, spec.y.unit)));
  return group;
}

/** Values under the pointer, and by arrow keys: left and right along a curve, up and down from curve to curve. */
function values(svg, spec, series, x, y, { tip, said, pick, width }) {
  const ring = draw("circle", { r: 6.5, class: "ring", visibility: "hidden" });
  svg.append(ring);
  const drawn = series.filter((s) => s.points.length);
  let at = { s: 0, p: -1 };
  const show = (s, p) => {
    const [px, py] = [x.place(p.x), y.place(p.y)];
    ring.setAttribute("cx", number2(px));
    ring.setAttribute("cy", number2(py));
    ring.setAttribute("visibility", "visible");
    const line = (axis, value) => `${axis.label}: ${axis.categories ? shown(value) : formatted(value, 5)}${axis.unit ? ` ${printedUnit(axis.unit)}` : ""}`;
    const lines = [line(spec.x, p.x), line(spec.y, p.y), ...(p.notes ?? [])];
    tip.replaceChildren(make("b", {}, p.title ?? s.label), ...lines.map((text) => make("div", {}, text)));
    tip.hidden = false;
    const left = Math.min(Math.max(4, px + 14), Math.max(4, width - tip.offsetWidth - 4));
    tip.style.left = `${left === px + 14 || px < width / 2 ? left : Math.max(4, px - tip.offsetWidth - 14)}px`;
    tip.style.top = `${Math.max(2, py - tip.offsetHeight - 12)}px`;
    return `${p.title ?? s.label}; ${lines.join("; ")}`;
  };
  const hide = () => {
    tip.hidden = true;
    ring.setAttribute("visibility", "hidden");
  };
  const nearest = (event) => {
    const frame = svg.getBoundingClientRect();
    const [mx, my] = [event.clientX - frame.left, event.clientY - frame.top];
    let best = { distance: 45 };
    drawn.forEach((s, k) => s.points.forEach((p, n) => {
      const distance = Math.hypot(x.place(p.x) - mx, y.place(p.y) - my);
      if (distance < best.distance) best = { distance, s: k, p: n };
    }));
    return best.s === undefined ? null : best;
  };
  svg.addEventListener("pointermove", (event) => {
    const found = nearest(event);
    if (!found) return hide();
    at = found;
    show(drawn[at.s], drawn[at.s].points[at.p]);
  });
  svg.addEventListener("pointerleave", hide);
  svg.addEventListener("blur", hide);
  const chosen = () => drawn[at.s]?.points[at.p];
  svg.addEventListener("click", (event) => {
    if (nearest(event) && chosen()?.simulation !== undefined) pick?.(chosen().simulation);
  });
  svg.addEventListener("keydown", (event) => {
    const step = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowDown: [1, 0], ArrowUp: [-1, 0] }[event.key];
    if (event.key === "Escape") hide();
    if (event.key === "Enter" && chosen()?.simulation !== undefined) pick?.(chosen().simulation);
    if (!step || !drawn.length) return;
    event.preventDefault();
    const s = (at.s + step[0] + drawn.length) % drawn.length;
    at = { s, p: Math.min(Math.max(at.p + step[1], 0), drawn[s].points.length - 1) };
    said.textContent = show(drawn[s], drawn[s].points[at.p]);
  });
}
