// The list of lights: a switch, a slider and a color for each.
import { chroma, fromHex, toHex } from "./color.js";
import { byId, changed, make, markBusy, setIdle, short } from "./dom.js";

const MOST_GAIN = 3;

export class LightsPanel {
  /** @param edit  (setting, gesture) sends an edit of a light */
  constructor(store, edit, newGesture) {
    Object.assign(this, { store, edit, newGesture });
    this.pane = byId("lights");
    this.rows = [];
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
    return this.refresh();
  }

  row(index) {
    const light = () => this.store.scene.lights[index];
    let gesture = 0;
    const send = (change, ends) => {
      gesture ||= this.newGesture();
      Object.assign(light(), change);
      const { gain, color, position } = light();
      this.edit({ light: index, gain, color, ...(position ? { position } : {}) }, gesture);
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
    const element = make("div", { className: "row light" }, on, label, percent, color, slider);
    const axes = light().position ? this.axes(light, send) : [];
    if (axes.length) element.append(make("div", { className: "triple" }, ...axes));
    return { element, on, slider, percent, color, axes };
  }

  /** Number fields for the place of a point or spot light. */
  axes(light, send) {
    return ["x", "y", "z"].map((axis, i) => {
      const input = make("input", { type: "number", step: 0.1, title: `${axis}, metres`, onchange: () => {
        const position = [...light().position];
        position[i] = Number(input.value);
        if (Number.isFinite(position[i])) send({ position }, true);
      } });
      markBusy(input);
      return input;
    });
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
    row.axes.forEach((input, i) => setIdle(input, short(light.position[i])));
  }
}
