// Space as the page needs it: what is right, forward and up for the viewer, lines of sight, and boxes.

import {add, cross, dot, norm, scale, unit} from "./viewer/camera.js";

/** Right, forward and up as operations mean them (`heading` in tools/placement/bodies.py): level, as the camera looks. */
export function viewerAxes(camera, up) {
  const level = (way) => add(way, up, -dot(way, up));
  let forward = level(camera.forward);
  if (norm(forward) < 1e-3) forward = level(camera.up); // looks straight down
  forward = unit(forward);
  return {right: cross(forward, up), forward, up};
}

/** The unit vector from the eye through a point of the canvas. */
export const sight = (viewer, x, y) => unit(add(viewer.unproject(x, y, 1), viewer.camera.position, -1));

/** How far along a line (a point and a unit vector) the place lies that is nearest to a line of sight; null if both run
 * alike. */
export function alongLine(point, way, eye, look) {
  const between = add(point, eye, -1);
  const alike = dot(way, look);
  const rest = 1 - alike * alike;
  return rest < 1e-4 ? null : (alike * dot(look, between) - dot(way, between)) / rest;
}

/** Where a line of sight meets a plane; null if it runs along it or away from it. */
export function onPlane(point, normal, eye, look) {
  const steep = dot(look, normal);
  const far = dot(add(point, eye, -1), normal) / steep;
  return Math.abs(steep) < 1e-3 || far <= 0 ? null : add(eye, look, far);
}

/** The axes of a box (unit vectors) from its quaternion wxyz. */
export function axesOf([w, x, y, z]) {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
  ];
}

/** The eight corners of a box; bit `i` of a corner's number says on which side of axis `i` it lies. */
export function cornersOf({centre, size, quat}) {
  const axes = axesOf(quat);
  return [...Array(8).keys()].map((number) =>
    axes.reduce((corner, axis, i) => add(corner, axis, (number & (1 << i) ? 0.5 : -0.5) * size[i]), centre),
  );
}

/** Pairs of corners that an edge joins. */
export const EDGES = [...Array(8).keys()].flatMap((a) => [1, 2, 4].filter((bit) => !(a & bit)).map((bit) => [a, a | bit]));

/** The middle of several boxes, and half their reach from it. */
export function middleOf(boxes) {
  const corners = boxes.flatMap(cornersOf);
  const [low, high] = [Math.min, Math.max].map((pick) => [0, 1, 2].map((i) => pick(...corners.map((corner) => corner[i]))));
  return {centre: scale(add(low, high), 0.5), radius: norm(add(high, low, -1)) / 2};
}

/** How far boxes reach along a unit vector, as [least, most]. */
export function reachOf(boxes, way) {
  const along = boxes.flatMap(cornersOf).map((corner) => dot(corner, way));
  return [Math.min(...along), Math.max(...along)];
}
