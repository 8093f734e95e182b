// The dialog that asks for the name of a file, and downloads that the page makes itself.

import {byId, el} from "./dom.js";

/** Asks for a file name; `save(name, force)` is called with it, and whether a file of that name may be replaced. */
export function saveDialog(save) {
  const dialog = byId("save");
  const name = el("input", {type: "text", name: "name", id: "save-name", required: true, maxlength: "120", pattern: "[^\\/\\\\]+", spellcheck: "false", autocomplete: "off"});
  const force = el("input", {type: "checkbox", id: "save-force"});
  const form = el(
    "form", {method: "dialog", on: {submit: () => save(name.value.trim(), force.checked)}},
    el("h2", {id: "save-title"}, "Save the scene"),
    el("label", {for: "save-name"}, "File name, beside the scene’s own file"), name,
    el("label", {class: "check"}, force, "Replace a file of this name"),
    el("p", {class: "quiet"}, "The ending chooses the format: .ply, .compressed.ply, .sog, .spz or .splat."),
    el("div", {class: "actions"}, el("button", {type: "button", on: {click: () => dialog.close()}}, "Cancel"), el("button", {type: "submit", class: "primary"}, "Save")),
  );
  dialog.append(form);
  return (title) => {
    const [, stem, ending = ".ply"] = title.match(/^(.*?)(\.compressed\.ply|\.ply|\.sog|\.spz|\.splat)?$/i);
    name.value = `${stem}-edited${ending}`;
    force.checked = false;
    dialog.showModal();
    name.setSelectionRange(0, stem.length + "-edited".length);
  };
}

/** Lets the browser download a blob under a name. */
export function download(blob, name) {
  const link = el("a", {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
