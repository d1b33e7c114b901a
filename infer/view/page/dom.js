// Small helpers around the document.

/** Makes an element: properties (or attributes with a dash), then children. */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (key in element) element[key] = value;
    else element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}

export const byId = (id) => document.getElementById(id);

/** Sets a value unless its element is being used, so that no answer of the server fights a hand. */
export function setIdle(input, value) {
  if (document.activeElement !== input || !input.dataset.busy) input.value = value;
}

/** Marks an input as in use from its first event until it is let go. */
export function markBusy(input) {
  input.addEventListener("input", () => { input.dataset.busy = "1"; });
  for (const end of ["change", "blur"]) {
    input.addEventListener(end, () => { delete input.dataset.busy; });
  }
}

/** Whether the panel stands below the picture and not beside it, as in style.css. */
export const isStacked = () => matchMedia("(max-width: 720px), (orientation: portrait)").matches;

/** Whether a panel has not listed these things, by their numbers and names, before. */
export function changed(panel, things) {
  const listed = JSON.stringify(things.map(({ light, material, object, name }) =>
    [light ?? material ?? object, name]));
  if (panel.listed === listed) return false;
  panel.listed = listed;
  return true;
}

/** A number for people: few digits, no trailing zeros. */
export function short(value, digits = 3) {
  return String(Number(value.toFixed(digits)));
}
