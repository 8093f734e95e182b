// What the page can do, in one list: the toolbars, the shortcuts and the help are made from it.

import {byId, el, roving} from "./dom.js";
import {icon} from "./icons.js";

/** The commands by name: `label`, `keys` as `event.key` says them ("Ctrl+z"; Meta counts as Ctrl), `run`, and where
 * they depend on the state `enabled(state)` and `pressed(state)`. */
export function commandsOf({store, act}) {
  const has = (state) => state.selection.groups.length > 0 || state.selection.ranges.length > 0;
  const ready = (state) => state.connection === "ready";
  const tool = (name, label, key) => ({label, icon: name, keys: [key], pressed: (s) => s.tool === name, run: () => store.update({tool: name})});
  const gizmo = (name, label, key) => ({
    label, icon: name, keys: [key], pressed: (s) => s.gizmo === name,
    run: () => store.update({gizmo: store.state.gizmo === name ? null : name}),
  });
  const way = (name, label, key) => ({label, icon: name, keys: [key], pressed: (s) => s.controls === name, run: () => store.update({controls: name})});
  return {
    things: {label: "Things", icon: "things", keys: ["l"], told: "Show or hide the list of things", run: act.toggleThings, expanded: act.thingsShown},
    select: {...tool("select", "Select", "v"), told: "Select by a click"},
    box: {...tool("box", "Box", "b"), told: "Select with a box"},
    brush: {...tool("brush", "Brush", "n"), told: "Select with a brush"},
    move: {...gizmo("move", "Move", "m"), told: "Move the selection"},
    rotate: {...gizmo("rotate", "Turn", "t"), told: "Turn the selection"},
    scale: {...gizmo("scale", "Size", "z"), told: "Change the selection's size"},
    orbit: {...way("orbit", "Orbit", "1"), told: "Turn around the scene"},
    fly: {...way("fly", "Fly", "2"), told: "Fly through the scene"},
    walk: {...way("walk", "Walk", "3"), told: "Walk on the floor"},
    frame: {label: "Frame", icon: "frame", keys: ["."], told: "Look at the selection, or at all", run: act.frame},
    undo: {label: "Undo", icon: "undo", keys: ["Ctrl+z"], enabled: (s) => ready(s) && s.canUndo, run: act.undo},
    redo: {label: "Redo", icon: "redo", keys: ["Ctrl+Shift+z", "Ctrl+y"], enabled: (s) => ready(s) && s.canRedo, run: act.redo},
    compare: {
      label: "Compare", icon: "compare", keys: ["c"], told: "Before and after the last edit, with a slider",
      enabled: (s) => s.canUndo || s.compare !== null, pressed: (s) => s.compare !== null, run: act.compare,
    },
    play: {label: "Play", icon: "play", keys: ["y"], told: "Play what moves, or pause", enabled: (s) => Boolean(s.motion), pressed: (s) => s.playing, run: act.play},
    save: {label: "Save", icon: "save", keys: ["Ctrl+s"], told: "Save the scene as a file", enabled: ready, run: act.save},
    export: {label: "Export", icon: "export", keys: ["x"], told: "One page that shows the scene anywhere", enabled: ready, run: act.export},
    snapshot: {label: "Snapshot", icon: "snapshot", keys: ["p"], told: "The picture as a PNG", enabled: (s) => s.scene !== null, run: act.snapshot},
    theme: {label: "Theme", icon: "theme", keys: ["k"], told: "Dark, light, or as the system", run: act.theme},
    help: {label: "Help", icon: "help", keys: ["?"], told: "This list", run: act.help},
    hide: {label: "Hide", icon: "hidden", keys: ["h"], told: "Hide the selection, or show it again", enabled: (s) => s.selection.groups.length > 0, run: act.hide},
    showAll: {label: "Show all", icon: "shown", keys: ["Shift+H"], told: "Show everything that is hidden", enabled: (s) => s.hidden.size > 0, run: act.showAll},
    clear: {label: "Clear", icon: "clear", keys: ["Escape"], told: "Clear the selection, close what is open", enabled: has, run: act.clear},
    words: {label: "Say", icon: "chat", keys: ["/"], told: "Go to the words", run: act.words},
  };
}

/** A key as the list of commands writes it: "Ctrl+Shift+z", "?", "l". */
export function pressedKey(event) {
  const control = event.ctrlKey || event.metaKey;
  const letter = event.key.length === 1 && (control || !event.shiftKey) ? event.key.toLowerCase() : event.key;
  const shift = event.shiftKey && (control || /^[a-z]$/i.test(event.key));
  return `${control ? "Ctrl+" : ""}${shift ? "Shift+" : ""}${letter}`;
}

/** Fills a toolbar with buttons for commands; "|" makes a gap. */
export function fill(place, names, commands, store) {
  const buttons = [];
  for (const name of names) {
    if (name === "|") {
      place.append(el("span", {class: "gap", "aria-hidden": "true"}));
      continue;
    }
    const command = commands[name];
    const keys = command.keys.map((key) => key.replace("Ctrl", "Control")).join(" ");
    const title = `${command.told ?? command.label} (${command.keys[0]})`;
    const button = el(
      "button", {type: "button", class: "tool", "data-command": name, "aria-keyshortcuts": keys, title, on: {click: command.run}},
      icon(command.icon), el("span", {}, command.label),
    );
    place.append(button);
    buttons.push([button, command]);
  }
  const settle = place.getAttribute("role") === "toolbar" ? roving(place) : () => {};
  store.watch(Object.keys(store.state), (state) => {
    for (const [button, {enabled, pressed}] of buttons) {
      if (enabled) button.setAttribute("aria-disabled", String(!enabled(state)));
      if (pressed) button.setAttribute("aria-pressed", String(pressed(state)));
    }
  });
  settle();
  new ResizeObserver(settle).observe(place);
  place.addEventListener("click", refuse, {capture: true});
}

/** A button that cannot do anything now keeps its focus and does nothing. */
function refuse(event) {
  if (event.target.closest('[aria-disabled="true"]')) event.stopPropagation();
}

const shownKey = (key) => key.split("+").map((part) => (part.length === 1 ? part.toUpperCase() : part)).join(" ");

/** Fills the help with every command and its keys. */
export function fillHelp(commands, further) {
  const row = (keys, told) => el("tr", {}, el("td", {}, ...keys.flatMap((key) => [el("kbd", {}, shownKey(key)), " "])), el("td", {}, told));
  const rows = Object.values(commands).map(({keys, told, label}) => row(keys, told ?? label));
  const close = el("button", {type: "button", class: "primary", autofocus: true, on: {click: () => byId("help").close()}}, "Close");
  byId("help").append(
    el("h2", {id: "help-title"}, "What you can do"),
    el("div", {class: "scrolls", tabindex: "0", role: "region", "aria-label": "Shortcuts"}, el("table", {}, el("tbody", {}, ...further.map(([keys, told]) => row(keys, told)), ...rows))),
    el("div", {class: "actions"}, close),
  );
}
