// Colors of inputs are sRGB; everything the server says is linear.

const toSrgb = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
const toLinear = (x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);

/** [r, g, b] linear in [0, 1] as "#rrggbb". */
export function toHex(rgb) {
  const byte = (x) => Math.round(255 * toSrgb(Math.min(1, Math.max(0, x))));
  return "#" + rgb.map((x) => byte(x).toString(16).padStart(2, "0")).join("");
}

export function fromHex(hex) {
  return [1, 3, 5].map((at) => toLinear(parseInt(hex.slice(at, at + 2), 16) / 255));
}

/** Scaled so that the largest component is 1; white for black. */
export function chroma(rgb) {
  const largest = Math.max(...rgb);
  return largest > 0 ? rgb.map((x) => x / largest) : [1, 1, 1];
}
