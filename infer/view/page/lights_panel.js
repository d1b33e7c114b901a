// The list of lights: a switch, a slider and a color for each.
import { chroma, fromHex, toHex } from "./color.js";
import { byId, changed, make, markBusy, setIdle, short } from "./dom.js";

const MOST_GAIN = 3;

export class LightsPanel {
  /** @param actions  {edit(setting, gesture), add(kind), remove(light), newGesture()} */
  constructor(store, actions) {
    Object.assign(this, { store, actions });
    this.pane = byId("lights");
    this.rows = [];
    const button = (kind, text) => make("button", { textContent: text, "data-add": kind,
      title: "In front of the camera", onclick: () => actions.add(kind) });
    this.adding = make("div", { className: "pair" },
      button("point", "Add a point light"), button("spot", "Add a spot light"));
    store.on("scene", () => this.build());
    store.on("edits", () => this.refresh());
  }

  build() {
    const { lights } = this.store.scene;
    if (!changed(this, lights)) return this.refresh();
    this.rows = lights.map((_, index) => this.row(index));
    this.pane.replaceChildren(...this.rows.map((row) => row.element));
    if (lights.length === 0) {
      this.pane.append(make("p", { className: "muted", textContent: "Nothing in this scene emits light." }));
    }
    this.pane.append(this.adding);
    return this.refresh();
  }

  row(index) {
    const light = () => this.store.scene.lights[index];
    let gesture = 0;
    const send = (change, ends) => {
      gesture ||= this.actions.newGesture();
      Object.assign(light(), change);
      const { light: number, gain, color, position, direction } = light();
      this.actions.edit({ light: number, gain, color, ...(position ? { position } : {}),
                          ...(direction ? { direction } : {}) }, gesture);
      if (ends) gesture = 0;
      this.refreshRow(index);
    };
    let before = 1;
    const on = make("input", { type: "checkbox", title: "On or off", onchange: () => {
      if (!on.checked) before = light().gain || 1;
      send({ gain: on.checked ? before : 0 }, true);
    } });
    const slider = make("input", { type: "range", min: 0, max: MOST_GAIN, step: 0.01,
      oninput: () => send({ gain: Number(slider.value) }), onchange: () => { gesture = 0; } });
    const percent = make("input", { type: "number", min: 0, step: 5, title: "Percent of the file's brightness",
      onchange: () => {
        const value = Number(percent.value) / 100;
        if (Number.isFinite(value) && value >= 0) send({ gain: Math.min(value, 1e4) }, true);
      } });
    const color = make("input", { type: "color", title: "Color",
      oninput: () => send({ color: chroma(fromHex(color.value)) }), onchange: () => { gesture = 0; } });
    const { name, sort } = light();
    const label = make("span", { className: "name", textContent: name, title: `${name} (${sort})` });
    for (const input of [slider, percent, color]) {
      markBusy(input);
      input.setAttribute("aria-label", `${input.title || "Brightness"}: ${name}`);
    }
    on.setAttribute("aria-label", `On: ${name}`);
    const remove = make("button", { className: "remove", textContent: "×", title: "Remove this light",
      "aria-label": `Remove: ${name}`, onclick: () => this.actions.remove(light().light) });
    const element = make("div", { className: "row light" }, on, label, percent, color, remove, slider);
    const fields = [];
    if (light().position) fields.push(this.axes("position", "metres", light, send));
    if (light().direction) fields.push(this.axes("direction", "of its light's way", light, send));
    for (const { inputs } of fields) element.append(make("div", { className: "triple" }, ...inputs));
    return { element, on, slider, percent, color, fields };
  }

  /** Number fields for where a light stands, or which way it shines. */
  axes(key, unit, light, send) {
    const inputs = ["x", "y", "z"].map((axis, i) => {
      const input = make("input", { type: "number", step: 0.1, title: `${axis}, ${unit}`, onchange: () => {
        const value = [...light()[key]];
        value[i] = Number(input.value);
        const fine = value.every(Number.isFinite) && (key === "position" || value.some((v) => v !== 0));
        if (fine) send({ [key]: value }, true);
      } });
      markBusy(input);
      return input;
    });
    return { key, inputs };
  }

  refresh() {
    this.rows.forEach((_, index) => this.refreshRow(index));
  }

  refreshRow(index) {
    const row = this.rows[index], light = this.store.scene.lights[index];
    row.on.checked = light.gain > 0;
    row.element.classList.toggle("off", light.gain === 0);
    setIdle(row.slider, light.gain);
    setIdle(row.percent, short(100 * light.gain, 1));
    setIdle(row.color, toHex(light.color));
    for (const { key, inputs } of row.fields) {
      inputs.forEach((input, i) => setIdle(input, short(light[key][i])));
    }
  }
}
