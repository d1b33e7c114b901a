// What the network looks at: for a point that is clicked, the latents that the decoder reads there,
// or those that the latent at the point attends to in a block of the encoder, as colored dots.
import { project } from "./camera.js";
import { byId, make, short } from "./dom.js";
import { length, sub } from "./vector.js";

/** Matplotlib's inferno by eighths, as lte_render --output attention has it. */
const HEAT = [[0, 0, 4], [33, 12, 74], [86, 16, 110], [137, 34, 106], [187, 55, 84], [227, 89, 50],
              [249, 140, 10], [249, 201, 50], [252, 255, 164]];
const DOT_METRES = 0.05;   // of a dot's radius, in a scene of rooms
const LEAST_DOT = 2.5, MOST_DOT = 16;  // pixels

function heat(t) {
  const at = Math.min(1, Math.max(0, t)) * (HEAT.length - 1), i = Math.min(HEAT.length - 2, Math.floor(at));
  return `rgb(${HEAT[i].map((low, c) => Math.round(low + (at - i) * (HEAT[i + 1][c] - low))).join(" ")})`;
}

export class Attention {
  /** @param ask  sends a question and tells whether it went: ({position, normal, block, head}) */
  constructor(store, picture, ask) {
    Object.assign(this, { store, picture, ask });
    this.active = false;
    this.point = null;    // {position, normal} that was clicked
    this.answer = null;   // of the server
    this.asked = null;    // what the last question was about: camera and edits
    this.waits = false;   // for an answer
    this.block = make("select", { onchange: () => this.choose() });
    this.head = make("select", { onchange: () => this.question() });
    this.text = make("p", { className: "muted" });
    this.list = make("div");
    const field = (label, input) => make("label", { className: "field" }, label, input);
    byId("attention").append(
      make("div", { className: "pair" }, field("Block", this.block), field("Head", this.head)),
      this.text, this.list);
    this.options([]);
    this.say();
    picture.drawings.push((context) => this.draw(context));
    store.on("picture", (header) => this.follow(header));
    store.on("scene", () => { this.asked = null; });
  }

  /** Whether clicks are questions. */
  setActive(active) {
    if (active === this.active) return;
    this.active = active;
    if (active) this.store.select(-1);
    this.picture.drawOverlay();
  }

  /** Takes what was clicked, if clicks are questions. */
  takes(met) {
    if (!this.active) return false;
    this.point = met.object >= 0 ? { position: met.position, normal: met.normal } : null;
    this.answer = null;
    this.say();
    this.picture.drawOverlay();
    this.question();
    return true;
  }

  question() {
    if (!this.point) return;
    this.asked = this.around(this.store.header);
    const head = this.block.value.startsWith("decoder") ? -1 : Number(this.head.value || -1);
    this.waits = this.ask({ ...this.point, block: this.block.value || "decoder", head });
  }

  choose() {
    this.heads();
    this.question();
  }

  /** What an answer depends on beside the question: which latents are seen, and the scene. */
  around(header) {
    return JSON.stringify([header?.camera, this.edits ?? 0]);
  }

  /** Asks again where a picture that rests shows something else than the last answer knew. */
  follow(header) {
    this.edits = Math.max(0, ...Object.values(header.handled).map(([, edits]) => edits));
    if (!this.active || !this.point || this.waits || header.pass < 2) return;
    if (this.around(header) !== this.asked) this.question();
  }

  show(message) {
    this.waits = false;
    this.answer = message;
    this.options(message.blocks, message.layers);
    this.say();
    this.picture.drawOverlay();
  }

  /** The server has refused something; if it was the question, the point is gone. */
  refused() {
    if (!this.waits) return;
    this.waits = false;
    this.point = this.answer = null;
    this.say();
    this.picture.drawOverlay();
  }

  options(blocks, layers = 0) {
    const names = ["decoder", ...Array.from({ length: layers }, (_, l) => `decoder.${l}`),
                   ...blocks.map((block) => block.name)];
    if (names.length === this.block.options.length) return;
    const chosen = this.block.value || "decoder";
    this.block.replaceChildren(...names.map((name) => make("option", { value: name, textContent: name })));
    this.block.value = names.includes(chosen) ? chosen : "decoder";
    this.heads();
  }

  heads() {
    const block = this.answer?.blocks.find(({ name }) => name === this.block.value);
    const heads = Array.from({ length: block?.heads ?? 0 }, (_, h) => [h, `head ${h}`]);
    this.head.replaceChildren(...[[-1, block ? "mean" : "none"], ...heads].map(([value, text]) =>
      make("option", { value, textContent: text })));
    this.head.disabled = !block;
  }

  say() {
    const { answer } = this;
    if (!answer) {
      this.text.textContent = "Click a point: its answer is read from the latents shown. Choose a block of the "
        + "encoder to see what the latent there attends to.";
      return;
    }
    this.text.textContent = answer.block.startsWith("decoder")
      ? `${answer.dots.length} of the latents that are read here are seen. The brightest counts `
        + `${short(answer.most, 2)} times as much as their mean.`
      : `The latent at the point (square) attends to ${answer.latents}. The brightest gets `
        + `${short(answer.most, 2)} times an even share.`;
    this.list.replaceChildren(
      make("div", { className: "line tag" }, make("span", { textContent: "block, points" }),
           make("span", { textContent: "entropy over log n" })),
      ...answer.blocks.map((block) => {
        const bar = make("i", { className: "entropy", title: "1: a plain mean of all; 0: one point alone" });
        bar.style.setProperty("--share", block.entropy ?? 0);
        return make("button", { className: "row object block", "data-block": block.name,
          onclick: () => { this.block.value = block.name; this.choose(); } },
          make("span", { className: "name", textContent: `${block.name} · ${block.points}` }),
          make("span", { className: "tag", textContent: block.entropy?.toFixed(3) ?? "–" }), bar);
      }));
    for (const row of this.list.querySelectorAll("[data-block]"))
      row.classList.toggle("selected", row.dataset.block === answer.block);
  }

  draw(context) {
    const { store, picture, answer } = this;
    if (!this.active || !store.header) return;
    const { camera } = store.header, { width, height } = picture.overlay;
    const place = (point) => {
      const at = project(camera, picture.aspect, point);
      return at && [at[0] * width, at[1] * height];
    };
    const perMetre = height / (2 * Math.tan((camera.vfov * Math.PI) / 360));
    for (const [x, y, z, value] of [...(answer?.dots ?? [])].sort((a, b) => a[3] - b[3])) {
      const at = place([x, y, z]);
      if (!at) continue;
      const away = length(sub([x, y, z], camera.origin));
      const size = Math.min(MOST_DOT, Math.max(LEAST_DOT, (DOT_METRES * perMetre) / away)) * devicePixelRatio;
      context.fillStyle = heat(value / (answer.most || 1));
      context.beginPath();
      context.arc(at[0], at[1], size, 0, 2 * Math.PI);
      context.fill();
    }
    if (this.point) this.mark(context, place(this.point.position), "round");
    if (answer && !answer.block.startsWith("decoder")) this.mark(context, place(answer.latent), "square");
  }

  mark(context, at, shape) {
    if (!at) return;
    const r = 8 * devicePixelRatio;
    for (const [color, line] of [["#000c", 4], ["#fff", 1.8]]) {
      context.strokeStyle = color;
      context.lineWidth = line * devicePixelRatio;
      context.beginPath();
      if (shape === "round") context.arc(at[0], at[1], r, 0, 2 * Math.PI);
      else context.rect(at[0] - 0.6 * r, at[1] - 0.6 * r, 1.2 * r, 1.2 * r);
      context.stroke();
    }
  }
}
