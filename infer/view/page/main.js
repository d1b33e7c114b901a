// Puts the page together: what the server says goes to the store, what hands do to the server.
import { project, withTargetAt } from "./camera.js";
import { Connection } from "./connection.js";
import { Controls } from "./controls.js";
import { byId, make } from "./dom.js";
import { LightsPanel } from "./lights_panel.js";
import { MaterialsPanel } from "./materials_panel.js";
import { Meter } from "./meter.js";
import { ObjectsPanel, wrap } from "./objects_panel.js";
import { Picture } from "./picture.js";
import { keepFile } from "./saving.js";
import { Store } from "./store.js";
import { add, length, scale, sub } from "./vector.js";
import { ViewPanel } from "./view_panel.js";

const TOAST_MS = 6000, MOST_TOASTS = 4;
const LAMP_SHARE = 0.6;  // of the way from the camera to what it looks at, where a lamp is added
const PHASES = { connecting: "connecting", loading: "loading", ready: "live", lost: "reconnecting",
                 failed: "ended" };

const EDITS = new Set(["light", "material", "object", "copy_object", "remove_object", "add_light",
                       "remove_light", "undo", "redo", "reset"]);

const store = new Store();
const meter = new Meter(store);
const waiting = [];          // picks that the server has not answered, in order: functions
const sent = { view: 0, edits: 0 };  // numbers of the last messages that a picture must show
const stamps = new Map();    // message number -> {at: when it was sent, edits: whether it is one}
let sentCamera = 0;          // number of the last camera message
let cameraToSend = null;     // at most one a frame
let firstCamera = null;

const picture = new Picture(store, {
  viewport: byId("viewport"), stage: byId("stage"), picture: byId("picture"), overlay: byId("overlay"),
}, shown);

const connection = new Connection({
  open: () => setPhase("loading", "Loading the scene …"),
  lost() {
    waiting.length = 0;
    if (document.body.dataset.phase !== "failed") setPhase("lost", "The server does not answer. Trying again …");
  },
  message: (message) => handlers[message.type]?.(message),
  frame(header, bytes) {
    if (header.type === "picture") picture.show(header, bytes);
    else keepFile(header, bytes);
  },
});

const handlers = {
  welcome(message) {
    store.client = message.client;
    sentCamera = sent.view = sent.edits = 0;
    stamps.clear();
    if (message.phase === "loading") setPhase("loading", "Loading the scene …");
  },
  scene(message) {
    store.setScene(message);
    byId("scene-name").textContent = message.name || "scene";
    document.title = `${message.name || "scene"} · lte_view`;
    setUndo();
  },
  edits(message) {
    store.takeEdits(message);
    setUndo();
  },
  picked: (message) => waiting.shift()?.({ ...message, object: store.placeOf("object", message.object),
                                           material: store.placeOf("material", message.material) }),
  added(message) {
    if (message.object >= 0) store.select(store.placeOf("object", message.object));
    showTab(message.object >= 0 ? "objects" : "lights");
  },
  error: (message) => toast(message.message),
  failed: (message) => setPhase("failed", message.message),
};

function setPhase(phase, text) {
  document.body.dataset.phase = phase;
  byId("status").textContent = PHASES[phase];
  byId("notice").hidden = phase === "ready";
  byId("notice").classList.toggle("bad", phase === "failed");
  byId("notice-text").textContent = text ?? "";
}

function setUndo() {
  byId("undo").disabled = !store.undo;
  byId("redo").disabled = !store.redo;
}

function toast(text) {
  const list = byId("toasts"), entry = make("div", { textContent: text });
  list.append(entry);
  while (list.children.length > MOST_TOASTS) list.firstChild.remove();
  setTimeout(() => entry.remove(), TOAST_MS);
}

function send(message) {
  const number = connection.send(message);
  const edits = EDITS.has(message.type);
  if (number && message.type !== "save") {
    stamps.set(number, { at: performance.now(), edits });
    sent[edits ? "edits" : "view"] = number;
  }
  return number;
}

/** A picture is on the screen: the next may come. */
function shown(header) {
  connection.send({ type: "shows", picture: header.picture });
  if (document.body.dataset.phase !== "ready") setPhase("ready");
  const [view, edits] = header.handled[store.client] ?? [0, 0];
  measureLatency(view, edits);
  const follows = !controls.active() && !cameraToSend && view >= sentCamera;
  if (follows || !store.camera) adopt(header.camera);
  store.tell("picture", header);
}

/** The time from the last message that this picture is the first to show. */
function measureLatency(view, edits) {
  for (const [number, stamp] of stamps) {
    if (number > (stamp.edits ? edits : view)) continue;
    meter.latency = performance.now() - stamp.at;
    stamps.delete(number);
  }
}

function adopt(camera) {
  const isFirst = !store.camera;
  store.camera = camera;
  firstCamera ??= camera;
  // The target of a file's camera may be anywhere on its view; one turns around what one sees.
  if (isFirst) findPivot();
}

function findPivot() {
  pick(0.5, 0.5, (met) => {
    if (met.object < 0 || controls.active()) return;
    store.camera = withTargetAt(store.camera, length(sub(met.position, store.camera.origin)));
    firstCamera = store.camera;
  });
}

function pick(x, y, then) {
  if (connection.send({ type: "pick", x: clamp(x), y: clamp(y) })) waiting.push(then);
}

const clamp = (x) => Math.min(1, Math.max(0, x));

function setCamera(camera) {
  store.camera = camera;
  if (!cameraToSend) requestAnimationFrame(sendCamera);
  cameraToSend = camera;
}

function sendCamera() {
  const { origin, target, up, vfov } = cameraToSend;
  cameraToSend = null;
  sentCamera = send({ type: "camera", origin, target, up, vfov }) || sentCamera;
}

/** Sends at most one edit of each target a frame; the last one of a gesture always goes. */
const editsToSend = new Map();
function edit(message) {
  if (editsToSend.size === 0) {
    requestAnimationFrame(() => {
      for (const each of editsToSend.values()) send(each);
      editsToSend.clear();
    });
  }
  editsToSend.set(`${message.type} ${message[message.type]} ${message.gesture}`, message);
}

const editLight = (setting, gesture) => edit({ type: "light", ...setting, gesture });
const editMaterial = (setting, gesture) => edit({ type: "material", ...setting, gesture });

function place(index, change, gesture) {
  const object = Object.assign(store.scene.objects[index], change);
  const { object: number, move, turn, scale } = object;
  edit({ type: "object", object: number, move, turn, scale, gesture });
  store.tell("placing");
}

/** Copies the selected object to its side, towards the middle of the scene. */
function copySelected() {
  const object = store.selected();
  if (!object) return;
  const width = 1.05 * object.scale * (object.high[0] - object.low[0]);
  const middle = (object.low[0] + object.high[0]) / 2 + object.move[0];
  const inwards = middle < (store.scene.low[0] + store.scene.high[0]) / 2 ? 1 : -1;
  send({ type: "copy_object", object: object.object, move: [inwards * width, 0, 0] });
}

function removeSelected() {
  const object = store.selected();
  if (object) send({ type: "remove_object", object: object.object });
}

/** Hangs a lamp between the camera and what it looks at. */
function addLamp(kind) {
  pick(0.5, 0.5, (met) => {
    const { origin, target } = store.camera;
    const end = met.object < 0 ? target : met.position;
    const position = add(origin, scale(sub(end, origin), LAMP_SHARE));
    send({ type: "add_light", kind, position });
  });
}

const controls = new Controls(store, picture, {
  camera: setCamera,
  pick: (x, y) => pick(x, y, (met) => {
    store.select(met.object === store.object && met.object >= 0 ? store.object : met.object, met.material);
    if (met.object >= 0) showTab("objects");
  }),
  place,
  key: (event) => key(event),
});
const newGesture = () => controls.newGesture();

new LightsPanel(store, { edit: editLight, add: addLamp, newGesture,
                         remove: (light) => send({ type: "remove_light", light }) });
new MaterialsPanel(store, editMaterial, newGesture);
new ObjectsPanel(store, { place, material: editMaterial, focus: () => controls.focusSelection(), newGesture,
                          copy: copySelected, remove: removeSelected });
const viewPanel = new ViewPanel(store, {
  view: (change) => send({ type: "view", ...change }),
  camera: setCamera,
  reset: () => send({ type: "reset" }),
});

function key(event) {
  const control = event.ctrlKey || event.metaKey;
  if (control && event.code === "KeyZ") {
    event.preventDefault();
    return send({ type: event.shiftKey ? "redo" : "undo" });
  }
  if (control && event.code === "KeyY") {
    event.preventDefault();
    return send({ type: "redo" });
  }
  if (control && event.code === "KeyD") {
    event.preventDefault();
    return copySelected();
  }
  if (control || event.altKey) return undefined;
  if (event.code === "Delete") return removeSelected();
  if (event.key === "?") return byId("help").showModal();
  if (event.code === "Escape") return store.select(-1);
  if (event.code === "KeyF") return controls.focusSelection();
  if (event.code === "Home" && firstCamera) return setCamera(firstCamera);
  if (event.key === "-") return viewPanel.nudgeEv(-1);
  if (event.key === "=" || event.key === "+") return viewPanel.nudgeEv(1);
  if ((event.key === "[" || event.key === "]") && store.selected()) {
    const turn = wrap(store.selected().turn + (event.key === "[" ? 5 : -5));
    return place(store.object, { turn }, newGesture());
  }
  const shows = store.scene?.outputs[Number(event.key) - 1];
  if (shows) send({ type: "view", shown: shows });
  return undefined;
}

function showTab(name) {
  for (const tab of document.querySelectorAll("[data-tab]")) {
    const chosen = tab.dataset.tab === name;
    tab.setAttribute("aria-selected", String(chosen));
    byId(tab.dataset.tab).hidden = !chosen;
  }
}

for (const tab of document.querySelectorAll("[data-tab]")) {
  tab.addEventListener("click", () => showTab(tab.dataset.tab));
}
byId("undo").addEventListener("click", () => send({ type: "undo" }));
byId("redo").addEventListener("click", () => send({ type: "redo" }));
byId("help-button").addEventListener("click", () => byId("help").showModal());
for (const button of document.querySelectorAll("[data-save]")) {
  button.addEventListener("click", () => {
    byId("save-menu").open = false;
    send({ type: "save", format: button.dataset.save });
  });
}

/** Whether the picture is finished and shows all that this page has asked for. */
function caughtUp() {
  const header = store.header;
  if (!header?.done || cameraToSend || editsToSend.size > 0) return false;
  const [view, edits] = header.handled[store.client] ?? [0, 0];
  return document.body.dataset.phase === "ready" && view >= sent.view && edits >= sent.edits;
}

// For the console, and for tests.
globalThis.lteView = { store, picture, send, meter, project, caughtUp };
