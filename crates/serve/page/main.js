// The page: messages become a picture, pointer and keys become commands.
//
// Nothing is drawn unless something changed, and a new frame is asked for when the last one has been drawn: a page that
// nobody sees costs the server nothing.

import { connect } from "./connection.js";
import { Picture } from "./picture.js";
import { add, dot, fit, makeCamera, place, length } from "./camera.js";
import { listen } from "./pointer.js";
import { pick } from "./pick.js";
import * as panel from "./panel.js";
import { showNames, showRange } from "./legend.js";
import { withUnit } from "./numbers.js";

const byId = (id) => document.getElementById(id);
const canvas = byId("view");
const main = document.querySelector("main");
const legend = byId("legend");

let picture = null;
let camera = null;
let you = 0;
let colour = "element";
/** The newest frame, and whether it has been drawn. */
let frame = null;
let owed = 0;
let scheduled = false;
let range = null;

function plane() {
  const { axis, share, flip } = panel.cut();
  if (axis < 0) return null;
  const [low, high] = picture.bounds();
  const normal = [0, 0, 0];
  normal[axis] = flip ? -1 : 1;
  return { normal, offset: normal[axis] * (low[axis] + share * (high[axis] - low[axis])) };
}

/** Values of the nodes and their range, for what colours show; `null` for groups and for what has not come yet. */
function numbers() {
  if (colour === "displacement") {
    const { rest } = picture.arrays;
    const { positions } = frame.arrays;
    const values = new Float32Array(picture.count);
    let high = 0;
    for (let n = 0; n < values.length; n++) {
      const k = 3 * n;
      values[n] = Math.hypot(positions[k] - rest[k], positions[k + 1] - rest[k + 1], positions[k + 2] - rest[k + 2]);
      high = Math.max(high, values[n]);
    }
    return { values, range: [0, high] };
  }
  const { field } = frame.header;
  return field && field.key === colour ? { values: frame.arrays.values, range: [field.low, field.high] } : null;
}

function takeFrame() {
  const shown = numbers();
  picture.setPositions(frame.arrays.positions, shown?.values);
  range = shown?.range ?? null;
  const { name, unit } = picture.scene.colours.find((c) => c.key === colour);
  if (range) showRange(legend, name, unit, range, picture.scene.map);
}

function draw() {
  scheduled = false;
  if (!picture?.scene) return;
  camera.aspect = picture.resize();
  const pulls = frame?.header.pulls ?? [];
  picture.draw(camera, { plane: plane(), edges: byId("edges").checked, range, pulls });
  showForce(pulls.find((p) => p.hand === you));
  while (owed > 0) {
    send({ do: "more" });
    owed--;
  }
}

/** The force of this page's hand, beside it. */
function showForce(pull) {
  const label = byId("force");
  label.hidden = !pull;
  if (!pull) return;
  const [x, y] = place(camera, pull.target);
  label.textContent = withUnit(length(pull.force), "N");
  label.style.transform = `translate(${((x + 1) / 2) * canvas.clientWidth + 12}px, ${((1 - y) / 2) * canvas.clientHeight - 30}px)`;
}

function redraw() {
  if (scheduled) return;
  scheduled = true;
  requestAnimationFrame(draw);
}

function choose(key) {
  show(key);
  send({ do: "colour", by: key });
}

function show(key) {
  colour = key;
  legend.replaceChildren();
  delete legend.dataset.range;
  const grouping = picture.scene.groupings.indexOf(key);
  if (grouping >= 0) {
    picture.setGroups(grouping);
    showNames(legend, picture.scene.legends[key]);
  }
  if (frame) takeFrame();
  redraw();
}

function complain(error) {
  main.classList.add("lost");
  byId("status").textContent = error.message;
}

const send = connect({
  welcome(number) {
    you = number;
  },
  scene(message) {
    try {
      picture ??= new Picture(canvas);
      picture.setScene(message);
    } catch (error) {
      complain(error);
      return;
    }
    // Whoever comes back sees the body from where it was seen.
    if (!camera || camera.title !== message.header.title) {
      camera = makeCamera(...picture.bounds(), message.header.up);
      camera.title = message.header.title;
      camera.aspect = picture.resize();
      fit(camera, ...picture.bounds());
    }
    frame = null;
    owed = 0;
    choose(panel.showScene(message.header));
  },
  frame(message) {
    if (!picture?.scene) return;
    frame = message;
    owed++;
    takeFrame();
    panel.showFrame(message.header, you);
    document.body.dataset.step = message.header.step;
    redraw();
  },
  error(text) {
    panel.problem(text, true);
  },
  state(connected, text) {
    main.classList.toggle("lost", !connected);
    byId("status").textContent = text;
    if (!connected) byId("force").hidden = true;
  },
});

const fitAll = () => {
  if (!camera) return;
  fit(camera, ...picture.bounds());
  redraw();
};

const acts = panel.bind({ send, redraw, fit: fitAll, colour: choose });

let target = null;
listen({
  canvas,
  camera: () => camera,
  redraw,
  pick(sight) {
    const hidden = plane();
    const visible = (point) => !hidden || dot(hidden.normal, point) <= hidden.offset;
    return pick(picture.positions, picture.arrays.triangles, sight, visible);
  },
  begin({ nodes, weights, point }) {
    panel.problem("", true);
    send({ do: "pull-begin", nodes, weights, target: point, stiffness: panel.stiffness() });
  },
  move(point) {
    // Many mice report more often than pictures are drawn.
    if (!target) {
      requestAnimationFrame(() => {
        if (target) send({ do: "pull-move", target });
        target = null;
      });
    }
    target = add(point, [0, 0, 0]);
  },
  end() {
    target = null;
    send({ do: "pull-end" });
  },
  keys: { " ": acts.play, ".": acts.step, r: acts.reset, f: fitAll, e: acts.edges },
});
new ResizeObserver(redraw).observe(canvas);
