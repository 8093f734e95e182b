// Handles over the selection: move, turn and size. A drag shows the boxes where they will be and sends one operation,
// in the words of the viewer (right, forward, up), as typed words would.

import {byId, setAttributes, svg} from "./dom.js";
import {EDGES, alongLine, cornersOf, middleOf, onPlane, reachOf, sight, viewerAxes} from "./space.js";
import {add, cross, dot, norm, scale, turned, unit} from "./viewer/camera.js";

const REACH = 88; // CSS pixels from the middle to the end of a handle
const WORDS = {right: ["right", "left"], forward: ["forward", "backward"], up: ["up", "down"]};
const SIDES = {right: "width", forward: "depth", up: "height"};
const TELLS = {move: "Move", rotate: "Turn about", scale: "Stretch"};
const STEPS = {move: 0.05, rotate: 5, scale: 0.05}; // of an arrow key: metres or units, degrees, share
const SNAP = {move: 0.01, rotate: 5, scale: 0.01};
const IDLE = {amount: {}, shown: false};

export class Gizmo {
  #drag = null;
  #change = IDLE; // amounts by axis: metres or units, degrees, or a factor
  #handles = [];

  /** `operate(ops, text)` sends operations on the selection as one step. */
  constructor({store, viewer, operate}) {
    Object.assign(this, {store, viewer, operate});
    this.drawn = byId("drawn");
    this.boxes = svg("path", {class: "ghost"});
    this.layer = svg("g", {class: "handles"});
    this.label = svg("text", {class: "amount"});
    this.drawn.append(this.boxes, this.layer, this.label);
    this.drawn.addEventListener("pointermove", (event) => this.#moved(event));
    this.drawn.addEventListener("pointerup", () => this.#drop());
    this.drawn.addEventListener("pointercancel", () => this.cancel());
    store.watch(["gizmo"], ({gizmo}) => this.#build(gizmo));
    store.watch(["selection", "things", "connection", "compare"], () => this.cancel());
  }

  /** Whether something is dragged or being set by keys. */
  get busy() {
    return this.#change.shown;
  }

  cancel() {
    this.#drag = null;
    this.#change = IDLE;
    this.draw();
  }

  // -- what is there -----------------------------------------------------------------------------------------------

  /** The boxes of what is selected. */
  get #selected() {
    const {selection, things} = this.store.state;
    if (selection.box) return [selection.box];
    return things.filter((thing) => selection.groups.includes(thing.group) && thing.box).map((thing) => thing.box);
  }

  get #metres() {
    return this.store.state.scene?.metres_per_unit ?? 1;
  }

  get #axes() {
    return viewerAxes(this.viewer.camera, this.store.state.scene.up);
  }

  #build(kind) {
    this.layer.replaceChildren();
    this.#handles = [];
    if (kind === null) return this.cancel();
    const names = kind === "rotate" ? ["up", "right", "forward"] : ["right", "forward", "up"];
    for (const axis of names) this.#handle(axis, kind === "rotate" ? this.#ring() : this.#arrow(kind), `${TELLS[kind]} ${kind === "scale" ? SIDES[axis] : axis}`);
    if (kind === "move") this.#handle("floor", [svg("circle", {class: "knob", r: 9})], null);
    if (kind === "scale") this.#handle("all", [svg("circle", {class: "knob", r: 9})], "Size");
    this.cancel();
  }

  #arrow(kind) {
    const end = kind === "move" ? svg("path", {class: "tip", d: "M0 0L-14 -7V7Z"}) : svg("rect", {class: "tip", x: -7, y: -7, width: 14, height: 14, rx: 2});
    return [svg("path", {class: "grip"}), svg("path", {class: "shaft"}), end];
  }

  #ring() {
    return [svg("path", {class: "grip"}), svg("path", {class: "shaft"})];
  }

  /** A handle by pointer and, with words for it, by keys. */
  #handle(axis, parts, told) {
    const group = svg("g", {class: `handle ${axis}`}, ...parts);
    if (told) setAttributes(group, {tabindex: 0, role: "slider", "aria-label": told, "aria-valuenow": 0, "aria-valuetext": "0"});
    group.addEventListener("pointerdown", (event) => this.#grab(axis, event));
    group.addEventListener("keydown", (event) => this.#key(axis, event));
    group.addEventListener("blur", () => this.#drag || this.cancel());
    this.layer.append(group);
    this.#handles.push({axis, group});
  }

  // -- drags -------------------------------------------------------------------------------------------------------

  #grab(axis, event) {
    if (event.button !== 0 || !event.isPrimary) return;
    event.preventDefault();
    event.stopPropagation();
    this.drawn.setPointerCapture(event.pointerId);
    const {centre} = middleOf(this.#selected);
    this.#drag = {axis, centre, axes: this.#axes};
    this.#drag.from = this.#measure(event);
    this.#change = {amount: {}, shown: true};
  }

  /** Where the pointer is for the handle that is dragged: a length along its axis, a place, an angle, or pixels. */
  #measure(event) {
    const place = this.drawn.getBoundingClientRect();
    const [x, y] = [event.clientX - place.left, event.clientY - place.top];
    const {axis, axes, centre} = this.#drag;
    const [eye, look] = [this.viewer.camera.position, sight(this.viewer, x, y)];
    const {gizmo} = this.store.state;
    if (axis === "floor") return onPlane(centre, axes.up, eye, look);
    if (axis === "all") return y - x;
    if (gizmo === "rotate") return this.#angle(x, y, eye, look);
    return alongLine(centre, axes[axis], eye, look);
  }

  /** The angle of the pointer about the dragged axis, degrees; seen from the side, by pixels. */
  #angle(x, y, eye, look) {
    const {axis, axes, centre} = this.#drag;
    if (Math.abs(dot(look, axes[axis])) < 0.12) return axis === "up" ? x / 2 : -y / 2;
    const spot = onPlane(centre, axes[axis], eye, look);
    if (!spot) return null;
    const [first, second] = planeOf(axes, axis);
    const arm = add(spot, centre, -1);
    return (Math.atan2(dot(arm, second), dot(arm, first)) * 180) / Math.PI;
  }

  #moved(event) {
    if (!this.#drag) return;
    const now = this.#measure(event);
    if (now === null || this.#drag.from === null) return;
    const {axis, axes, from} = this.#drag;
    const free = event.shiftKey;
    const {gizmo} = this.store.state;
    if (axis === "floor") {
      const way = scale(add(now, from, -1), this.#metres);
      this.#set({right: snapped(dot(way, axes.right), gizmo, free), forward: snapped(dot(way, axes.forward), gizmo, free)});
    } else if (gizmo === "rotate") {
      this.#set({[axis]: snapped(((now - from + 540) % 360) - 180, gizmo, free)});
    } else if (gizmo === "move") {
      this.#set({[axis]: snapped((now - from) * this.#metres, gizmo, free)});
    } else {
      this.#set({[axis]: this.#factor(axis, now - from, free)});
    }
  }

  /** The factor of a drag: the face that the handle stands for follows the pointer. */
  #factor(axis, way, free) {
    if (axis === "all") return clampFactor(snapped(Math.exp(-way / 220), "scale", free));
    const [low, high] = reachOf(this.#selected, this.#axes[axis]);
    const moved = axis === "up" ? way : 2 * way; // it stands on its foot, and widens to both sides
    return clampFactor(snapped((high - low + moved) / (high - low), "scale", free));
  }

  #set(amount) {
    this.#change = {amount, shown: true};
    this.draw();
  }

  #drop() {
    if (this.#drag) this.#send();
  }

  #send() {
    const {amount} = this.#change;
    const kind = this.store.state.gizmo;
    const ops = Object.entries(amount).map(([axis, value]) => operation(kind, axis, value, this.store.state.scene.metres_per_unit)).filter(Boolean);
    const told = this.#told();
    this.#drag = null;
    if (ops.length) this.operate(ops, `${told.slice(0, 1).toUpperCase()}${told.slice(1)}`);
    this.cancel();
  }

  #key(axis, event) {
    const kind = this.store.state.gizmo;
    const step = {ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 4, PageDown: -4}[event.key];
    if (event.key === "Enter" && this.#change.shown) this.#send();
    else if (event.key === "Escape" && this.#change.shown) this.cancel();
    else if (step) {
      const rest = kind === "scale" ? 1 : 0;
      const value = (this.#change.amount[axis] ?? rest) + step * STEPS[kind];
      this.#set({[axis]: kind === "scale" ? clampFactor(value) : value});
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }

  // -- drawing -----------------------------------------------------------------------------------------------------

  /** What the change is, in words: "move right 0.40 m". */
  #told() {
    const {gizmo} = this.store.state;
    const unit = this.store.state.scene?.metres_per_unit ? "m" : "units";
    const parts = Object.entries(this.#change.amount).map(([axis, value]) => {
      if (gizmo === "move") return Math.abs(value) < 5e-4 ? "" : `${WORDS[axis][value < 0 ? 1 : 0]} ${Math.abs(value).toFixed(2)} ${unit}`;
      if (gizmo === "rotate") return `${Math.round(value)}° about ${axis}`;
      return `${axis === "all" ? "" : `${SIDES[axis]} `}${value.toFixed(2)} times`;
    });
    return `${{move: "move", rotate: "turn", scale: "size"}[gizmo]} ${parts.filter(Boolean).join(", ")}`.trim();
  }

  draw() {
    const {scene, gizmo, compare} = this.store.state;
    const boxes = scene && gizmo && compare === null ? this.#selected : [];
    const shown = boxes.length > 0;
    setAttributes(this.layer, {hidden: !shown, display: shown ? null : "none"});
    const changed = this.#change.shown && shown;
    setAttributes(this.boxes, {d: changed ? boxes.map((box) => this.#edges(box)).join("") : ""});
    this.label.textContent = changed ? this.#told() : "";
    if (!shown) return;
    const {centre} = this.#drag ?? middleOf(boxes);
    const axes = this.#drag?.axes ?? this.#axes;
    const middle = this.viewer.project(centre);
    setAttributes(this.layer, {display: middle ? null : "none"});
    if (!middle) return;
    const length = norm(add(this.viewer.unproject(middle.x + REACH, middle.y, middle.depth), centre, -1));
    const at = this.#shift(centre, axes);
    for (const {axis, group} of this.#handles) this.#place(axis, group, at, axes, length);
    if (changed) this.#placeLabel(at);
  }

  /** Where the handles go while a move is dragged. */
  #shift(centre, axes) {
    if (this.store.state.gizmo !== "move") return centre;
    return Object.entries(this.#change.amount).reduce((at, [axis, value]) => add(at, axes[axis], value / this.#metres), centre);
  }

  #place(axis, group, at, axes, length) {
    const [from, {gizmo}] = [this.viewer.project(at), this.store.state];
    const value = this.#change.amount[axis];
    if (group.hasAttribute("role")) setAttributes(group, {"aria-valuenow": value ?? (gizmo === "scale" ? 1 : 0), "aria-valuetext": value === undefined ? "unchanged" : this.#told()});
    if (!from) return;
    if (axis === "floor" || axis === "all") return setAttributes(group, {transform: `translate(${from.x} ${from.y})`});
    if (gizmo === "rotate") return setPaths(group, this.#ringPath(axis, at, axes, length));
    const end = this.viewer.project(add(at, axes[axis], length));
    if (!end) return;
    const [dx, dy] = [end.x - from.x, end.y - from.y];
    setAttributes(group, {class: `handle ${axis}${Math.hypot(dx, dy) < 18 ? " faint" : ""}`});
    setPaths(group, `M${from.x + 0.16 * dx} ${from.y + 0.16 * dy}L${end.x - 0.08 * dx} ${end.y - 0.08 * dy}`);
    setAttributes(group.lastChild, {transform: `translate(${end.x} ${end.y}) rotate(${(Math.atan2(dy, dx) * 180) / Math.PI})`});
  }

  #ringPath(axis, at, axes, length) {
    const [first, second] = planeOf(axes, axis);
    const points = [...Array(65).keys()].map((i) => {
      const angle = (i * Math.PI) / 32;
      return this.viewer.project(add(add(at, first, length * Math.cos(angle)), second, length * Math.sin(angle)));
    });
    return points.every(Boolean) ? `M${points.map(({x, y}) => `${x} ${y}`).join("L")}` : "";
  }

  #placeLabel(at) {
    const {x, y} = this.viewer.project(at) ?? {x: -999, y: -999};
    setAttributes(this.label, {x, y: y - REACH - 14});
  }

  /** The edges of a box where the change puts it. */
  #edges(box) {
    const corners = cornersOf(box).map((corner) => this.viewer.project(this.#changed(corner, box)));
    return EDGES.map(([a, b]) => (corners[a] && corners[b] ? `M${corners[a].x} ${corners[a].y}L${corners[b].x} ${corners[b].y}` : "")).join("");
  }

  #changed(corner, box) {
    const axes = this.#drag?.axes ?? this.#axes;
    const kind = this.store.state.gizmo;
    const foot = add(box.centre, axes.up, reachOf([box], axes.up)[0] - dot(box.centre, axes.up));
    return Object.entries(this.#change.amount).reduce((point, [axis, value]) => {
      if (kind === "move") return add(point, axes[axis], value / this.#metres);
      if (kind === "rotate") return add(box.centre, turned(add(point, box.centre, -1), unit(axes[axis]), (value * Math.PI) / 180));
      const arm = add(point, foot, -1);
      return axis === "all" ? add(foot, arm, value) : add(point, axes[axis], dot(arm, axes[axis]) * (value - 1));
    }, corner);
  }
}

/** Two unit vectors that span the plane about an axis, counter-clockwise seen from its tip. */
function planeOf(axes, axis) {
  const first = axis === "right" ? axes.up : axes.right;
  return [first, cross(axes[axis], first)];
}

function setPaths(group, path) {
  for (const part of group.querySelectorAll(".grip, .shaft")) setAttributes(part, {d: path});
}

function snapped(value, kind, free) {
  const step = free ? 1e-3 : SNAP[kind];
  return Math.round(value / step) * step;
}

const clampFactor = (factor) => Math.min(Math.max(factor, 0.05), 20);

/** One operation of tools/ops on the selection; null if it would change nothing. */
function operation(kind, axis, value, metres) {
  const target = {last: true};
  const rounded = Number(Math.abs(value).toFixed(4));
  if (kind === "move") {
    if (rounded < 1e-3) return null;
    return {op: "move", target, direction: WORDS[axis][value < 0 ? 1 : 0], distance: {value: rounded, unit: metres ? "m" : "units"}};
  }
  if (kind === "rotate") return rounded < 0.05 ? null : {op: "rotate", target, degrees: Number(value.toFixed(2)), axis};
  return Math.abs(value - 1) < 1e-3 ? null : {op: "scale", target, factor: rounded, axis: axis === "all" ? "all" : SIDES[axis]};
}
