// The icons, drawn on a square of 24 units with a line of the text's colour.

import {svg} from "./dom.js";

const LINES = {
  select: "M5 3l14 7-6 2-2 6z",
  box: "M4 8V4h4M16 4h4v4M20 16v4h-4M8 20H4v-4M11 4h2M11 20h2M4 11v2M20 11v2",
  brush: "M20 4L10 14M10 14c-3-1-5 1-5 4-.1 1-1 2-2 2 4 1 9 0 9-4zM10 14l2 2",
  move: "M12 3v18M3 12h18M9 6l3-3 3 3M9 18l3 3 3-3M6 9l-3 3 3 3M18 9l3 3-3 3",
  rotate: "M20 12a8 8 0 1 1-2.6-5.9M20 3v4h-4",
  scale: "M4 14v6h6M20 10V4h-6M4 20l6-6M20 4l-6 6",
  undo: "M9 5l-5 5 5 5M4 10h10a5 5 0 0 1 0 10h-3",
  redo: "M15 5l5 5-5 5M20 10H10a5 5 0 0 0 0 10h3",
  play: "M7 4l12 8-12 8zM3 4v16",
  compare: "M12 3v18M9 7l-5 5 5 5M15 7l5 5-5 5",
  save: "M12 4v11M7 11l5 5 5-5M4 20h16",
  export: "M12 15V3M7 8l5-5 5 5M4 13v7h16v-7",
  snapshot: "M3 8h4l2-3h6l2 3h4v11H3zM12 17a4 4 0 1 0 0-8 4 4 0 0 0 0 8z",
  theme: "M12 3a9 9 0 1 0 0 18zM12 3a9 9 0 0 1 0 18",
  help: "M9 9a3 3 0 1 1 4.5 2.6c-1 .6-1.5 1.2-1.5 2.4M12 17.5v.5",
  shown: "M2 12c3-5 6.5-7 10-7s7 2 10 7c-3 5-6.5 7-10 7s-7-2-10-7zM12 15a3 3 0 1 0 0-6 3 3 0 0 0 0 6z",
  hidden: "M4 4l16 16M9 5.5a9 9 0 0 1 3-.5c3.5 0 7 2 10 7a17 17 0 0 1-3 4M6 7.5A17 17 0 0 0 2 12c3 5 6.5 7 10 7a9 9 0 0 0 4-1",
  things: "M4 6h2M4 12h2M4 18h2M9 6h11M9 12h11M9 18h11",
  chat: "M4 5h16v11H10l-5 4v-4H4z",
  send: "M4 12l16-8-5 16-3-7zM12 13l8-9",
  close: "M6 6l12 12M18 6L6 18",
  orbit: "M12 16a4 4 0 1 0 0-8 4 4 0 0 0 0 8zM16.5 8c3-.4 5 .2 5 1.7 0 2.3-4.7 5.3-10 6.5-4.7 1.1-9 .8-9-1.2 0-1 1-2.2 2.8-3.3",
  fly: "M21 3L3 10l7 3zM21 3l-7 18-4-8M10 13L21 3",
  walk: "M13 5.5a1.5 1.5 0 1 0 0-3 1.5 1.5 0 0 0 0 3zM7 12l2-4 4-1 2 4 4 1M12 8l-1 6 3 3 1 5M11 14l-1 4-3 4",
  frame: "M4 8V4h4M16 4h4v4M20 16v4h-4M8 20H4v-4M12 15a3 3 0 1 0 0-6 3 3 0 0 0 0 6z",
  more: "M5 12h.1M12 12h.1M19 12h.1",
  clear: "M12 21a9 9 0 1 0 0-18 9 9 0 0 0 0 18zM9 9l6 6M15 9l-6 6",
};

/** The picture of a name; screen readers pass it by, the words beside it say what it means. */
export function icon(name) {
  const line = svg("path", {d: LINES[name]});
  return svg("svg", {viewBox: "0 0 24 24", class: "icon", "aria-hidden": "true", focusable: "false"}, line);
}
