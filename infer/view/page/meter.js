// Where the time goes: the stages of the last pass, the picture so far, the answer to the last move.
import { byId, make, short } from "./dom.js";

const COLORS = { hits: "#6d8fb8", irradiance: "#e8b04b", denoise: "#8d7fb3", paths: "#7fb98b", jpeg: "#8d959f", scene: "#6d8fb8", bvh: "#7fb98b",
                 points: "#8d7fb3", light: "#c9825b", encode: "#e8b04b" };
const NAMES = { irradiance: "light", jpeg: "picture", bvh: "tree", light: "light at points" };
const ANSWERED = { gather: "gathered from traced light", network: "gathered from the network's light",
                   path: "by paths" };
const DARK = new Set(["direct", "reference", "albedo", "normal"]);  // outputs without answered light
const time = (ms) => (ms < 1000 ? `${short(ms, 0)} ms` : `${short(ms / 1000, 1)} s`);

function bar(stages) {
  const shown = Object.entries(stages).filter(([, ms]) => ms >= 0.05);
  const total = shown.reduce((sum, [, ms]) => sum + ms, 0) || 1;
  const strip = make("div", { className: "stages" });
  const legend = make("div", { className: "legend" });
  for (const [name, ms] of shown) {
    const part = make("i", { title: `${NAMES[name] ?? name}: ${time(ms)}` });
    part.style.width = `${(100 * ms) / total}%`;
    part.style.background = COLORS[name] ?? "#555";
    const entry = make("span", { textContent: `${NAMES[name] ?? name} ${short(ms, ms < 10 ? 1 : 0)}` });
    entry.style.setProperty("--dot", COLORS[name] ?? "#555");
    strip.append(part);
    legend.append(entry);
  }
  return [strip, legend];
}

export class Meter {
  constructor(store) {
    this.store = store;
    this.latency = 0;
    this.edit = make("div", { hidden: true });
    this.picture = make("div");
    byId("meter").append(this.picture, this.edit);
    store.on("picture", (header) => this.refresh(header));
    store.on("edits", (message) => this.refreshEdit(message.cost));
  }

  refresh(header) {
    const total = Object.values(header.ms).reduce((sum, ms) => sum + ms, 0);
    const line = make("div", {}, make("b", { textContent: time(total) }), ` for pass ${header.pass}`);
    if (!header.done) line.append(` of ${header.passes}`);
    line.append(` at ${header.width} × ${header.height}`);
    const facts = [];
    if (this.latency) facts.push(`${time(this.latency)} from hand to picture`);
    facts.push(`${time(header.elapsed)} since the change`);
    if (header.paths > 0) facts.push(`${header.paths} paths a pixel`);
    else if (header.path > 0) facts.push(`the time of ${short(header.elapsed / header.path, 1)} paths a pixel`);
    this.picture.replaceChildren(line, ...bar(header.ms), make("div", { textContent: facts.join(" · ") }));
    if (DARK.has(header.shown)) return;
    this.picture.append(make("div", { className: "answered",
      textContent: `Indirect light ${ANSWERED[header.answered_by] ?? header.answered_by}` }));
    const check = header.check;
    if (!check) return;
    const { ratio, standard_error: error } = check.whole;
    this.picture.append(make("div", { className: check.note ? "check off" : "check",
      title: `${check.paths} paths in ${check.regions.length} regions of what is seen`,
      textContent: check.note || `Indirect light ${ratio.toFixed(2)} ± ${error.toFixed(2)} of traced` }));
  }

  refreshEdit(cost) {
    this.edit.hidden = false;
    const encoded = cost.encodings > 0 ? `, encoded ${cost.encodings === 1 ? "once" : `${cost.encodings} times`}`
                                       : ", nothing encoded";
    const what = { kept: ", with the indirect light of before", draft: ", light of half the points" }[cost.accuracy]
      ?? encoded;
    this.edit.replaceChildren(make("div", {}, make("b", { textContent: time(cost.total) }),
                                   ` for the last edit${what}`), ...bar(cost.ms));
  }
}
