// What explains the colours: names, or a map over a range with its unit.

import { withUnit } from "./numbers.js";

const element = (name, props = {}) => Object.assign(document.createElement(name), props);

/** Groups by name; those that do not occur are none of the server's. */
export function showNames(legend, groups) {
  const list = element("ul");
  for (const { name, colour } of groups) {
    const item = element("li");
    const patch = element("i");
    patch.style.background = colour;
    item.append(patch, element("span", { textContent: name }));
    list.append(item);
  }
  legend.replaceChildren(list);
}

/** A map from low to high. Called with every frame: only what changed is touched. */
export function showRange(legend, name, unit, [low, high], map) {
  if (legend.dataset.range !== name) {
    const bar = element("div", { className: "bar" });
    bar.style.background = `linear-gradient(to right, ${map.join(", ")})`;
    const ends = element("div", { className: "ends" });
    ends.append(element("span"), element("span"));
    legend.replaceChildren(element("div", { textContent: name }), bar, ends);
    legend.dataset.range = name;
  }
  const [from, to] = legend.querySelectorAll(".ends span");
  for (const [end, value] of [[from, low], [to, high]]) {
    const text = withUnit(value, unit);
    if (end.textContent !== text) end.textContent = text;
  }
}
