// What the page tells of itself over the picture: connecting, loading, working, the connection lost, no picture.

import {byId, el} from "./dom.js";

export function notice(store) {
  const [place, bar] = [byId("notice"), byId("working")];
  const [title, line, progress] = [el("p", {class: "title"}), el("p", {class: "quiet"}), el("progress", {max: "1", "aria-label": "Loaded"})];
  place.append(title, line, progress);
  store.watch(["connection", "loaded", "trouble", "scene"], (state) => {
    const [told, more] = toldOf(state);
    const seen = {lost: state.loaded === 1, loading: state.loaded > 0}[state.connection]; // a picture, which is not covered
    place.className = seen ? "float small" : "float";
    place.hidden = told === "";
    title.textContent = told;
    line.textContent = more;
    progress.hidden = state.connection !== "loading";
    progress.value = state.loaded;
    byId("stage").setAttribute("aria-busy", String(state.connection === "loading"));
  });
  store.watch(["busy", "progress"], ({busy, progress}) => {
    bar.hidden = !busy && progress === null;
    bar.classList.toggle("unknown", progress === null);
    bar.firstElementChild.style.transform = progress === null ? "" : `scaleX(${progress.share})`;
  });
}

/** A title and a line about the state; empty if there is nothing to tell. */
function toldOf({connection, trouble, scene}) {
  if (trouble) return ["The picture cannot be shown", `${trouble} The conversation works without it.`];
  if (connection === "connecting") return ["Connecting…", ""];
  if (connection === "loading") return ["Loading the scene", scene ? `${scene.slots.toLocaleString("en")} Gaussians` : ""];
  if (connection === "lost") return ["Reconnecting…", "What was done is kept. What you say now is sent later."];
  if (connection === "refused") return ["This page is no longer known", "Run “scenewright view” and open the address that it prints."];
  if (scene?.slots === 0) return ["The scene is empty", "Say what to put into it."];
  return ["", ""];
}
