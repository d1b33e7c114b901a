// What is shown and how: output, exposure, curve, size, lens, cameras of the file.
import { byId, make, markBusy, setIdle, short } from "./dom.js";

const LABELS = { full: "Full", indirect: "Indirect", direct: "Direct", irradiance: "Irradiance",
                 reference: "Reference", difference: "Difference", albedo: "Albedo", normal: "Normal" };
const HINTS = {
  full: "Direct and indirect light",
  indirect: "Light that surfaces have reflected, alone",
  direct: "Light that comes straight from the lamps",
  irradiance: "Indirect irradiance, without textures",
  reference: "Path tracing, better and better",
  difference: "Full less reference: red is too bright, blue too dark",
  albedo: "The surfaces' own color", normal: "Directions of the surfaces" };
const CURVES = { linear: "sRGB, clipped", reinhard: "Reinhard", filmic: "Filmic" };
const HEIGHTS = [240, 360, 480, 720, 960];

export class ViewPanel {
  /** @param actions  {view(change), camera(camera), reset()} */
  constructor(store, actions) {
    Object.assign(this, { store, actions });
    this.ev = make("input", { type: "range", min: -6, max: 6, step: 0.05, value: 0,
      oninput: () => this.setEv(Number(this.ev.value)) });
    this.evText = make("output", { textContent: "0 EV" });
    this.meter = make("button", { textContent: "Meter", title: "Choose the exposure anew by this picture",
      onclick: () => { this.setEv(0); actions.view({ ev: 0, meter: true }); } });
    this.curve = this.choice(Object.entries(CURVES), (curve) => actions.view({ curve }));
    this.size = this.choice([], (text) => actions.view({ size: text.split("x").map(Number) }));
    this.vfov = make("input", { type: "range", min: 15, max: 110, step: 1,
      oninput: () => store.camera && actions.camera({ ...store.camera, vfov: Number(this.vfov.value) }) });
    this.vfovText = make("output");
    this.cameras = make("div", { className: "pair" });
    for (const input of [this.ev, this.vfov]) markBusy(input);
    this.ev.setAttribute("aria-label", "Exposure");
    this.vfov.setAttribute("aria-label", "Field of view");
    const field = (label, input) => make("label", { className: "field" }, label, input);
    byId("view").append(
      make("div", { className: "line" }, make("span", { textContent: "Exposure" }), this.evText, this.meter),
      this.ev, make("div", { className: "pair" }, field("Tone curve", this.curve), field("Size", this.size)),
      make("div", { className: "row" }),
      make("div", { className: "line" }, make("span", { textContent: "Field of view" }), this.vfovText),
      this.vfov, this.cameras, make("div", { className: "row" }),
      make("div", { className: "line" }, make("span", { className: "muted", textContent: "All edits" }),
        make("button", { textContent: "Reset scene", onclick: () => actions.reset() })));
    store.on("scene", () => this.build());
    store.on("picture", (header) => this.refresh(header));
  }

  choice(entries, chosen) {
    const select = make("select", { onchange: () => chosen(select.value) });
    this.options(select, entries);
    return select;
  }

  options(select, entries) {
    select.replaceChildren(...entries.map(([value, text]) => make("option", { value, textContent: text })));
  }

  setEv(ev) {
    this.ev.value = ev;
    this.evText.textContent = `${ev > 0 ? "+" : ""}${short(ev, 2)} EV`;
    this.actions.view({ ev: Number(ev) });
  }

  nudgeEv(steps) {
    this.setEv(Math.max(-6, Math.min(6, Number(this.ev.value) + steps / 3)));
  }

  build() {
    const { outputs, cameras } = this.store.scene;
    byId("outputs").replaceChildren(...outputs.map((shown, i) =>
      make("button", { role: "radio", "aria-checked": "false", "data-shown": shown, textContent: LABELS[shown],
                       title: `${HINTS[shown]} (${i + 1})`, onclick: () => this.actions.view({ shown }) })));
    this.cameras.replaceChildren(...cameras.map((camera, i) =>
      make("button", { textContent: camera.name || `camera ${i + 1}`, onclick: () => this.actions.camera(camera) })));
    if (this.store.header) this.refresh(this.store.header);
  }

  refresh(header) {
    for (const button of byId("outputs").children) {
      button.setAttribute("aria-checked", String(button.dataset.shown === header.shown));
    }
    setIdle(this.ev, header.ev);
    if (!this.ev.dataset.busy) this.evText.textContent = `${header.ev > 0 ? "+" : ""}${short(header.ev, 2)} EV`;
    if (document.activeElement !== this.curve) this.curve.value = header.curve;
    this.refreshSizes(header.size);
    setIdle(this.vfov, header.camera.vfov);
    this.vfovText.textContent = `${short(header.camera.vfov, 0)}°`;
  }

  /** Sizes of the shape that the picture has. */
  refreshSizes([width, height]) {
    const now = `${width}x${height}`;
    if (this.size.value === now || document.activeElement === this.size) return;
    const texts = HEIGHTS.map((h) => `${Math.round((h * width) / height)}x${h}`);
    if (!texts.includes(now)) texts.push(now);
    this.options(this.size, texts.map((text) => [text, text.replace("x", " × ")]));
    this.size.value = now;
  }
}
