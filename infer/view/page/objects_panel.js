// The list of objects, and where the selected one stands.
import { byId, changed, isStacked, make, markBusy, setIdle, short } from "./dom.js";
import { albedoInput } from "./materials_panel.js";
import { toHex } from "./color.js";
import { foot } from "./store.js";

export class ObjectsPanel {
  /**
   * @param actions  {place(object, change, gesture), material(setting, gesture), focus(), copy(),
   *                  remove(), newGesture()}
   */
  constructor(store, actions) {
    Object.assign(this, { store, actions });
    this.card = make("div", { className: "card" });
    this.search = make("input", { type: "search", placeholder: "Find an object", oninput: () => this.filter() });
    this.search.setAttribute("aria-label", "Find an object");
    this.list = make("div");
    byId("objects").append(this.card, this.search, this.list);
    store.on("scene", () => this.build());
    store.on("selection", () => this.buildCard());
    for (const event of ["edits", "placing"]) store.on(event, () => this.refresh());
  }

  build() {
    const { objects } = this.store.scene;
    if (changed(this, objects)) {
      this.list.replaceChildren(...objects.map((object, index) =>
        make("button", { className: "row object", onclick: () => this.store.select(index) },
          make("span", { className: "name", textContent: object.name, title: object.name }),
          make("span", { className: "tag", textContent: object.shines ? "light" : "" }))));
    }
    this.buildCard();
  }

  filter() {
    const wanted = this.search.value.trim().toLowerCase();
    this.store.scene.objects.forEach((object, index) => {
      this.list.children[index].hidden = !object.name.toLowerCase().includes(wanted);
    });
  }

  buildCard() {
    const { store, actions } = this;
    [...this.list.children].forEach((row, index) => row.classList.toggle("selected", index === store.object));
    const object = store.selected();
    this.inputs = null;
    this.card.hidden = !object;
    if (!object) return;
    const number = (label, step, change) => {
      const input = make("input", { type: "number", step, onchange: () => {
        const value = Number(input.value);
        if (Number.isFinite(value)) actions.place(store.object, change(value), actions.newGesture());
      } });
      markBusy(input);
      return { input, field: make("label", { className: "field" }, label, input) };
    };
    const axes = [0, 1, 2].map((axis) => number("xyz"[axis], 0.05, (value) => {
      const move = [...store.selected().move];
      move[axis] = value - foot(store.selected())[axis];
      return { move };
    }));
    const turn = number("turn, °", 5, (value) => ({ turn: wrap(value) }));
    const size = number("scale", 0.05, (value) => ({ scale: Math.min(100, Math.max(0.01, value)) }));
    const home = make("button", { textContent: "Put back", onclick: () =>
      actions.place(store.object, { move: [0, 0, 0], turn: 0, scale: 1 }, actions.newGesture()) });
    const focus = make("button", { textContent: "Look at it", title: "F", onclick: actions.focus });
    this.card.replaceChildren(
      make("h3", { textContent: object.name }),
      make("div", { className: "triple" }, ...axes.map((a) => a.field)),
      make("div", { className: "pair" }, turn.field, size.field),
      make("div", { className: "line" }, focus, home),
      make("div", { className: "line" },
        make("button", { textContent: "Copy", title: "Ctrl+D", onclick: actions.copy }),
        make("button", { textContent: "Remove", title: "Delete", onclick: actions.remove })));
    this.albedo = null;
    if (store.material >= 0) {
      this.albedo = albedoInput(store, store.material, actions.material, actions.newGesture);
      const { name } = store.scene.materials[store.material];
      this.card.append(make("div", { className: "line" },
        make("span", { className: "name", textContent: `Surface: ${name}`, title: name }), this.albedo));
    }
    this.inputs = { axes: axes.map((a) => a.input), turn: turn.input, size: size.input };
    this.refresh();
    // Where the panel stands below the picture, the picture is to stay in sight.
    if (!isStacked()) this.list.children[store.object].scrollIntoView({ block: "nearest" });
  }

  refresh() {
    const object = this.store.selected();
    if (!object || !this.inputs) return;
    const base = foot(object);
    this.inputs.axes.forEach((input, axis) => setIdle(input, short(base[axis] + object.move[axis])));
    setIdle(this.inputs.turn, short(object.turn, 1));
    setIdle(this.inputs.size, short(object.scale));
    if (this.albedo) setIdle(this.albedo, toHex(this.store.scene.materials[this.store.material].albedo));
  }
}

/** Degrees in (-180, 180]. */
export function wrap(degrees) {
  return degrees - 360 * Math.ceil((degrees - 180) / 360);
}
