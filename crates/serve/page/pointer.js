// What pointer and keys do: pull the body, turn, move and zoom the view.

import { add, axes, dot, pan, sight, turn, zoom } from "./camera.js";

/**
 * `world` has `canvas`, `camera()`, `pick(sight)`, `begin(hit)`, `move(target)`, `end()`, `redraw()` and `keys`, functions
 * by the key that calls them.
 */
export function listen(world) {
  const { canvas } = world;
  /** Pointers that are down: place in pixels. */
  const down = new Map();
  /** `null`, "turn", "move", two fingers and the view as it was, or the plane in which a spring is dragged. */
  let act = null;

  const sightAt = ({ clientX, clientY }) => {
    const box = canvas.getBoundingClientRect();
    const x = (2 * (clientX - box.left)) / box.width - 1;
    const y = 1 - (2 * (clientY - box.top)) / box.height;
    return sight(world.camera(), x, y);
  };

  /** Middle of two fingers from the picture's middle, and how far they are apart; both in heights of the picture. */
  const fingers = () => {
    const box = canvas.getBoundingClientRect();
    const [a, b] = [...down.values()];
    return {
      x: ((a[0] + b[0]) / 2 - box.left - box.width / 2) / box.height,
      y: ((a[1] + b[1]) / 2 - box.top - box.height / 2) / box.height,
      apart: Math.hypot(a[0] - b[0], a[1] - b[1]) / box.height || 1e-3,
    };
  };

  /** From now on the view follows two fingers. */
  const hold = () => {
    const camera = world.camera();
    return camera && { fingers: fingers(), target: camera.target, distance: camera.distance };
  };

  const letGo = () => {
    if (act?.normal) world.end();
    act = null;
  };

  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, [event.clientX, event.clientY]);
    letGo();
    if (down.size > 1) {
      act = hold();
      return;
    }
    act = event.button === 1 || event.shiftKey ? "move" : "turn";
    if (event.button !== 0 || event.shiftKey) return;
    const hit = world.camera() && world.pick(sightAt(event));
    if (!hit) return;
    // The hand moves in the plane of the picture, at the depth of what it took.
    act = { normal: axes(world.camera())[2], point: hit.point };
    world.begin(hit);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = down.get(event.pointerId);
    if (!before || !act || !world.camera()) return;
    const camera = world.camera();
    const height = canvas.clientHeight;
    const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
    down.set(event.pointerId, [event.clientX, event.clientY]);
    if (act.fingers) {
      // From the beginning each time, because one finger is told of after the other: what was between them stays there.
      const [first, now] = [act.fingers, fingers()];
      camera.target = act.target;
      camera.distance = act.distance;
      pan(camera, -first.x, -first.y);
      zoom(camera, first.apart / now.apart);
      pan(camera, now.x, now.y);
    } else if (act === "move") {
      pan(camera, dx / height, dy / height);
    } else if (act === "turn") {
      turn(camera, (-dx / height) * 4, (dy / height) * 4);
    } else {
      const { origin, direction } = sightAt(event);
      const distance = dot(add(act.point, origin, -1), act.normal) / dot(direction, act.normal);
      world.move(add(origin, direction, distance));
    }
    world.redraw();
  });
  for (const name of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(name, (event) => {
      if (!down.delete(event.pointerId)) return;
      letGo();
      if (down.size > 0) act = down.size === 1 ? "turn" : hold();
    });
  }
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    if (!world.camera()) return;
    // Lines and pages of some mice as pixels.
    const pixels = event.deltaY * [1, 30, 300][event.deltaMode];
    zoom(world.camera(), Math.exp(Math.max(-200, Math.min(200, pixels)) * 0.0015));
    world.redraw();
  }, { passive: false });

  const views = {
    ArrowLeft: (c) => turn(c, -0.08, 0), ArrowRight: (c) => turn(c, 0.08, 0),
    ArrowUp: (c) => turn(c, 0, 0.08), ArrowDown: (c) => turn(c, 0, -0.08),
    "+": (c) => zoom(c, 0.9), "=": (c) => zoom(c, 0.9), "-": (c) => zoom(c, 1 / 0.9),
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    // Whoever types, chooses or presses a button means that.
    const typing = event.target.closest("input, select");
    const pressing = event.target.closest("button, summary") && [" ", "Enter"].includes(event.key);
    if (typing || pressing) return;
    if (event.key === "Escape") return letGo();
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (views[key] && world.camera()) views[key](world.camera());
    else if (world.keys[key]) world.keys[key]();
    else return;
    event.preventDefault();
    world.redraw();
  });
}
