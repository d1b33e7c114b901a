// The camera: {origin, target, up, vfov in degrees, mirrored}. All functions return another one.
import { add, cross, dot, length, normalize, rotate, scale, sub } from "./vector.js";

const UP = [0, 1, 0];
const STEEPEST = 0.995;  // of the view's vertical part: no turning over the top

function frame(camera) {
  const view = normalize(sub(camera.target, camera.origin));
  const side = normalize(cross(view, camera.up));
  return { view, right: camera.mirrored ? scale(side, -1) : side, above: cross(side, view) };
}

/** Turns a vector by yaw about the vertical and by pitch, but never over the top. */
function turned(vector, camera, yaw, pitch) {
  const side = normalize(cross(normalize(sub(camera.target, camera.origin)), UP));
  let out = rotate(vector, UP, yaw);
  const tilted = rotate(out, rotate(side, UP, yaw), pitch);
  if (Math.abs(normalize(tilted)[1]) < STEEPEST) out = tilted;
  return out;
}

const mirror = (camera) => (camera.mirrored ? -1 : 1);

/** Moves the origin around the target. */
export function orbit(camera, yaw, pitch) {
  const arm = turned(sub(camera.origin, camera.target), camera, yaw * mirror(camera), pitch);
  return { ...camera, origin: add(camera.target, arm), up: UP };
}

/** Turns the view where the camera stands. */
export function look(camera, yaw, pitch) {
  const view = turned(sub(camera.target, camera.origin), camera, yaw * mirror(camera), pitch);
  return { ...camera, target: add(camera.origin, view), up: UP };
}

/** Moves by metres to the right, up and ahead, all as the picture has them. */
export function fly(camera, right, up, ahead) {
  const f = frame(camera);
  const by = add(add(scale(f.right, right), scale(f.above, up)), scale(f.view, ahead));
  return { ...camera, origin: add(camera.origin, by), target: add(camera.target, by) };
}

/** Moves towards the target by a factor of the distance, and beyond it with the target ahead. */
export function dolly(camera, factor) {
  const arm = sub(camera.origin, camera.target);
  const distance = length(arm);
  const wanted = distance * factor;
  if (wanted < 0.15) return fly(camera, 0, 0, distance - wanted);
  return { ...camera, origin: add(camera.target, scale(arm, factor)) };
}

/** Puts the target at this distance along the view, which changes no picture. */
export function withTargetAt(camera, distance) {
  const { view } = frame(camera);
  return { ...camera, target: add(camera.origin, scale(view, Math.max(distance, 0.05))) };
}

/** Looks at a box from where the camera stands, or from farther away if it stands in it. */
export function lookAt(camera, point, size) {
  const arm = sub(camera.origin, point);
  const least = size / Math.tan((camera.vfov * Math.PI) / 360);
  const away = length(arm) < 0.5 * size ? add(point, scale(normalize(arm), least)) : camera.origin;
  return { ...camera, origin: away, target: point, up: UP };
}

/** Metres that a picture height spans at the target. */
export function spanAtTarget(camera) {
  return 2 * length(sub(camera.target, camera.origin)) * Math.tan((camera.vfov * Math.PI) / 360);
}

/** Where a point stands in the picture, (0, 0) top left, (1, 1) bottom right; null behind it. */
export function project(camera, aspect, point) {
  const f = frame(camera);
  const to = sub(point, camera.origin);
  const depth = dot(to, f.view);
  if (depth < 1e-3) return null;
  const half = depth * Math.tan((camera.vfov * Math.PI) / 360);
  return [0.5 + (0.5 * dot(to, f.right)) / (half * aspect), 0.5 - (0.5 * dot(to, f.above)) / half];
}

/** The direction through a point of the picture. */
export function direction(camera, aspect, x, y) {
  const f = frame(camera);
  const half = Math.tan((camera.vfov * Math.PI) / 360);
  return normalize(add(f.view, add(scale(f.right, (2 * x - 1) * half * aspect),
                                   scale(f.above, (1 - 2 * y) * half))));
}

/** Where the ray through a point of the picture meets a plane; null if it does not, or far off. */
export function meetPlane(camera, aspect, x, y, point, normal, farthest = 1e3) {
  const ray = direction(camera, aspect, x, y);
  const slope = dot(ray, normal);
  if (Math.abs(slope) < 1e-4) return null;
  const t = dot(sub(point, camera.origin), normal) / slope;
  return t > 0 && t < farthest ? add(camera.origin, scale(ray, t)) : null;
}
