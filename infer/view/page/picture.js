// The picture and what is drawn over it, in the largest frame of its shape that fits.
import { project } from "./camera.js";
import { isStacked } from "./dom.js";
import { corners } from "./store.js";

const EDGES = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7],
               [0, 4], [1, 5], [2, 6], [3, 7]];

export class Picture {
  /** @param shown  called with the header of a picture once it is on the screen */
  constructor(store, elements, shown) {
    this.store = store;
    Object.assign(this, elements);  // viewport, stage, picture, overlay
    this.shown = shown;
    this.aspect = 4 / 3;
    this.newest = 0;
    new ResizeObserver(() => this.fit()).observe(this.viewport);
    for (const event of ["selection", "edits", "scene", "placing"]) {
      store.on(event, () => this.drawOverlay());
    }
  }

  /** Decodes a JPEG and shows it, unless a later one has come in the meantime. */
  async show(header, bytes) {
    this.newest = header.picture;
    const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/jpeg" }));
    if (header.picture >= this.newest) {
      const { picture } = this;
      if (picture.width !== header.width || picture.height !== header.height) {
        picture.width = header.width;
        picture.height = header.height;
      }
      picture.getContext("2d").drawImage(bitmap, 0, 0);
      this.store.header = header;
      if (Math.abs(this.aspect - header.size[0] / header.size[1]) > 1e-6) {
        this.aspect = header.size[0] / header.size[1];
        this.fit();
      }
      this.drawOverlay();
    }
    bitmap.close();
    this.shown(header);
  }

  fit() {
    const { viewport, stage, overlay } = this;
    const stacked = isStacked();
    const width = viewport.clientWidth;
    viewport.style.height = stacked ? `${Math.round(width / this.aspect)}px` : "";
    const height = stacked ? width / this.aspect : viewport.clientHeight;
    const w = Math.floor(Math.min(width, height * this.aspect));
    stage.style.width = `${w}px`;
    stage.style.height = `${Math.round(w / this.aspect)}px`;
    overlay.width = Math.round(w * devicePixelRatio);
    overlay.height = Math.round((w / this.aspect) * devicePixelRatio);
    this.drawOverlay();
  }

  /** The corners of the selected object in the picture; null if one lies behind the camera. */
  outline() {
    const object = this.store.selected(), header = this.store.header;
    if (!object || !header) return null;
    const points = corners(object).map((p) => project(header.camera, this.aspect, p));
    return points.includes(null) ? null : points;
  }

  drawOverlay() {
    const { overlay } = this;
    const context = overlay.getContext("2d");
    context.clearRect(0, 0, overlay.width, overlay.height);
    const points = this.outline();
    if (!points) return;
    context.lineWidth = 1.5 * devicePixelRatio;
    for (const [color, widen] of [["#000a", 2], ["#e8b04b", 0]]) {
      context.strokeStyle = color;
      context.lineWidth = (1.4 + widen) * devicePixelRatio;
      context.beginPath();
      for (const [a, b] of EDGES) {
        context.moveTo(points[a][0] * overlay.width, points[a][1] * overlay.height);
        context.lineTo(points[b][0] * overlay.width, points[b][1] * overlay.height);
      }
      context.stroke();
    }
  }

  /** Whether a point of the picture lies on the selected object's box. */
  isOnSelection(x, y) {
    const points = this.outline();
    if (!points) return false;
    const hull = convexHull(points);
    if (area(hull) > 0.5) return false;  // a wall or the room itself: that is to be flown through
    return hull.every((a, i) => {
      const b = hull[(i + 1) % hull.length];
      return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) >= 0;
    });
  }
}

/** Counter-clockwise where y points down the other way round: all turns have one sign. */
function convexHull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const turn = (o, a, b) => (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
  const half = (list) => {
    const out = [];
    for (const p of list) {
      while (out.length > 1 && turn(out[out.length - 2], out[out.length - 1], p) <= 0) out.pop();
      out.push(p);
    }
    return out.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

function area(hull) {
  let twice = 0;
  hull.forEach((a, i) => {
    const b = hull[(i + 1) % hull.length];
    twice += a[0] * b[1] - a[1] * b[0];
  });
  return Math.abs(twice) / 2;
}
