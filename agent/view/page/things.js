// The list of things: colour, name, an eye that hides. Hiding is not deleting: the server hears nothing of it.

import {byId, el, roving} from "./dom.js";
import {icon} from "./icons.js";

const FILTER_FROM = 12; // things, from which the list has a filter

/** `select(group, mode)` selects; `point(group | null)` shows what the pointer is on. */
export function things({store, select, point}) {
  const [list, note, filter] = [byId("things-list"), byId("things-note"), byId("things-filter")];
  const settle = roving(list);
  const draw = (state) => {
    const sought = filter.value.trim().toLowerCase();
    const shown = state.things.filter((thing) => thing.name.toLowerCase().includes(sought));
    const stop = list.querySelector('[tabindex="0"]')?.dataset.stop;
    const focused = document.activeElement?.closest?.("#things-list button")?.dataset.stop;
    list.replaceChildren(...shown.map((thing) => row(thing, state, {store, select, point})));
    const again = list.querySelector(`[data-stop="${focused ?? stop}"]`);
    if (again) again.tabIndex = 0;
    if (focused) again?.focus();
    filter.hidden = state.things.length < FILTER_FROM;
    byId("things-count").textContent = state.things.length ? String(state.things.length) : "";
    note.textContent = noteOf(state, shown);
    note.hidden = !note.textContent;
    settle();
  };
  filter.addEventListener("input", () => draw(store.state));
  store.watch(["things", "selection", "hidden", "embedded", "connection"], draw);
}

function row(thing, state, {store, select, point}) {
  const hidden = state.hidden.has(thing.group);
  const chosen = state.selection.groups.includes(thing.group);
  const swatch = el("span", {class: "swatch", "aria-hidden": "true"});
  swatch.style.background = cssColor(thing.color);
  const name = el(
    "button",
    {
      type: "button", class: "thing", "aria-pressed": String(chosen), "data-stop": `name-${thing.group}`,
      on: {
        click: (event) => select(thing.group, event.shiftKey || event.ctrlKey ? (chosen ? "remove" : "add") : "set"),
        focus: () => point(thing.group), blur: () => point(null),
      },
    },
    swatch, el("span", {class: "name"}, thing.name || `thing ${thing.group}`),
  );
  const eye = el(
    "button",
    {
      type: "button", class: "eye", "aria-pressed": String(hidden), "aria-label": `Hide ${thing.name || thing.group}`,
      "data-stop": `eye-${thing.group}`, title: hidden ? "Show" : "Hide", on: {click: () => toggle(store, [thing.group])},
    },
    icon(hidden ? "hidden" : "shown"),
  );
  return el("li", {class: hidden ? "away" : "", on: {pointerenter: () => point(thing.group), pointerleave: () => point(null)}}, name, eye);
}

/** Hides groups, or shows them if all of them are hidden. */
export function toggle(store, groups) {
  const hidden = new Set(store.state.hidden);
  const all = groups.every((group) => hidden.has(group));
  for (const group of groups) all ? hidden.delete(group) : hidden.add(group);
  store.update({hidden});
}

/** A colour of the server in CSS: display space, shares or a text. */
function cssColor(color) {
  if (typeof color === "string") return color;
  return color ? `rgb(${color.map((share) => `${Math.round(share * 100)}%`).join(" ")})` : "transparent";
}

function noteOf(state, shown) {
  if (state.things.length) return shown.length ? "" : "No thing has such a name.";
  if (state.connection !== "ready") return "";
  return state.embedded ? "There are no things in this scene." : "The things are found when you first name, ask for or click one.";
}
