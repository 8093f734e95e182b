// Before and after: left of a line the picture shows the scene as it was before the last edit.

import {byId} from "./dom.js";

/** `ask()` asks the server for the rows of before. Returns `{toggle, take}`: `take(message)` takes them. */
export function slider({store, viewer, ask}) {
  const [place, input] = [byId("compare"), byId("compare-share")];
  let held = false; // whether the viewer has the rows of before
  input.addEventListener("input", () => store.update({compare: Number(input.value)}));
  store.watch(["compare"], ({compare}) => {
    place.hidden = compare === null;
    if (compare === null) {
      if (held) viewer.setBefore(null);
      held = false;
    } else {
      input.value = compare;
      input.setAttribute("aria-valuetext", `${Math.round(100 * compare)} %`);
      place.style.setProperty("--share", `${100 * compare}%`);
    }
    viewer.compare = compare;
  });
  store.watch(["digest", "canUndo"], ({compare, canUndo}) => {
    if (compare === null) return;
    if (canUndo) ask();
    else store.update({compare: null});
  });
  return {
    toggle() {
      if (store.state.compare === null) ask();
      store.update({compare: store.state.compare === null ? 0.5 : null});
    },
    take(message) {
      if (store.state.compare === null) return;
      viewer.setBefore(message);
      held = true;
      viewer.compare = store.state.compare;
    },
  };
}
