// The shortcuts: the keys of the commands, and numbers that answer the open question.

import {byId, typing} from "./dom.js";
import {pressedKey} from "./toolbar.js";

/** `answer(choice, text)` answers the open question. */
export function keys({store, commands, answer}) {
  const known = new Map(Object.values(commands).flatMap((command) => command.keys.map((key) => [key, command])));
  addEventListener("keydown", (event) => {
    if (event.defaultPrevented || event.isComposing || document.querySelector("dialog[open]")) return;
    const key = pressedKey(event);
    if (typing(event.target) && !meantFromField(key, event.target)) return;
    const {state} = store;
    const candidate = state.question?.candidates.find((one) => String(one.number) === key);
    const command = known.get(key);
    if (candidate) answer(candidate.number, `${candidate.number}: ${candidate.name}`);
    else if (!command || command.enabled?.(state) === false) return;
    else command.run();
    event.preventDefault();
  });
}

/** From the field of words Escape goes to the picture; undo and redo are the scene's while the field is empty. */
function meantFromField(key, field) {
  if (key === "Escape" && field === byId("words")) {
    byId("canvas").focus();
    return false;
  }
  return key === "Ctrl+s" || (["Ctrl+z", "Ctrl+Shift+z", "Ctrl+y"].includes(key) && field.value === "");
}
