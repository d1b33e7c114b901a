// What the page knows: the scene as the server told of it, the view, and what is selected.

const LISTS = { light: "lights", material: "materials", object: "objects" };

export class Store extends EventTarget {
  constructor() {
    super();
    this.client = 0;
    // {name, lights, materials, objects, cameras, outputs, low, high}. Messages have the numbers in
    // the lists' entries (`light`, `material`, `object`); the page has places in the lists.
    this.scene = null;
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
    const object = this.selected()?.object;
    const material = this.scene?.materials[this.material]?.material;
    this.scene = message;
    this.undo = message.undo;
    this.redo = message.redo;
    this.object = this.placeOf("object", object);
    this.material = this.placeOf("material", material);
    this.tell("scene");
  }

  /** Where the light, material or object of a number stands in its list; -1 for none. */
  placeOf(kind, number) {
    return this.scene[LISTS[kind]].findIndex((entry) => entry[kind] === number);
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
    const entry = this.scene[LISTS[edit.kind]][this.placeOf(edit.kind, edit[edit.kind])];
    if (entry) Object.assign(entry, edit);
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
