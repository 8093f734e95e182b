// Regions of the picture, in CSS pixels: the box between two corners, the way of a brush; and what of the selection is in them.

/** Tells of a point whether it is in the box with two opposite corners. */
export const inBox = ([ax, ay], [bx, by]) => ([x, y]) => (x - ax) * (x - bx) <= 0 && (y - ay) * (y - by) <= 0;

/** Tells of a point whether a round brush that goes along points has touched it. */
export const underBrush = (points, radius) => (spot) => points.some((from, i) => away(spot, from, points[i + 1] ?? from) <= radius);

/** The slots of a selection whose middle is in a region, those that others cover too, as ascending ranges. */
export function selectedIn(viewer, {groups, ranges}, inside) {
  const {splats, pinhole, ratio} = viewer;
  const chosen = new Set(groups);
  const among = groups.length ? [[0, splats.slots]] : ranges;
  const found = [];
  for (const [first, count] of among) {
    for (let slot = first; slot < first + count; slot++) {
      if (chosen.size && !chosen.has(splats.group[4 * slot + 3])) continue;
      const spot = pinhole.project(splats.position.subarray(4 * slot, 4 * slot + 3));
      if (spot && inside([spot.x / ratio, spot.y / ratio])) push(found, slot);
    }
  }
  return found;
}

/** The slots of two lists of ascending ranges, as one such list. */
export function joined(one, other) {
  const found = [];
  for (const [first, count] of [...one, ...other].sort(([a], [b]) => a - b)) {
    const last = found.at(-1);
    const end = last ? last[0] + last[1] : 0;
    if (last && first <= end) last[1] = Math.max(end, first + count) - last[0];
    else found.push([first, count]);
  }
  return found;
}

function push(ranges, slot) {
  const last = ranges.at(-1);
  if (last && last[0] + last[1] === slot) last[1]++;
  else ranges.push([slot, 1]);
}

/** From a point to the segment between two others. */
function away([x, y], [ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay];
  const length = dx * dx + dy * dy;
  const share = length ? Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / length)) : 0;
  return Math.hypot(x - ax - share * dx, y - ay - share * dy);
}
