// Selecting in the picture: a click takes a thing, a second one its part; a box and a brush take Gaussians.

import {byId, el, setAttributes, svg} from "./dom.js";
import {inBox, joined, selectedIn, underBrush} from "./region.js";

const STILL = 5; // CSS pixels that a click may wander
const LONG = 450; // ms after which a still finger counts as a click with Shift

/** `send(message)` speaks to the server, `answer(choice, text)` answers the open question. */
export function selection({store, viewer, send, answer}) {
  const [canvas, drawn] = [byId("canvas"), byId("drawn")];
  clicks(canvas, (x, y, more) => click({store, viewer, send, answer}, x, y, more));
  strokes(store, drawn, viewer, send);
  options(store);
  store.watch(["tool"], ({tool}) => {
    drawn.classList.toggle("catches", tool !== "select");
    setAttributes(canvas, {"data-tool": tool});
  });
}

/** The mode of a click, a box or a stroke: Shift adds, Alt takes away, else as the buttons say. */
const modeOf = (store, event) => (event.altKey ? "remove" : event.shiftKey ? "add" : store.state.mode);

// -- clicks --------------------------------------------------------------------------------------------------------

function clicks(canvas, take) {
  let from = null;
  canvas.addEventListener("pointerdown", (event) => {
    from = event.isPrimary && event.button === 0 ? {x: event.clientX, y: event.clientY, at: event.timeStamp} : null;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (from && Math.hypot(event.clientX - from.x, event.clientY - from.y) > STILL) from = null;
  });
  canvas.addEventListener("pointerup", (event) => {
    if (!from || !event.isPrimary) return;
    const long = event.pointerType === "touch" && event.timeStamp - from.at > LONG;
    from = null;
    const place = canvas.getBoundingClientRect();
    take(event.clientX - place.left, event.clientY - place.top, {shiftKey: event.shiftKey || event.ctrlKey || long, altKey: event.altKey});
  });
}

function click({store, viewer, send, answer}, x, y, event) {
  const {selection, question} = store.state;
  const found = viewer.pick(x, y);
  let mode = modeOf(store, event);
  if (!found) return mode === "set" && send({type: "select", mode: "clear"});
  const candidate = question?.candidates.find((one) => one.group === found.group);
  if (candidate && mode === "set") return answer(candidate.number, `${candidate.number}: ${candidate.name}`);
  if (found.group < 0) return send({type: "select", mode, slot: found.slot});
  const chosen = selection.groups.includes(found.group);
  if (mode === "set" && chosen && selection.groups.length === 1) return send({type: "select", mode: "part", slot: found.slot});
  if (mode === "add" && chosen && !selection.ranges.length) mode = "remove";
  return send({type: "select", mode, group: found.group});
}

// -- boxes and strokes ---------------------------------------------------------------------------------------------

function strokes(store, drawn, viewer, send) {
  let points = null;
  const shape = svg("path", {class: "stroke"});
  const ring = svg("circle", {class: "ring", r: 0});
  drawn.append(shape, ring);
  const at = (event) => {
    const place = drawn.getBoundingClientRect();
    return [event.clientX - place.left, event.clientY - place.top];
  };
  const brushing = () => store.state.tool === "brush";
  const draw = () => {
    const path = points === null ? "" : brushing() ? `M${points.map((p) => p.join(" ")).join("L")}` : boxPath(points[0], points.at(-1));
    setAttributes(shape, {d: path, class: brushing() ? "stroke wide" : "stroke", "stroke-width": brushing() ? 2 * store.state.brush : null});
  };
  const end = () => {
    points = null;
    draw();
  };
  drawn.addEventListener("pointerdown", (event) => {
    if (store.state.tool === "select" || event.button !== 0 || !event.isPrimary || event.target.closest(".handle")) return;
    drawn.setPointerCapture(event.pointerId);
    points = [at(event), at(event)];
    draw();
  });
  drawn.addEventListener("pointermove", (event) => {
    if (brushing()) setAttributes(ring, {cx: at(event)[0], cy: at(event)[1], r: store.state.brush});
    if (!points) return;
    points.push(at(event));
    draw();
  });
  drawn.addEventListener("pointerup", (event) => {
    if (!points) return;
    const [from, to, {brush, selection}] = [points[0], points.at(-1), store.state];
    const mode = modeOf(store, event);
    const inside = brushing() ? underBrush(points, brush) : inBox(from, to);
    let ranges = brushing() ? viewer.pickBrush(points, brush) : viewer.pickBox(...from, ...to);
    if (mode === "remove") ranges = joined(ranges, selectedIn(viewer, selection, inside)); // what is covered goes too
    end();
    if (ranges.length) send({type: "select_slots", mode, ranges});
    else if (mode === "set") send({type: "select", mode: "clear"});
  });
  drawn.addEventListener("pointercancel", end);
  drawn.addEventListener("pointerleave", () => setAttributes(ring, {r: 0}));
  drawn.addEventListener("wheel", (event) => {
    event.preventDefault();
    byId("canvas").dispatchEvent(new WheelEvent("wheel", event)); // the wheel goes on to move the camera
  });
  store.watch(["tool"], () => setAttributes(ring, {r: 0}));
  return end;
}

const boxPath = ([x0, y0], [x1, y1]) => `M${x0} ${y0}H${x1}V${y1}H${x0}Z`;

// -- what a click does ---------------------------------------------------------------------------------------------

const MODES = [["set", "New", "A new selection"], ["add", "Add", "Add to the selection (or hold Shift)"], ["remove", "Take away", "Take away from the selection (or hold Alt)"]];

function options(store) {
  const place = byId("options");
  const buttons = MODES.map(([mode, label, title]) => el("button", {type: "button", title, on: {click: () => store.update({mode})}}, label));
  const size = el("input", {
    type: "range", min: "4", max: "120", value: store.state.brush, "aria-label": "Size of the brush",
    on: {input: () => store.update({brush: Number(size.value)})},
  });
  place.append(el("div", {class: "segments"}, ...buttons), size);
  store.watch(["mode", "tool", "selection"], ({mode, tool, selection}) => {
    buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(MODES[i][0] === mode)));
    size.hidden = tool !== "brush";
    place.hidden = tool === "select" && mode === "set" && !selection.groups.length && !selection.ranges.length;
  });
}
