// Albedos: the list of materials, and the picker that the selection shows too.
import { fromHex, toHex } from "./color.js";
import { byId, changed, make, markBusy, setIdle } from "./dom.js";

/** A color input for the albedo of a material. */
export function albedoInput(store, index, edit, newGesture) {
  let gesture = 0;
  const input = make("input", { type: "color", title: "Albedo",
    oninput: () => {
      gesture ||= newGesture();
      const albedo = fromHex(input.value);
      store.scene.materials[index].albedo = albedo;
      edit({ material: store.scene.materials[index].material, albedo }, gesture);
    },
    onchange: () => { gesture = 0; } });
  markBusy(input);
  input.setAttribute("aria-label", `Albedo: ${store.scene.materials[index].name}`);
  input.value = toHex(store.scene.materials[index].albedo);
  return input;
}

export class MaterialsPanel {
  constructor(store, edit, newGesture) {
    Object.assign(this, { store, edit, newGesture });
    this.pane = byId("materials");
    this.rows = [];
    store.on("scene", () => this.build());
    store.on("edits", () => this.refresh());
    store.on("selection", () => this.refresh());
  }

  build() {
    const { materials } = this.store.scene;
    if (!changed(this, materials)) return this.refresh();
    this.rows = materials.map((material, index) => {
      const input = albedoInput(this.store, index, this.edit, this.newGesture);
      const kind = material.emissive ? "emits" : material.textured ? "tint" : "";
      const element = make("div", { className: "row material" },
        make("span", { className: "name", textContent: material.name || `material ${index}`, title: material.name }),
        make("span", { className: "tag", textContent: kind }), input);
      return { element, input };
    });
    this.pane.replaceChildren(...this.rows.map((row) => row.element));
    return this.refresh();
  }

  refresh() {
    this.rows.forEach((row, index) => {
      setIdle(row.input, toHex(this.store.scene.materials[index].albedo));
      row.element.classList.toggle("selected", index === this.store.material);
    });
  }
}
