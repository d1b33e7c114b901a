// What the page knows: the scene as the server told of it, the view, and what is selected.

export class Store extends EventTarget {
  constructor() {
    super();
    this.client = 0;
    this.scene = null;    // {name, lights, materials, objects, cameras, outputs, low, high}
    this.camera = null;   // that of the hand: ahead of the picture while one moves
    this.header = null;   // of the picture that is shown
    this.object = -1;     // selected
    this.material = -1;   // that was clicked on
    this.undo = this.redo = false;
  }

  tell(what, detail) {
    this.dispatchEvent(new CustomEvent(what, { detail }));
  }

  on(what, listener) {
    this.addEventListener(what, (event) => listener(event.detail));
  }

  setScene(message) {
    this.scene = message;
    this.undo = message.undo;
    this.redo = message.redo;
    if (this.object >= message.objects.length) this.object = -1;
    if (this.material >= message.materials.length) this.material = -1;
    this.tell("scene");
  }

  /** Takes over edits that were made, by this page or another. */
  takeEdits(message) {
    this.undo = message.undo;
    this.redo = message.redo;
    if (message.client !== this.client) {
      for (const edit of message.edits) this.put(edit);
    }
    this.tell("edits", message);
  }

  put(edit) {
    const list = { light: "lights", material: "materials", object: "objects" }[edit.kind];
    Object.assign(this.scene[list][edit[edit.kind]], edit);
  }

  select(object, material = -1) {
    this.object = object;
    this.material = material;
    this.tell("selection");
  }

  selected() {
    return this.object >= 0 ? this.scene.objects[this.object] : null;
  }
}

/** What an object turns about: the middle of its underside, where the file has it. */
export function foot(object) {
  return [(object.low[0] + object.high[0]) / 2, object.low[1], (object.low[2] + object.high[2]) / 2];
}

/** The eight corners of an object's box where it stands now. */
export function corners(object) {
  const base = foot(object), angle = (object.turn * Math.PI) / 180;
  const c = object.scale * Math.cos(angle), s = object.scale * Math.sin(angle);
  const out = [];
  for (let i = 0; i < 8; ++i) {
    const p = [0, 1, 2].map((axis) => (i & (1 << axis) ? object.high : object.low)[axis] - base[axis]);
    const turned = [c * p[0] + s * p[2], object.scale * p[1], -s * p[0] + c * p[2]];
    out.push(turned.map((x, axis) => base[axis] + object.move[axis] + x));
  }
  return out;
}
