// The receipt of a step: what was checked, folded until it is asked for; what failed is open.

import {el} from "./dom.js";

export function receiptOf(rows) {
  const failed = rows.filter((row) => !row.passed).length;
  const count = `${rows.length} ${rows.length === 1 ? "check" : "checks"}`;
  const told = failed ? `${failed} of ${count} failed` : `${count} passed`;
  const line = ({name, passed, text}) => el(
    "li", {class: passed ? "passed" : "failed"},
    el("span", {class: "mark", "aria-hidden": "true"}, passed ? "✓" : "✗"),
    el("span", {class: "unseen"}, passed ? "passed: " : "failed: "),
    el("span", {class: "name"}, name), text ? el("span", {class: "quiet"}, ` ${text}`) : null,
  );
  return el("details", {class: "receipt", open: failed > 0}, el("summary", {}, told), el("ul", {}, ...rows.map(line)));
}
