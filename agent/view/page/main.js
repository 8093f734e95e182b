// The page of `scenewright view`: joins the server, the picture and what lies around it.
//
//   server -> connection -> store -> what is drawn;   click, key, words -> command -> connection -> server

import {Candidates} from "./candidates.js";
import {chat} from "./chat.js";
import {Connection} from "./connection.js";
import {addNote, addTurn, answerTurn, keepTurns, keptTurns, takeHistory, waiting} from "./conversation.js";
import {download, saveDialog} from "./dialogs.js";
import {byId, el} from "./dom.js";
import {Gizmo} from "./gizmo.js";
import {keys} from "./keys.js";
import {notice} from "./notice.js";
import {moreButton, panels} from "./panels.js";
import {keepPlace, takePlace} from "./place.js";
import {selectedBar} from "./selected.js";
import {selection} from "./selection.js";
import {slider} from "./slider.js";
import {middleOf} from "./space.js";
import {Store, initialState} from "./store.js";
import {theme} from "./theme.js";
import {timeline} from "./timeline.js";
import {things, toggle} from "./things.js";
import {commandsOf, fill, fillHelp} from "./toolbar.js";
import {add, dot, norm, scale} from "./viewer/camera.js";
import {SplatViewer} from "./viewer/viewer.js";

const store = new Store({...initialState(), ...keptTurns()});
const layers = []; // what is drawn over the picture, and again with each move of the camera
const viewer = makeViewer();
const connection = new Connection({
  revision: () => (store.state.loaded === 1 ? store.state.revision : null),
  onMessage, onColumns, onStatus, onLost,
});

const send = (message) => connection.send(message);

// -- the picture ---------------------------------------------------------------------------------------------------

/** The renderer; where there is no WebGL2, one that draws nothing, so that the conversation still works. */
function makeViewer() {
  try {
    const redraw = () => layers.forEach((layer) => layer.draw());
    return new SplatViewer(byId("canvas"), {onCamera: redraw, onFrame: () => {}});
  } catch (error) {
    store.update({trouble: error.message});
    return blind();
  }
}

function blind() {
  const nothing = () => null;
  const camera = {position: [0, -5, 1.6], forward: [0, 1, 0], up: [0, 0, 1], fov_y: 50};
  return {camera, controls: {}, splats: {slots: 0}, decode: nothing, setBefore: nothing, pick: nothing, pickBox: () => [], pickBrush: () => [], project: nothing, unproject: nothing, png: nothing};
}

/** The camera as the server wants it. */
function cameraNow() {
  const {position, forward, up, fov_y} = viewer.camera;
  const {clientWidth, clientHeight} = byId("canvas");
  return {position, forward, up, fov_y, width: clientWidth, height: clientHeight};
}

/** Looks from a camera of the server; where the page is narrower, with a wider view, so that its sides are in sight. */
function lookFrom({position, forward, up, fov_y, width, height}) {
  const canvas = byId("canvas");
  const narrower = Math.max(1, Math.min(1.5, (width / height) * (canvas.clientHeight / canvas.clientWidth)));
  const half = Math.atan(Math.tan((fov_y * Math.PI) / 360) * narrower);
  viewer.camera = {position, forward, up, fov_y: (half * 360) / Math.PI};
  const [low, high] = store.state.scene.bounds;
  const ahead = dot(add(scale(add(low, high), 0.5), position, -1), forward);
  viewer.controls.distance = ahead > 0 ? ahead : norm(add(high, low, -1)) / 4; // what orbiting turns around
}

// -- what the server says ------------------------------------------------------------------------------------------

function onMessage(message) {
  const take = {welcome: onWelcome, state: onState, progress: onProgress, said: onSaid, error: onError}[message.type];
  if (take) take(message);
}

function onWelcome(scene) {
  const first = store.state.scene === null;
  if (first && store.state.run !== scene.run) store.update({turns: [], told: 0}); // kept from another scene or server
  store.update({scene, run: scene.run, connection: store.state.loaded === 1 ? "ready" : "loading"});
  document.title = `${scene.title} – Scenewright`;
  byId("title").textContent = scene.title;
  Object.assign(viewer.controls, {up: scene.up, floor: scene.floor, metres: scene.metres_per_unit});
  if (first && !takePlace(store, viewer)) lookFrom(scene.camera);
  if (scene.slots === 0) store.update({loaded: 1, revision: scene.revision, connection: "ready"});
}

function onState(state) {
  const {digest, things, selection, question, history, can_undo, can_redo, embedded, motion, busy} = state;
  if (!waiting(store.state)) takeHistory(store, history, store.state.told);
  store.update({told: history.length, digest, things, selection, question, history, canUndo: can_undo, canRedo: can_redo, embedded, motion, busy});
  if (!busy) store.update({progress: null});
}

function onProgress({id, stage, share}) {
  store.update({progress: {id, stage, share}});
}

function onSaid({id, ...answer}) {
  store.update({progress: null});
  answerTurn(store, id, answer);
  if (answer.camera) lookFrom(answer.camera);
}

function onError({id, text}) {
  store.update({progress: null});
  if (time.failed(id)) return;
  const answer = {ok: false, wrong: true, text};
  if (!answerTurn(store, id, answer)) addNote(store, answer);
}

function onColumns(header, buffer) {
  if (header.type === "before") return compare.take(buffer);
  if (header.type === "frame") return time.take(header, buffer);
  if (header.base !== null && header.base !== store.state.revision) return connection.resume(null);
  time.leave(header.base === null);
  viewer.decode(buffer);
  const [number, of] = header.chunk;
  const whole = header.base !== null || number + 1 === of;
  store.update({loaded: whole ? 1 : (number + 1) / of, revision: header.revision, connection: whole ? "ready" : "loading"});
}

function onStatus(connection) {
  if (connection === "lost" && store.state.scene === null) return store.update({connection: "connecting"});
  store.update({connection, progress: null, loaded: store.state.loaded === 1 ? 1 : 0});
}

/** The connection closed before these messages were answered: what they did shows in the state that comes next. */
function onLost(messages) {
  for (const {id} of messages) answerTurn(store, id, {ok: false, wrong: true, text: "The connection was lost before the answer came. If it was done, the scene shows it."});
}

// -- what a person does --------------------------------------------------------------------------------------------

function say(text) {
  addTurn(store, text, send({type: "say", text, camera: cameraNow()}), true);
}

function answer(choice, text) {
  addTurn(store, text, send({type: "answer", choice}));
}

function operate(ops, text) {
  addTurn(store, text, send({type: "operate", ops, camera: cameraNow()}));
}

const point = (group) => store.update({pointed: group});

/** Looks at what is selected, or at the whole scene, from where the camera looks now. */
function frame() {
  const {selection, things, scene} = store.state;
  const boxes = things.filter((thing) => thing.box && selection.groups.includes(thing.group)).map((thing) => thing.box);
  if (!boxes.length) return scene && lookFrom(scene.camera);
  const {centre, radius} = middleOf(boxes);
  const camera = viewer.camera;
  const wide = byId("canvas").clientWidth / byId("canvas").clientHeight;
  const half = (camera.fov_y * Math.PI) / 360;
  const away = (1.3 * radius) / Math.sin(Math.min(half, Math.atan(Math.tan(half) * wide)));
  viewer.camera = {...camera, position: add(centre, camera.forward, -Math.max(away, 2 * scene.near, 1e-3 * norm(centre)))};
}

async function snapshot() {
  download(await viewer.png(), `${store.state.scene.title.replace(/\.[^.]+$/, "")}.png`);
}

function clear() {
  if (gizmo.busy) gizmo.cancel();
  else if (store.state.selection.groups.length || store.state.selection.ranges.length) send({type: "select", mode: "clear"});
  store.update({gizmo: null});
}

const around = panels(store);
const colours = theme((told) => {
  const button = document.querySelector('[data-command="theme"]');
  if (button) button.title = `${told} (k)`;
});
const askName = saveDialog((name, force) => addTurn(store, `Save as ${name}`, send({type: "save", name, force})));
const compare = slider({store, viewer, ask: () => send({type: "before"})});
const time = timeline({store, viewer, send});
const gizmo = new Gizmo({store, viewer, operate});
layers.push(gizmo, new Candidates({store, viewer, answer, point}));

const commands = commandsOf({
  store,
  act: {
    toggleThings: around.toggleThings,
    frame, snapshot, clear,
    undo: () => addTurn(store, "Undo", send({type: "undo"})),
    redo: () => addTurn(store, "Redo", send({type: "redo"})),
    compare: compare.toggle,
    play: time.toggle,
    save: () => askName(store.state.scene.title),
    export: () => addTurn(store, "Export as a page", send({type: "export"})),
    theme: colours.next,
    help: () => byId("help").showModal(),
    hide: () => toggle(store, store.state.selection.groups),
    showAll: () => store.update({hidden: new Set()}),
    words: () => {
      around.showChat();
      byId("words").focus();
    },
  },
});

const further = el("div", {id: "further", class: "group"});
fill(byId("left-commands"), ["things"], commands, store);
fill(byId("commands"), ["undo", "redo", "compare"], commands, store);
fill(further, ["save", "export", "snapshot", "theme", "help"], commands, store);
moreButton(byId("commands"), further);
byId("commands").append(further);
fill(byId("tools"), ["select", "box", "brush", "|", "move", "rotate", "scale"], commands, store);
fill(byId("time-commands"), ["play"], commands, store);
fill(byId("views"), ["orbit", "fly", "walk", "|", "frame"], commands, store);
fillHelp(commands, [
  [["Drag"], "Look around"], [["Wheel"], "Nearer, farther"], [["Click"], "Select a thing; again: its part"],
  [["Shift+click", "Long touch"], "Add to the selection"], [["Alt+drag"], "With the box or brush: take away"], [["1 to 9"], "Answer with a numbered candidate"],
]);

notice(store);
keepTurns(store);
keepPlace(store, viewer);
chat({store, say, answer, point});
things({store, point, select: (group, mode) => send({type: "select", mode, group})});
selection({store, viewer, send, answer});
selectedBar(store, commands);
keys({store, commands, answer});

store.watch(["selection", "pointed"], ({selection, pointed}) => {
  const groups = new Set(selection.groups);
  viewer.highlight = {groups: pointed === null ? groups : groups.add(pointed), ranges: selection.ranges};
});
store.watch(["hidden"], ({hidden}) => {
  viewer.hidden = hidden;
});
store.watch(["controls"], ({controls}) => {
  viewer.controls.mode = controls;
});
new ResizeObserver(() => layers.forEach((layer) => layer.draw())).observe(byId("stage"));

Object.assign(window, {scenewright: {store, viewer}}); // for the console and for tests
