// The controls beside the picture: what they show, and which commands they send.

import { plain, withUnit } from "./numbers.js";
import { length } from "./camera.js";

const by = (id) => document.getElementById(id);

/** Changes a text only when it is another one: assistive technology reads what changes. */
function show(id, text) {
  const place = by(id);
  if (place.textContent !== text) place.textContent = text;
}

/** A number in its field, unless somebody is typing there. */
function fill(id, value) {
  const input = by(id);
  const text = value == null ? "" : String(Number(value.toPrecision(6)));
  if (document.activeElement !== input && input.value !== text) input.value = text;
}

/** Stiffness of the spring in the hand in N/m. */
export const stiffness = () => 10 ** Number(by("spring").value);

/** The chosen cut: axis from 0 to 2 or −1, share of the body's length, and which side is hidden. */
export function cut() {
  return { axis: ["x", "y", "z"].indexOf(by("axis").value), share: Number(by("share").value), flip: by("flip").checked };
}

/** Binds the controls: `send(command)`, `redraw()`, `fit()`, `colour(key)`. */
export function bind({ send, redraw, fit, colour }) {
  const playing = () => by("play").getAttribute("aria-pressed") === "true";
  const play = () => send({ do: playing() ? "pause" : "play" });
  const step = () => send({ do: "step" });
  const reset = () => send({ do: "reset" });
  for (const [id, act] of [["play", play], ["step", step], ["reset", reset], ["fit", fit]]) by(id).onclick = act;
  by("colour").onchange = () => colour(by("colour").value);
  by("spring").oninput = () => show("spring-text", withUnit(stiffness(), "N/m"));
  for (const id of ["axis", "share", "flip", "edges"]) by(id).oninput = redraw;
  const gravity = ["gravity-x", "gravity-y", "gravity-z"];
  for (const id of gravity) {
    by(id).onchange = () => {
      const value = gravity.map((g) => by(g).valueAsNumber);
      if (value.every(Number.isFinite)) send({ do: "gravity", value });
    };
  }
  for (const id of ["damping", "time-step"]) {
    by(id).onchange = () => {
      const value = by(id).valueAsNumber;
      if (Number.isFinite(value)) send({ do: id, value });
    };
  }
  by("speed").onchange = () => send({ do: "speed", factor: by("speed").value === "max" ? null : Number(by("speed").value) });
  return { play, step, reset, edges: () => by("edges").click() };
}

/** What a scene brings: its title, choices of colours, and a spring that fits. */
export function showScene({ title, colours, stiffness }) {
  show("title", title || "Souple");
  document.title = title ? `${title} – Souple` : "Souple";
  const select = by("colour");
  const before = select.value;
  select.replaceChildren(...colours.map(({ key, name, unit }) => new Option(unit ? `${name} (${unit})` : name, key)));
  select.value = colours.some((c) => c.key === before) ? before : "element";
  if (!by("spring-text").textContent) {
    by("spring").value = String(Math.log10(stiffness));
    by("spring").oninput();
  }
  return select.value;
}

/** What a frame says. */
export function showFrame(header, you) {
  const button = by("play");
  if (button.getAttribute("aria-pressed") !== String(header.playing)) {
    button.setAttribute("aria-pressed", String(header.playing));
    button.textContent = header.playing ? "Pause" : "Play";
  }
  show("time", `${header.time.toFixed(3)} s`);
  show("steps", String(header.step));
  show("rate", header.playing ? plain(header.steps_per_second) : "–");
  show("cg", header.cg_iterations == null ? "–" : String(header.cg_iterations));
  const mine = header.pulls.find((p) => p.hand === you);
  show("pull", mine ? withUnit(length(mine.force), "N") : "–");
  show("clients", String(header.clients));
  fill("damping", header.damping);
  fill("time-step", header.time_step);
  ["x", "y", "z"].forEach((axis, k) => fill(`gravity-${axis}`, header.gravity?.[k]));
  const speed = header.speed == null ? "max" : String(header.speed);
  const select = by("speed");
  if (document.activeElement !== select && select.value !== speed) {
    if (![...select.options].some((o) => o.value === speed)) select.add(new Option(`${speed} × real time`, speed));
    select.value = speed;
  }
  show("warning", header.warning ?? "");
  by("warning").hidden = !header.warning;
  const inverted = header.inverted ? `${header.inverted} elements are inside out` : "";
  problem([header.error, inverted].filter(Boolean).join("; "));
}

let told = "";

/** Shows a problem; the empty text takes it away. */
export function problem(text, kept = false) {
  if (kept) told = text;
  const all = [told, text].filter((t, k) => t && !(k && t === told)).join("; ");
  show("problem", all);
  by("problem").hidden = !all;
}
