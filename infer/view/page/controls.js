// Mouse, touch and keys: they move the camera or the selected object.
import { dolly, fly, look, lookAt, meetPlane, orbit, spanAtTarget } from "./camera.js";
import { add, length, scale, sub } from "./vector.js";
import { corners, foot } from "./store.js";

const CLICK_PIXELS = 5;
const TURN_PER_HEIGHT = Math.PI;    // radians for a drag as long as the picture is high
const KEY_LOOK = 1.2;               // radians a second
const FLIGHTS = { KeyW: [0, 0, 1], KeyS: [0, 0, -1], KeyA: [-1, 0, 0], KeyD: [1, 0, 0],
                  KeyQ: [0, -1, 0], KeyE: [0, 1, 0] };
const LOOKS = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class Controls {
  /** @param actions  {camera(camera), pick(x, y), place(object, {move}, gesture), key(event)} */
  constructor(store, picture, actions) {
    Object.assign(this, { store, picture, actions });
    this.pointers = new Map();
    this.keys = new Set();
    this.drag = null;
    this.gestures = 0;
    this.lastMoved = -1e9;
    const surface = picture.overlay;
    surface.addEventListener("pointerdown", (event) => this.down(event));
    surface.addEventListener("pointermove", (event) => this.move(event));
    surface.addEventListener("pointerup", (event) => this.up(event));
    surface.addEventListener("pointercancel", (event) => this.up(event, true));
    surface.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    surface.addEventListener("contextmenu", (event) => event.preventDefault());
    addEventListener("keydown", (event) => this.keyDown(event));
    addEventListener("keyup", (event) => this.keys.delete(event.code));
    addEventListener("blur", () => this.keys.clear());
  }

  /** Whether a hand is on the camera, which then is ahead of the pictures. */
  active() {
    return this.pointers.size > 0 || this.keys.size > 0 || performance.now() - this.lastMoved < 250;
  }

  newGesture() {
    return ++this.gestures;
  }

  at(event) {
    const box = this.picture.overlay.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  }

  set(camera) {
    this.lastMoved = performance.now();
    this.actions.camera(camera);
  }

  down(event) {
    if (!this.store.camera) return;
    this.picture.viewport.focus({ preventScroll: true });
    this.picture.overlay.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    const [x, y] = this.at(event);
    if (this.pointers.size > 1) {
      this.drag = { kind: "pinch" };
    } else if (event.button === 0 && !event.shiftKey && this.picture.isOnSelection(x, y)) {
      this.drag = this.objectDrag(x, y);
    } else {
      const kind = event.button === 2 ? "look" : event.button === 1 || event.shiftKey ? "pan" : "orbit";
      this.drag = { kind };
    }
    Object.assign(this.drag, { x, y, startX: event.clientX, startY: event.clientY, still: true });
    this.picture.overlay.classList.add("dragging");
  }

  /** Remembers what a drag of the selected object begins with. */
  objectDrag(x, y) {
    const object = this.store.selected();
    const grip = this.grip(object, x, y);
    return { kind: "object", object: object.object, from: [...object.move], grip,
             gesture: this.newGesture() };
  }

  /** The height at which the pointer holds an object: that of its middle. */
  grip(object, x, y) {
    const box = corners(object);
    const middle = scale(box.reduce(add), 1 / 8);
    const camera = this.store.header.camera;
    return { middle, floor: meetPlane(camera, this.picture.aspect, x, y, middle, [0, 1, 0], 100) };
  }

  move(event) {
    const last = this.pointers.get(event.pointerId);
    if (!last) {
      const [x, y] = this.at(event);
      this.picture.overlay.classList.toggle("over-object", this.picture.isOnSelection(x, y));
      return;
    }
    const dx = event.clientX - last[0], dy = event.clientY - last[1];
    const before = [...this.pointers.values()];
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    const drag = this.drag;
    if (!drag) return;
    const far = Math.hypot(event.clientX - drag.startX, event.clientY - drag.startY);
    if (drag.still && far < CLICK_PIXELS) {
      this.pointers.set(event.pointerId, last);
      return;
    }
    drag.still = false;
    if (drag.kind === "object") return this.dragObject(event);
    const height = this.picture.overlay.clientHeight;
    const camera = this.store.camera, turn = TURN_PER_HEIGHT / height;
    if (drag.kind === "orbit") this.set(orbit(camera, -dx * turn, -dy * turn));
    if (drag.kind === "look") this.set(look(camera, dx * turn * 0.5, dy * turn * 0.5));
    if (drag.kind === "pan") this.pan(dx, dy, height);
    if (drag.kind === "pinch" && before.length === 2) this.pinch(before, height);
  }

  pan(dx, dy, height) {
    const metres = spanAtTarget(this.store.camera) / height;
    this.set(fly(this.store.camera, -dx * metres, dy * metres, 0));
  }

  pinch(before, height) {
    const after = [...this.pointers.values()];
    const span = (p) => Math.max(1, Math.hypot(p[0][0] - p[1][0], p[0][1] - p[1][1]));
    const middle = (p, i) => (p[0][i] + p[1][i]) / 2;
    const metres = spanAtTarget(this.store.camera) / height;
    const shifted = fly(this.store.camera, -(middle(after, 0) - middle(before, 0)) * metres,
                        (middle(after, 1) - middle(before, 1)) * metres, 0);
    this.set(dolly(shifted, span(before) / span(after)));
  }

  dragObject(event) {
    const drag = this.drag, [x, y] = this.at(event);
    const camera = this.store.header.camera, aspect = this.picture.aspect;
    let by = null;
    if (event.altKey) {
      const away = sub(camera.origin, drag.grip.middle);
      const wall = [away[0], 0, away[2]];
      const start = meetPlane(camera, aspect, drag.x, drag.y, drag.grip.middle, wall);
      const now = meetPlane(camera, aspect, x, y, drag.grip.middle, wall);
      if (start && now) by = [0, now[1] - start[1], 0];
    } else if (drag.grip.floor) {
      const now = meetPlane(camera, aspect, x, y, drag.grip.middle, [0, 1, 0], 100);
      if (now) by = [now[0] - drag.grip.floor[0], 0, now[2] - drag.grip.floor[2]];
    }
    const place = this.store.placeOf("object", drag.object);  // another page may have removed it
    if (by && place >= 0) this.actions.place(place, { move: add(drag.from, by) }, drag.gesture);
  }

  up(event, cancelled = false) {
    if (!this.pointers.delete(event.pointerId)) return;
    const drag = this.drag;
    if (this.pointers.size > 0) return;
    this.drag = null;
    this.picture.overlay.classList.remove("dragging");
    if (drag && drag.still && drag.kind !== "pinch" && !cancelled) this.actions.pick(drag.x, drag.y);
  }

  wheel(event) {
    event.preventDefault();
    if (!this.store.camera) return;
    const lines = event.deltaMode === 1 ? 30 : 1;
    const steps = Math.max(-120, Math.min(120, event.deltaY * lines));
    this.set(dolly(this.store.camera, Math.exp(steps * 0.0016)));
  }

  keyDown(event) {
    const typing = /^(number|search|text|select-one)$/.test(event.target.type ?? "");
    if (typing || document.querySelector("dialog[open]")) return;
    const flies = !event.ctrlKey && !event.metaKey &&
      (event.code in FLIGHTS || (event.code in LOOKS && event.target.type !== "range"));
    if (!flies) return this.actions.key(event);
    event.preventDefault();
    if (this.keys.size === 0) {
      this.frameTime = performance.now();
      requestAnimationFrame(() => this.flight());
    }
    this.keys.add(event.code);
    this.fast = event.shiftKey;
  }

  /** Moves as long as a key is held, by the time since the last frame. */
  flight() {
    if (this.keys.size === 0 || !this.store.camera) return;
    const now = performance.now();
    const seconds = Math.min(0.1, (now - this.frameTime) / 1000);
    this.frameTime = now;
    const scene = this.store.scene;
    const extent = scene ? length(sub(scene.high, scene.low)) : 5;
    const step = seconds * extent * (this.fast ? 0.5 : 0.18);
    let camera = this.store.camera;
    for (const key of this.keys) {
      if (key in FLIGHTS) camera = fly(camera, ...FLIGHTS[key].map((x) => x * step));
      else camera = look(camera, ...LOOKS[key].map((x) => x * KEY_LOOK * seconds));
    }
    this.set(camera);
    requestAnimationFrame(() => this.flight());
  }

  /** Looks at the selected object. */
  focusSelection() {
    const object = this.store.selected();
    if (!object || !this.store.camera) return;
    const size = length(sub(object.high, object.low)) * object.scale;
    const middle = add(add(foot(object), object.move),
                       [0, (object.scale * (object.high[1] - object.low[1])) / 2, 0]);
    this.set(lookAt(this.store.camera, middle, size));
  }
}
