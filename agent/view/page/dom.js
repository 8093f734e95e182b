// Builds elements. What is said is only ever set as text, never as HTML.

/** An element with attributes, listeners (`on: {click: f}`) and children; strings become text nodes, null is left out. */
export function el(name, {on = {}, ...attributes} = {}, ...children) {
  const made = document.createElement(name);
  setAttributes(made, attributes);
  for (const [event, listener] of Object.entries(on)) made.addEventListener(event, listener);
  made.append(...children.flat().filter((child) => child !== null));
  return made;
}

const SVG = "http://www.w3.org/2000/svg";

/** The same for a picture's element. */
export function svg(name, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, name);
  setAttributes(made, attributes);
  made.append(...children);
  return made;
}

/** Sets attributes; true gives an empty one, false and null take it away. */
export function setAttributes(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === false || value === null || value === undefined) element.removeAttribute(name);
    else element.setAttribute(name, value === true ? "" : value);
  }
}

export const byId = (id) => document.getElementById(id);

/** Whether what is pressed now is text for a field. */
export function typing(target) {
  return target instanceof HTMLElement && target.closest("textarea, select, input:not([type=range], [type=checkbox])") !== null;
}

/** One tab stop for a group of buttons: the arrow keys move within it, Home and End go to its ends. */
export function roving(group, pick = "button") {
  const stops = () => [...group.querySelectorAll(pick)].filter((stop) => stop.offsetParent !== null);
  const settle = (chosen) => {
    for (const stop of group.querySelectorAll(pick)) stop.tabIndex = stop === chosen ? 0 : -1;
  };
  group.addEventListener("focusin", (event) => event.target.matches(pick) && settle(event.target));
  group.addEventListener("keydown", (event) => {
    const all = stops();
    const here = all.indexOf(document.activeElement);
    if (here < 0 || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[event.key];
    const to = step ? (here + step + all.length) % all.length : {Home: 0, End: all.length - 1}[event.key];
    if (to === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    settle(all[to]);
    all[to].focus();
  });
  return () => {
    const all = stops();
    if (all.length) settle(all.find((stop) => stop.getAttribute("tabindex") === "0") ?? all[0]);
  };
}
