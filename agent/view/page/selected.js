// What is selected, in words, with what is done with it most.

import {byId, el} from "./dom.js";
import {fill} from "./toolbar.js";

export function selectedBar(store, commands) {
  const place = byId("selected");
  const told = el("p", {"aria-live": "polite"});
  place.append(told);
  fill(place, ["hide", "clear"], commands, store);
  store.watch(["selection", "tool"], ({selection}) => {
    place.hidden = !selection.groups.length && !selection.ranges.length;
    told.textContent = selection.text;
    told.title = selection.text;
  });
}
