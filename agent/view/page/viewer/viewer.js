// The viewer: a canvas that shows Gaussians from a camera, kept up to date by rows, and tells what is under the pointer.
// Draws only when something changed. Knows nothing of the session; see docs/view-protocol.md for the messages it decodes.

import { Pinhole } from './camera.js';
import { OrbitFlyWalk } from './controls.js';
import { readMessage } from './decode.js';
import { Drawing } from './drawing.js';
import { gridOver, heaviest, ranges } from './picking.js';
import { SELECTED, Splats } from './splats.js';

const BATCHES = [0.12, 0.3, 0.55]; // shares of the footprints after which finished pixels are closed
const LINE = 2; // CSS pixels of the line around what is selected
const SENT = 1 << 16; // slots a message to the sorting worker

export class SplatViewer {
  // onFrame(stats) after each picture, onCamera(camera) after each move; makeWorker: the sorting worker, where it is not a file beside this.
  constructor(canvas, { onFrame, onCamera, makeWorker } = {}) {
    const gl = canvas.getContext('webgl2', { alpha: false, antialias: false, depth: false, powerPreference: 'high-performance' });
    if (!gl) throw new Error('This browser has no WebGL2, or it is switched off; the scene cannot be drawn.');
    this.canvas = canvas;
    this.gl = gl;
    this.onFrame = onFrame;
    this.onCamera = onCamera;
    this.drawing = new Drawing(gl);
    this.background = [0, 0, 0];
    this.stats = { frame_ms: 0, sort_ms: 0, drawn: 0, slots: 0 };
    this.near = 0.01;
    this.view = { position: [0, 0, 0], forward: [0, 1, 0], up: [0, 0, 1], fov_y: 50 };
    this.marks = { groups: new Set(), ranges: [], color: [1, 0.62, 0.1] };
    this.veiled = new Set();
    this.waiting = []; // resolve functions of idle()
    this.number = 0; // of the state to be sorted: grows with each change of view or rows
    this.sortedNumber = -1;
    this.sorting = false;
    this.fence = null; // signalled when the last picture is finished
    this.fresh = false; // whether the picture is that of the present state
    this.controls = new OrbitFlyWalk(this);
    this.worker = makeWorker ? makeWorker() : new Worker(new URL('./sort_worker.js', import.meta.url));
    this.worker.onmessage = ({ data }) => this.sorted(data);
    this.stop = new AbortController();
    const on = (type, handler) => canvas.addEventListener(type, handler, { signal: this.stop.signal });
    on('webglcontextlost', (event) => event.preventDefault()); // else the browser never gives it back
    on('webglcontextrestored', () => this.restore());
    this.observer = new ResizeObserver(() => this.touch(true));
    this.observer.observe(canvas);
  }

  // Scene -------------------------------------------------------------------------------------------------------------

  begin({ slots, degree, near }) {
    if (this.splats) this.splats.free();
    this.splats = new Splats(this.gl, slots, degree);
    this.near = near ?? this.near;
    this.worker.postMessage({ keep: 0 });
    this.worker.postMessage({ sides: null });
    this.ready = null;
    this.past = null;
    this.earlier = null;
    this.flagged = false;
    this.touch(true);
  }

  write(column, changed, bytes) {
    this.splats.write(column, changed, bytes);
    if (column !== 'harmonics') this.tell(changed);
    this.touch(true);
  }

  decode(buffer) {
    const { header, columns } = readMessage(buffer);
    this.setBefore(null);
    if (header.base === null && (header.chunk?.[0] ?? 0) === 0) this.begin({ slots: header.slots, degree: header.degree, near: this.near });
    this.splats.grow(header.slots);
    const changed = new Map();
    for (const { column, ranges: where, bytes } of columns) {
      this.splats.write(column, where, bytes);
      if (column !== 'harmonics') where.forEach(([first, count]) => changed.set(`${first} ${count}`, [first, count]));
    }
    this.tell([...changed.values()]);
    // Of a load the pictures after 1, 2, 4, 8 ... messages and of the whole are drawn: each is worth its wait.
    const [number, of] = header.base === null ? (header.chunk ?? [0, 1]) : [0, 1];
    if (number + 1 === of || (number & (number + 1)) === 0) this.touch(true);
    return header;
  }

  // The rows that turn the scene into the one before (a "before" message), or null. They become slots behind the others, which only the
  // picture before shows, as only the picture after shows those that they stand for.
  setBefore(buffer) {
    if (!buffer && !this.past) return;
    const { splats } = this;
    this.past = null;
    this.earlier = null;
    this.worker.postMessage({ keep: splats.slots });
    this.worker.postMessage({ sides: null });
    if (buffer) {
      const { columns } = readMessage(buffer);
      const all = new Set(columns.flatMap(({ ranges: where }) => where.flatMap(([first, count]) => span(first, count))));
      const slots = Uint32Array.from(all).sort();
      const count = splats.slots;
      const copies = new Map(Array.from(slots, (slot, i) => [slot, count + i]));
      splats.copy(slots, count);
      for (const { column, ranges: where, bytes } of columns) splats.write(column, moved(where, copies), bytes);
      splats.slots = count;
      const sides = new Uint8Array(count + slots.length).fill(2, count);
      slots.forEach((slot) => slot < count && (sides[slot] = 1));
      this.tell([[count, slots.length]]);
      this.worker.postMessage({ sides }, [sides.buffer]);
      this.past = true;
    }
    this.touch(true);
  }

  // null, or the share of the width left of which the picture before is shown, if `setBefore` told it.
  get compare() {
    return this.share ?? null;
  }

  set compare(share) {
    if (this.compare === share) return;
    const kept = share !== null && this.share !== null && this.share !== undefined;
    this.share = share;
    this.touch(!kept);
  }

  get comparing() {
    return Boolean(this.past) && this.compare !== null;
  }

  // The browser took the graphics context away and gave a new one: everything on it is made anew from the copies here.
  restore() {
    this.drawing = new Drawing(this.gl);
    this.fence = null;
    this.splats?.store();
    this.highlight = this.marks;
    this.touch(true);
  }

  // Tell the sorting worker of changed slots.
  tell(changed) {
    const capacity = this.splats.capacity;
    for (const [first, count] of changed) {
      for (let from = first; from < first + count; from += SENT) {
        const rows = this.splats.extents(from, Math.min(SENT, first + count - from));
        this.worker.postMessage({ first: from, rows, capacity }, [rows.buffer]);
      }
    }
  }

  // View --------------------------------------------------------------------------------------------------------------

  get camera() {
    return { ...this.view };
  }

  set camera(view) {
    this.view = { ...this.view, ...view };
    this.touch(true);
    this.onCamera?.(this.camera);
  }

  get highlight() {
    return this.marks;
  }

  set highlight({ groups = new Set(), ranges: where = [], color = [1, 0.62, 0.1] }) {
    this.marks = { groups: new Set(groups), ranges: where ?? [], color };
    this.drawing.setMarks(this.marks.groups);
    if (this.flagged || this.marks.ranges.length) this.splats?.flag(SELECTED, this.marks.ranges);
    this.flagged = this.marks.ranges.length > 0;
    this.touch(false);
  }

  get hidden() {
    return this.veiled;
  }

  set hidden(groups) {
    if (groups.size === this.veiled.size && [...groups].every((group) => this.veiled.has(group))) return;
    this.veiled = new Set(groups);
    this.worker.postMessage({ hidden: this.veiled });
    this.touch(true);
  }

  // Pixels of the canvas by CSS pixel.
  get ratio() {
    return this.canvas.width / (this.canvas.clientWidth || this.canvas.width);
  }

  get pinhole() {
    return new Pinhole(this.view, this.canvas.width, this.canvas.height);
  }

  project(point) {
    const found = this.pinhole.project(point);
    return found && { x: found.x / this.ratio, y: found.y / this.ratio, depth: found.depth };
  }

  unproject(x, y, depth) {
    return this.pinhole.unproject(x * this.ratio, y * this.ratio, depth);
  }

  // Picking -----------------------------------------------------------------------------------------------------------

  pick(x, y) {
    if (!this.ready) return null;
    const at = [Math.floor(x * this.ratio), Math.floor(y * this.ratio)];
    const { slots, depths } = heaviest(this.splats, this.ready, this.ready.camera, gridOver(at[0], at[1], at[0] + 1, at[1] + 1));
    if (slots[0] < 0) return null;
    return { slot: slots[0], group: this.splats.group[4 * slots[0] + 3], position: this.unproject(x, y, depths[0]) };
  }

  pickBox(x0, y0, x1, y1) {
    return this.pickRegion([Math.min(x0, x1), Math.min(y0, y1), Math.max(x0, x1), Math.max(y0, y1)], null);
  }

  // points: [[x, y], ...] along the stroke; radius in CSS pixels.
  pickBrush(points, radius) {
    const xs = points.map(([x]) => x);
    const ys = points.map(([, y]) => y);
    const box = [Math.min(...xs) - radius, Math.min(...ys) - radius, Math.max(...xs) + radius, Math.max(...ys) + radius];
    return this.pickRegion(box, (x, y) => points.some((a, i) => distance([x, y], a, points[i + 1] ?? a) <= radius));
  }

  // box: CSS pixels; inside(x, y): whether a point of it counts (null: all do).
  pickRegion(box, inside) {
    if (!this.ready) return [];
    const { width, height } = this.canvas;
    const limits = [width, height, width, height];
    const [x0, y0, x1, y1] = box.map((value, i) => Math.min(Math.max(value * this.ratio, 0), limits[i]));
    if (x1 <= x0 || y1 <= y0) return [];
    const grid = gridOver(x0, y0, x1, y1);
    let open = null;
    if (inside) {
      open = new Uint8Array(grid.columns * grid.rows);
      for (let i = 0; i < open.length; i++) {
        const x = grid.x + grid.step * (i % grid.columns);
        const y = grid.y + grid.step * Math.floor(i / grid.columns);
        open[i] = Number(inside(x / this.ratio, y / this.ratio));
      }
    }
    return ranges(heaviest(this.splats, this.ready, this.ready.camera, grid, open).slots);
  }

  // Pictures ----------------------------------------------------------------------------------------------------------

  // Something changed. sort: whether the order of the slots may have, too.
  touch(sort) {
    if (sort) this.number++;
    this.fresh = false;
    this.asked ??= requestAnimationFrame(() => this.tick());
  }

  tick() {
    this.asked = null;
    if (!this.splats) return this.settle();
    if (this.gl.isContextLost()) return; // `restore` goes on
    this.fit();
    if (this.sortedNumber < this.number && !this.sorting) this.sort(this.comparing ? 1 : 0);
    // While the camera moves, the order of the last view will do if a new one takes long.
    if (this.sortedNumber !== this.number && !(this.ready && this.stats.sort_ms > 25)) return;
    if (this.drawn()) this.draw();
    else this.asked ??= requestAnimationFrame(() => this.tick());
  }

  // Whether the last picture is finished: none is asked for while another is drawn, which would only make what follows wait.
  drawn() {
    const { gl } = this;
    if (!this.fence) return true;
    if (gl.getSyncParameter(this.fence, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
    gl.deleteSync(this.fence);
    this.fence = null;
    return true;
  }

  fit() {
    const { canvas } = this;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [wide, high] = [canvas.clientWidth, canvas.clientHeight].map((size) => Math.max(1, Math.round(size * ratio)));
    if (canvas.width !== wide || canvas.height !== high) [canvas.width, canvas.height] = [wide, high];
  }

  // which: 0 for the only picture; 1 for that after, to be followed by 2 for that before.
  sort(which) {
    const camera = this.pinhole;
    const { position, right, down, forward, focal, width, height, tangents } = camera;
    const margin = 2 / focal; // the reach of the dilation
    this.sorting = true;
    this.sortCamera = camera;
    const buffer = this.spare;
    this.spare = null;
    this.asking = which === 2 ? this.asking : this.number;
    this.worker.postMessage(
      {
        ...{ position, right, down, forward, near: this.near, number: this.asking, which, buffer },
        slopes: [width / 2 / focal + margin, height / 2 / focal + margin],
        clamps: [tangents[1], tangents[3]],
      },
      buffer ? [buffer] : [],
    );
  }

  sorted({ order, count, number, which, ms }) {
    this.sorting = false;
    const name = which === 2 ? 'earlier' : 'ready';
    this.spare = this[name]?.order.buffer;
    this[name] = { order, count, camera: this.sortCamera };
    this.stats.sort_ms = ms;
    if (which === 1 && this.comparing) return this.sort(2);
    this.sortedNumber = number;
    this.tick();
  }

  draw() {
    const camera = this.pinhole;
    const { drawing } = this;
    const began = performance.now();
    const marked = this.marks.groups.size || this.marks.ranges.length;
    const outline = marked ? this.marks.color : null;
    const wide = Math.max(1.5, LINE * this.ratio);
    const line = this.comparing && this.earlier ? Math.round(this.compare * camera.width) : 0;
    const part = line ? [line, camera.width] : null;
    if (line) drawing.picture(this.splats, this.earlier, camera, null, wide, BATCHES, this.background, [0, line]);
    if (line < camera.width) drawing.picture(this.splats, this.ready, camera, outline, wide, BATCHES, this.background, part);
    if (this.fence) this.gl.deleteSync(this.fence);
    this.fence = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    this.gl.flush();
    this.fresh = this.sortedNumber === this.number;
    Object.assign(this.stats, { frame_ms: performance.now() - began, drawn: this.ready.count, slots: this.splats.slots });
    this.onFrame?.(this.stats);
    if (this.fresh) this.settle(); // else the sorting worker answers soon, and the next picture is drawn then
  }

  settle() {
    this.waiting.splice(0).forEach((resolve) => resolve());
  }

  idle() {
    if (this.fresh || !this.splats) return Promise.resolve();
    return new Promise((resolve) => this.waiting.push(resolve));
  }

  // The canvas as a PNG.
  async png() {
    await this.idle();
    this.draw(); // a canvas may be read only in the task that drew it
    return new Promise((resolve) => this.canvas.toBlob(resolve, 'image/png'));
  }

  close() {
    this.observer.disconnect();
    this.stop.abort();
    this.controls.close();
    this.worker.terminate();
    if (this.asked) cancelAnimationFrame(this.asked);
    this.gl.getExtension('WEBGL_lose_context')?.loseContext();
  }
}

const span = (first, count) => Array.from({ length: count }, (_, i) => first + i);

// Ranges of slots as ranges of their copies, in the same order of rows.
function moved(where, copies) {
  const found = [];
  for (const slot of where.flatMap(([first, count]) => span(first, count))) {
    const to = copies.get(slot);
    const last = found[found.length - 1];
    if (last && last[0] + last[1] === to) last[1]++;
    else found.push([to, 1]);
  }
  return found;
}

// From a point to the segment between two others.
function distance([x, y], [ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay];
  const length = dx * dx + dy * dy;
  const share = length ? Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / length)) : 0;
  return Math.hypot(x - ax - share * dx, y - ay - share * dy);
}
