// Which Gaussian contributes most at a pixel: blended on the CPU as in gaussians/render/reference.py, over the slots already sorted.

import { half } from './decode.js';

const ALPHA_MIN = 1 / 255;
const ALPHA_MAX = 0.999;
const T_MIN = 1e-4;
const DILATION = 0.3;
const SAMPLES = 256; // along a side of a region; larger ones are sampled every few pixels

// The slot with the largest weight at each sample: {slots (Int32Array, -1: nothing), depths}. grid: {x, y (of the first sample's pixel
// centre), step, columns, rows}; open: samples that count (null: all).
export function heaviest(splats, { order, count }, camera, grid, open = null) {
  const { x, y, step, columns, rows } = grid;
  const { position, focal, right, down, forward, width, height } = camera;
  const [uLow, uHigh, vLow, vHigh] = camera.tangents;
  const stretch = Math.hypot(1, uHigh, vHigh);
  const through = new Float64Array(columns * rows).fill(1);
  const best = new Float64Array(columns * rows);
  const slots = new Int32Array(columns * rows).fill(-1);
  const depths = new Float64Array(columns * rows);
  let left = columns * rows;
  if (open) {
    for (let i = 0; i < open.length; i++) {
      if (!open[i]) (through[i] = 0), left--;
    }
  }
  const middleX = x + (step * (columns - 1)) / 2;
  const middleY = y + (step * (rows - 1)) / 2;
  const reachX = (step * (columns - 1)) / 2 + 1.9; // 1.9 px: the reach of the dilation alone
  const reachY = (step * (rows - 1)) / 2 + 1.9;
  for (let i = 0; i < count && left > 0; i++) {
    const slot = order[i];
    const px = splats.position[4 * slot] - position[0];
    const py = splats.position[4 * slot + 1] - position[1];
    const pz = splats.position[4 * slot + 2] - position[2];
    const z = forward[0] * px + forward[1] * py + forward[2] * pz;
    const u = (right[0] * px + right[1] * py + right[2] * pz) / z;
    const v = (down[0] * px + down[1] * py + down[2] * pz) / z;
    const wide = (focal * stretch * splats.radius[slot]) / z;
    const cx = focal * u + width / 2;
    const cy = focal * v + height / 2;
    if (Math.abs(cx - middleX) > reachX + wide || Math.abs(cy - middleY) > reachY + wide) continue;
    const clampedU = Math.min(Math.max(u, uLow), uHigh);
    const clampedV = Math.min(Math.max(v, vLow), vHigh);
    const { xx, xy, yy, determinant, opacity } = footprint(splats, slot, camera, z, clampedU, clampedV);
    const limit = 2 * Math.log(opacity / ALPHA_MIN);
    const boxX = Math.sqrt(limit * xx);
    const boxY = Math.sqrt(limit * yy);
    const firstColumn = Math.max(0, Math.ceil((cx - boxX - x) / step));
    const lastColumn = Math.min(columns - 1, Math.floor((cx + boxX - x) / step));
    const firstRow = Math.max(0, Math.ceil((cy - boxY - y) / step));
    const lastRow = Math.min(rows - 1, Math.floor((cy + boxY - y) / step));
    for (let row = firstRow; row <= lastRow; row++) {
      for (let column = firstColumn; column <= lastColumn; column++) {
        const at = row * columns + column;
        const T = through[at];
        if (T === 0) continue;
        const dx = x + step * column - cx;
        const dy = y + step * row - cy;
        const exponent = (yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / (2 * determinant);
        const alpha = Math.min(ALPHA_MAX, opacity * Math.exp(-exponent));
        if (alpha < ALPHA_MIN) continue;
        const behind = T * (1 - alpha);
        if (behind <= T_MIN) {
          through[at] = 0; // finished just before this one (convention.py)
          left--;
          continue;
        }
        through[at] = behind;
        if (alpha * T > best[at]) {
          best[at] = alpha * T;
          slots[at] = slot;
          depths[at] = z;
        }
      }
    }
  }
  return { slots, depths };
}

// 2-D covariance of a slot (px^2), its determinant, and the opacity.
function footprint(splats, slot, { focal, right, down, forward }, z, u, v) {
  const { turn16, shape16 } = splats;
  let [w, x, y, q] = [turn16[8 * slot], turn16[8 * slot + 1], turn16[8 * slot + 2], turn16[8 * slot + 3]];
  const length = Math.hypot(w, x, y, q) || 1;
  (w /= length), (x /= length), (y /= length), (q /= length);
  const axes = [
    [1 - 2 * (y * y + q * q), 2 * (x * y + w * q), 2 * (x * q - w * y)],
    [2 * (x * y - w * q), 1 - 2 * (x * x + q * q), 2 * (y * q + w * x)],
    [2 * (x * q + w * y), 2 * (y * q - w * x), 1 - 2 * (x * x + y * y)],
  ];
  let [xx, xy, yy] = [0, 0, 0];
  for (let k = 0; k < 3; k++) {
    const size = (Math.exp(half(shape16[8 * slot + 4 + k])) * focal) / z;
    const axis = axes[k];
    const depth = forward[0] * axis[0] + forward[1] * axis[1] + forward[2] * axis[2];
    const p = size * (right[0] * axis[0] + right[1] * axis[1] + right[2] * axis[2] - u * depth);
    const s = size * (down[0] * axis[0] + down[1] * axis[1] + down[2] * axis[2] - v * depth);
    xx += p * p;
    xy += p * s;
    yy += s * s;
  }
  xx += DILATION;
  yy += DILATION;
  return { xx, xy, yy, determinant: xx * yy - xy * xy, opacity: shape16[8 * slot + 7] / 65535 };
}

// Samples that cover a region of pixels [x0, x1) x [y0, y1).
export function gridOver(x0, y0, x1, y1) {
  const step = Math.max(1, Math.ceil(Math.max(x1 - x0, y1 - y0) / SAMPLES));
  const along = (low, high) => Math.max(1, Math.ceil((high - low) / step));
  return { x: Math.floor(x0) + 0.5, y: Math.floor(y0) + 0.5, step, columns: along(x0, x1), rows: along(y0, y1) };
}

// Slots (any order, -1 among them) as ascending ranges [[first, count], ...].
export function ranges(slots) {
  const found = [];
  for (const slot of Uint32Array.from(new Set(slots.filter((slot) => slot >= 0))).sort()) {
    const last = found[found.length - 1];
    if (last && last[0] + last[1] === slot) last[1]++;
    else found.push([slot, 1]);
  }
  return found;
}
