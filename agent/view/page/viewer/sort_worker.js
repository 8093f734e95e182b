// A worker that keeps every slot's position, radius and group, and answers a view with the slots in it, nearest first.
// Depths become 16 bits between the nearest and the farthest and are sorted by counting, which keeps slots in order at equal depth.

let slots = 0;
let extents = new Float32Array(0); // 5 a slot: position, radius (0: nothing to draw), group (integer)
let groups = new Int32Array(0);
let depths = new Float32Array(0);
let seen = new Uint32Array(0);
let hidden = new Set();
let sides = null; // of a slot 1: only in the picture after, 2: only in the one before, 0: in both (Uint8Array)
const KEYS = 65536;
const starts = new Uint32Array(KEYS + 1);

onmessage = ({ data }) => {
  if (data.rows) rows(data);
  else if (data.hidden) hidden = data.hidden;
  else if ('sides' in data) sides = data.sides;
  else if ('keep' in data) slots = data.keep; // forget the slots behind these
  else {
    const answer = sorted(data);
    postMessage(answer, [answer.order.buffer]);
  }
};

function rows({ first, rows, capacity }) {
  if (5 * capacity > extents.length) {
    const wider = new Float32Array(5 * capacity);
    wider.set(extents);
    extents = wider;
    groups = new Int32Array(extents.buffer);
    depths = new Float32Array(capacity);
    seen = new Uint32Array(capacity);
  }
  extents.set(rows, 5 * first);
  slots = Math.max(slots, first + rows.length / 5);
}

// position, right, down, forward: of the camera; near: of the near plane; slopes: tangents at the image's right and lower edge,
// with a margin for the dilation; clamps: the largest tangents of the Jacobian; which: the side (0: there is only one);
// buffer: an ArrayBuffer to reuse.
function sorted({ position, right, down, forward, near, slopes, clamps, which, number, buffer }) {
  const began = performance.now();
  const [px, py, pz] = position;
  const [rx, ry, rz] = right;
  const [dx, dy, dz] = down;
  const [fx, fy, fz] = forward;
  const [tx, ty] = slopes;
  // The first-order footprint of a sphere of radius r at depth z is f r sqrt(1 + u^2) / z wide, u the clamped tangent.
  const sx = Math.hypot(1, clamps[0]);
  const sy = Math.hypot(1, clamps[1]);
  const picky = hidden.size > 0;
  let count = 0;
  let nearest = Infinity;
  let farthest = 0;
  for (let slot = 0, at = 0; slot < slots; slot++, at += 5) {
    const radius = extents[at + 3];
    if (!(radius > 0)) continue;
    const x = extents[at] - px;
    const y = extents[at + 1] - py;
    const z = extents[at + 2] - pz;
    const depth = fx * x + fy * y + fz * z;
    if (!(depth > near && depth < 1e10)) continue;
    if (Math.abs(rx * x + ry * y + rz * z) > tx * depth + sx * radius) continue;
    if (Math.abs(dx * x + dy * y + dz * z) > ty * depth + sy * radius) continue;
    if (picky && hidden.has(groups[at + 4])) continue;
    if (sides && sides[slot] && sides[slot] !== (which || 1)) continue;
    if (depth < nearest) nearest = depth;
    if (depth > farthest) farthest = depth;
    depths[count] = depth;
    seen[count++] = slot;
  }
  const factor = farthest > nearest ? (KEYS - 1) / (farthest - nearest) : 0;
  starts.fill(0);
  for (let i = 0; i < count; i++) starts[((depths[i] - nearest) * factor + 1) | 0]++;
  for (let key = 1; key <= KEYS; key++) starts[key] += starts[key - 1];
  const order = new Uint32Array(buffer && buffer.byteLength >= 4 * count ? buffer : 4 * Math.ceil(1 + count / 1024) * 1024);
  for (let i = 0; i < count; i++) order[starts[((depths[i] - nearest) * factor) | 0]++] = seen[i];
  return { order, count, number, which, ms: performance.now() - began };
}
