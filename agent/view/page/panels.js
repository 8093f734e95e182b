// The panels at the sides: the list of things folds away; on a phone it slides in from the left, and the conversation is
// a sheet that is pulled up from below.

import {byId, el, setAttributes} from "./dom.js";
import {icon} from "./icons.js";

const phone = matchMedia("(max-width: 720px)");
const KEY = "scenewright-things";

/** The panels of the page; a question that is asked makes room for the picture, where its numbers are. */
export function panels(store) {
  const {body} = document;
  const set = (name, on) => {
    body.classList.toggle(name, on);
    setAttributes(byId("chat-handle"), {"aria-expanded": String(body.classList.contains("sheet-up"))});
    for (const button of document.querySelectorAll('[data-command="things"]')) setAttributes(button, {"aria-expanded": String(body.classList.contains("things-shown"))});
  };
  const start = () => {
    set("things-shown", !phone.matches && localStorage.getItem(KEY) !== "folded");
    set("sheet-up", false);
  };
  phone.addEventListener("change", start);
  start();
  sheet(byId("chat-handle"), (up) => set("sheet-up", up ?? !body.classList.contains("sheet-up")));
  byId("canvas").addEventListener("pointerdown", () => {
    if (!phone.matches) return;
    set("sheet-up", false);
    set("things-shown", false);
  });
  let asked = null;
  store.watch(["question"], ({question}) => {
    const text = question?.text ?? null;
    body.classList.toggle("asking", text !== null);
    if (text !== null && text !== asked) set("sheet-up", false);
    asked = text;
  });
  return {
    toggleThings() {
      const shown = !body.classList.contains("things-shown");
      set("things-shown", shown);
      if (!phone.matches) localStorage.setItem(KEY, shown ? "shown" : "folded");
    },
    showChat: () => set("sheet-up", true),
    isPhone: () => phone.matches,
  };
}

/** A tap on the handle pulls the sheet up or down; so does a stroke. */
function sheet(handle, pull) {
  let from = null;
  let stroked = false;
  handle.addEventListener("pointerdown", (event) => {
    from = event.clientY;
    stroked = false;
    handle.setPointerCapture(event.pointerId);
  });
  handle.addEventListener("pointermove", (event) => {
    if (from === null || Math.abs(event.clientY - from) < 24) return;
    pull(event.clientY < from);
    stroked = true;
    from = null;
  });
  handle.addEventListener("click", () => stroked || pull());
}

/** The button that opens the further commands where there is no room for them. */
export function moreButton(place, menu) {
  const button = el("button", {type: "button", class: "tool more", "aria-expanded": "false", "aria-controls": menu.id}, icon("more"), el("span", {}, "More"));
  const set = (open) => {
    menu.classList.toggle("open", open);
    setAttributes(button, {"aria-expanded": String(open)});
  };
  button.addEventListener("click", () => set(!menu.classList.contains("open")));
  addEventListener("pointerdown", (event) => menu.contains(event.target) || button.contains(event.target) || set(false));
  menu.addEventListener("click", () => set(false));
  addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !menu.classList.contains("open")) return;
    set(false);
    button.focus();
  });
  place.append(button);
}
