// The dialog that asks for the name of a file, and downloads that the page makes itself.

import {byId, el} from "./dom.js";

/** Asks for a file name; `save(name)` is called with it. */
export function saveDialog(save) {
  const dialog = byId("save");
  const name = el("input", {type: "text", name: "name", id: "save-name", required: true, maxlength: "120", pattern: "[^\\/\\\\]+", spellcheck: "false", autocomplete: "off"});
  const form = el(
    "form", {method: "dialog", on: {submit: () => save(name.value.trim())}},
    el("h2", {id: "save-title"}, "Save the scene"),
    el("label", {for: "save-name"}, "File name, beside the scene’s own file"), name,
    el("p", {class: "quiet"}, "The ending chooses the format: .ply, .compressed.ply, .sog, .spz or .splat."),
    el("div", {class: "actions"}, el("button", {type: "button", on: {click: () => dialog.close()}}, "Cancel"), el("button", {type: "submit", class: "primary"}, "Save")),
  );
  dialog.append(form);
  return (suggested) => {
    name.value = suggested;
    dialog.showModal();
    name.setSelectionRange(0, suggested.indexOf(".") < 0 ? suggested.length : suggested.indexOf("."));
  };
}

/** Lets the browser download a blob under a name. */
export function download(blob, name) {
  const link = el("a", {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
