// Moves the camera by mouse, touch and keyboard: around a point (orbit), freely (fly), or at eye height on the floor (walk).
// Drag turns; the wheel or two fingers approach; the right button, Shift or two fingers shift; W A S D Q E and the arrows move.

import { add, cross, dot, norm, scale, turned, unit } from './camera.js';

const TURN = 0.005; // radians a CSS pixel
const EYE = 1.6; // metres above the floor
const KEYS = {
  KeyW: [0, 0, 1], ArrowUp: [0, 0, 1], KeyS: [0, 0, -1], ArrowDown: [0, 0, -1], KeyA: [-1, 0, 0], ArrowLeft: [-1, 0, 0],
  KeyD: [1, 0, 0], ArrowRight: [1, 0, 0], KeyE: [0, 1, 0], PageUp: [0, 1, 0], KeyQ: [0, -1, 0], PageDown: [0, -1, 0],
};

export class OrbitFlyWalk {
  constructor(viewer) {
    this.viewer = viewer;
    this.kind = 'orbit';
    this.up = [0, 0, 1];
    this.floor = null; // height along `up`, scene units; null: unknown
    this.metres = 1; // a scene unit in metres
    this.distance = 3; // scene units from the eye to the point that orbiting turns around
    this.enabled = true; // false: drags belong to a tool of the page
    this.dragged = false; // whether the last press moved the camera, so that its click is none
    this.pointers = new Map();
    this.keys = new Set();
    const { canvas } = viewer;
    this.stop = new AbortController();
    const on = (target, type, handler, options) => target.addEventListener(type, handler, { signal: this.stop.signal, ...options });
    canvas.style.touchAction = 'none';
    if (!canvas.hasAttribute('tabindex')) canvas.tabIndex = 0;
    on(canvas, 'pointerdown', (event) => this.press(event));
    on(canvas, 'pointermove', (event) => this.move(event));
    ['pointerup', 'pointercancel'].forEach((type) => on(canvas, type, (event) => this.pointers.delete(event.pointerId)));
    on(canvas, 'contextmenu', (event) => event.preventDefault());
    on(canvas, 'wheel', (event) => this.wheel(event), { passive: false });
    on(canvas, 'keydown', (event) => this.key(event));
    on(canvas, 'keyup', (event) => this.keys.delete(event.code));
    on(canvas, 'blur', () => this.keys.clear());
  }

  get mode() {
    return this.kind;
  }

  set mode(kind) {
    if (!['orbit', 'fly', 'walk'].includes(kind)) throw new Error(`no such way to move: ${kind}`);
    if (kind === this.kind) return;
    this.kind = kind;
    if (kind === 'walk') this.stand();
  }

  // The point that orbiting turns around.
  get target() {
    const { position, forward } = this.viewer.camera;
    return add(position, unit(forward), this.distance);
  }

  set target(point) {
    const { position } = this.viewer.camera;
    this.distance = Math.max(1e-6, norm(add(point, position, -1)));
    this.viewer.camera = { forward: unit(add(point, position, -1)), up: this.up };
  }

  // To eye height, the camera level.
  stand() {
    const { position, forward } = this.viewer.camera;
    const level = add(forward, this.up, -dot(forward, this.up));
    if (this.floor === null || norm(level) < 1e-6) return;
    const height = this.floor + EYE / this.metres;
    this.viewer.camera = { position: add(position, this.up, height - dot(position, this.up)), forward: unit(level), up: this.up };
  }

  press(event) {
    this.viewer.canvas.focus({ preventScroll: true });
    this.dragged = false;
    if (!this.enabled) return;
    this.viewer.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY, startX: event.clientX, startY: event.clientY });
  }

  move(event) {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer || !this.enabled) return;
    const before = [...this.pointers.values()].map(({ x, y }) => [x, y]);
    const [dx, dy] = [event.clientX - pointer.x, event.clientY - pointer.y];
    if (!this.dragged && Math.hypot(event.clientX - pointer.startX, event.clientY - pointer.startY) < 4) return;
    this.dragged = true;
    [pointer.x, pointer.y] = [event.clientX, event.clientY];
    if (this.pointers.size === 2) {
      const after = [...this.pointers.values()].map(({ x, y }) => [x, y]);
      const span = ([a, b]) => Math.hypot(a[0] - b[0], a[1] - b[1]) || 1;
      this.approach(span(before) / span(after));
      this.shift(dx / 2, dy / 2);
    } else if (event.buttons & 2 || event.buttons & 4 || event.shiftKey) this.shift(dx, dy);
    else this.turn(-dx * TURN, -dy * TURN);
  }

  wheel(event) {
    event.preventDefault();
    if (!this.enabled) return;
    const lines = event.deltaMode === 1 ? 16 : 1;
    this.approach(Math.exp(Math.min(200, Math.max(-200, event.deltaY * lines)) * 0.0015));
  }

  // By angles in radians: to the left, and upwards.
  turn(left, upwards) {
    const { position, forward } = this.viewer.camera;
    const target = this.target;
    let turnedForward = turned(unit(forward), this.up, left);
    const right = unit(cross(turnedForward, this.up));
    const rise = Math.asin(Math.min(1, Math.max(-1, dot(turnedForward, this.up))));
    const limited = Math.min(1.55, Math.max(-1.55, rise + upwards)) - rise;
    turnedForward = turned(turnedForward, right, limited);
    const moved = this.kind === 'orbit' ? add(target, turnedForward, -this.distance) : position;
    this.viewer.camera = { position: moved, forward: turnedForward, up: this.up };
  }

  // Orbiting: the distance to the target, times a factor; otherwise a step forward or back.
  approach(factor) {
    const { position, forward } = this.viewer.camera;
    if (this.kind !== 'orbit') return this.step([0, 0, Math.log(1 / factor) * 2]);
    const nearer = Math.max(2 * this.viewer.near, this.distance * factor);
    const moved = add(position, unit(forward), this.distance - nearer);
    this.distance = nearer;
    this.viewer.camera = { position: moved };
  }

  // Across the view by CSS pixels, so that what lies at the target follows the pointer.
  shift(dx, dy) {
    const { position } = this.viewer.camera;
    const { right, down, focal } = this.viewer.pinhole;
    const size = (this.distance * this.viewer.ratio) / focal;
    this.viewer.camera = { position: add(add(position, right, -dx * size), down, -dy * size) };
  }

  // To the right, up and forward, in metres.
  step([right, upwards, ahead]) {
    const { position, forward } = this.viewer.camera;
    const level = this.kind === 'walk';
    let along = level ? add(forward, this.up, -dot(forward, this.up)) : forward;
    along = norm(along) > 1e-6 ? unit(along) : forward;
    const across = unit(cross(along, this.up));
    let moved = add(add(position, across, right / this.metres), along, ahead / this.metres);
    if (!level) moved = add(moved, this.up, upwards / this.metres);
    this.viewer.camera = { position: moved };
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.code === 'Equal' || event.code === 'NumpadAdd') return this.approach(0.9);
    if (event.code === 'Minus' || event.code === 'NumpadSubtract') return this.approach(1.1);
    if (!KEYS[event.code]) return;
    event.preventDefault();
    const [right, , ahead] = KEYS[event.code];
    if (event.code.startsWith('Arrow') && (this.kind === 'orbit' || event.shiftKey)) return this.turn(-0.05 * right, 0.05 * ahead);
    this.keys.add(event.code);
    this.walking ??= requestAnimationFrame((now) => this.advance(now, now - 16));
  }

  // While keys are held: 1.5 m a second, by the time since the last picture.
  advance(now, before) {
    this.walking = null;
    if (!this.keys.size) return;
    const seconds = Math.min(0.1, (now - before) / 1000);
    const sum = [...this.keys].reduce((total, code) => add(total, KEYS[code]), [0, 0, 0]);
    if (norm(sum) > 0) this.step(scale(unit(sum), 1.5 * seconds));
    this.walking = requestAnimationFrame((later) => this.advance(later, now));
  }

  close() {
    this.stop.abort();
    if (this.walking) cancelAnimationFrame(this.walking);
  }
}
