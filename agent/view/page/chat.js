// The conversation beside the scene: what was said, answers with receipts and pictures, the open question, and the words.

import {byId, el} from "./dom.js";
import {icon} from "./icons.js";
import {receiptOf} from "./receipt.js";

/** `say(text)` sends words, `answer(choice, text)` answers the open question. */
export function chat({store, say, answer, point}) {
  const turns = byId("turns");
  drawTurns(store, turns, say);
  new ResizeObserver(() => toEnd(turns)).observe(turns);
  turns.addEventListener("load", () => toEnd(turns), {capture: true}); // pictures come later
  drawQuestion(store, answer, point);
  words(store, say);
}

const toEnd = (turns) => {
  turns.scrollTop = turns.scrollHeight;
};

// -- turns ---------------------------------------------------------------------------------------------------------

function drawTurns(store, place, say) {
  const drawn = new Map(); // key of a turn -> {turn, element}
  const hints = el("div", {class: "hints"});
  place.append(hints);
  store.watch(["turns", "progress", "things", "connection"], (state) => {
    let added = false;
    for (const turn of state.turns) {
      const old = drawn.get(turn.key);
      if (old?.turn !== turn) {
        const element = turnElement(turn);
        if (old) old.element.replaceWith(element);
        else place.append(element);
        drawn.set(turn.key, {turn, element});
        added = true;
      }
      if (turn.id !== null && turn.answer === null) drawProgress(drawn.get(turn.key).element, state);
    }
    drawHints(hints, state, say);
    if (added) toEnd(place);
  });
}

function turnElement(turn) {
  const parts = [];
  if (turn.text) parts.push(el("p", {class: "you"}, el("span", {class: "unseen"}, turn.kind === "earlier" ? "Earlier: " : "You: "), turn.text));
  if (turn.answer) parts.push(answerElement(turn.answer));
  else if (turn.id !== null) parts.push(el("div", {class: "answer wait"}, el("span", {}, "Working…"), el("progress", {max: "1", "aria-label": "Progress", hidden: true})));
  return el("article", {class: `turn ${turn.kind}`}, ...parts);
}

function answerElement({ok, wrong = false, text, lines = [], receipt = [], pictures = [], link = null}) {
  const told = [text, ...lines.filter((line) => line !== text)].filter(Boolean);
  return el(
    "div", {class: `answer${ok ? "" : " refused"}${wrong ? " wrong" : ""}`},
    ...told.map((line, i) => el("p", {class: i ? "quiet" : ""}, line)),
    ...pictures.map((address) => pictureButton(address, `What the answer rests on: ${text}`)),
    receipt.length ? receiptOf(receipt) : null,
    link ? el("a", {class: "download", href: link, download: true}, icon("save"), "Download the page") : null,
  );
}

function pictureButton(address, told) {
  const show = () => {
    const dialog = byId("picture");
    const close = el("button", {type: "button", class: "primary", on: {click: () => dialog.close()}}, "Close");
    dialog.replaceChildren(el("img", {src: address, alt: told}), el("div", {class: "actions"}, close));
    dialog.showModal();
  };
  const gone = () => button.remove(); // the server keeps the last pictures only
  const button = el("button", {type: "button", class: "evidence", on: {click: show}}, el("img", {src: address, alt: `${told}; opens larger`, on: {error: gone}}));
  return button;
}

function drawProgress(element, {progress, connection}) {
  const [told, bar] = [element.querySelector(".wait span"), element.querySelector("progress")];
  const here = progress !== null;
  told.textContent = connection === "lost" ? "Waiting for the connection…" : here ? sentence(progress.stage) : "Working…";
  bar.hidden = !here;
  if (here) bar.value = progress.share;
}

const sentence = (text) => `${text.slice(0, 1).toUpperCase()}${text.slice(1)}…`;

/** A few things to say, made from what is there; shown until something is said. */
function drawHints(place, state, say) {
  place.hidden = state.turns.length > 0 || state.connection !== "ready";
  if (place.hidden) return;
  const names = [...new Set(state.things.map((thing) => thing.name))].filter(Boolean);
  const one = names.find((name) => !/wall|floor|ceiling| thing$/.test(name)); // one whose name is sure
  const said = one ? [`What is next to the ${one}?`, `Make the ${one} teal`, `Look at the ${one}`] : ["What is in the room?", "Warmer light"];
  place.replaceChildren(
    el("p", {}, state.scene?.slots === 0 ? "The scene is empty. Say what to put into it." : "Say what to change, or ask. Click a thing, and “it” means what you clicked."),
    ...said.map((text) => el("button", {type: "button", class: "hint", on: {click: () => say(text)}}, text)),
  );
}

// -- the open question ---------------------------------------------------------------------------------------------

function drawQuestion(store, answer, point) {
  const place = byId("asked");
  store.watch(["question"], ({question}) => {
    place.hidden = question === null;
    if (question === null) return place.replaceChildren();
    const {candidates, kind} = question;
    const numbered = candidates.map(({number, name, group}) => el(
      "button",
      {
        type: "button", class: "choice",
        on: {
          click: () => answer(number, `${number}: ${name}`), pointerenter: () => point(group), pointerleave: () => point(null),
          focus: () => point(group), blur: () => point(null),
        },
      },
      el("b", {class: "number"}, String(number)), name || "this one",
    ));
    const yes = [["yes", "Yes"], ["no", "No"]].map(([choice, told]) => el("button", {type: "button", class: "choice", on: {click: () => answer(choice, told)}}, told));
    const buttons = kind === "unconfirmed" ? yes : [...numbered, el("button", {type: "button", class: "choice plain", on: {click: () => answer("no", "None of them")}}, "None")];
    place.replaceChildren(el("p", {class: "unseen"}, question.text), el("div", {class: "choices"}, ...buttons));
  });
}

// -- the words -----------------------------------------------------------------------------------------------------

function words(store, say) {
  const [form, field, send] = [byId("say"), byId("words"), byId("send")];
  send.append(icon("send"), el("span", {class: "unseen"}, "Send"));
  const fit = () => {
    field.style.height = "auto";
    field.style.height = `${Math.min(field.scrollHeight, 160)}px`;
  };
  const put = (text) => {
    field.value = text;
    fit();
  };
  let back = 0; // how far the arrow keys went back in what was said
  const recall = (step) => {
    const said = store.state.turns.filter((turn) => turn.typed).map((turn) => turn.text);
    back = Math.min(Math.max(back + step, 0), said.length);
    put(back ? said.at(-back) : "");
  };
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const text = field.value.replace(/(?![\n\t])[\p{Cc}\p{Cs}]/gu, " ").trim(); // the server refuses control characters
    if (!text) return;
    back = 0;
    put("");
    say(text);
  });
  field.addEventListener("input", fit);
  field.addEventListener("keydown", (event) => {
    if (event.isComposing) return;
    if (event.key === "Enter" && !event.shiftKey) {
      event.preventDefault();
      form.requestSubmit();
    } else if ((event.key === "ArrowUp" && (!field.value || back)) || (event.key === "ArrowDown" && back)) {
      event.preventDefault();
      recall(event.key === "ArrowUp" ? 1 : -1);
    }
  });
  store.watch(["connection"], ({connection}) => {
    send.setAttribute("aria-disabled", String(connection === "refused"));
  });
}
