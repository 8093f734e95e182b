// The candidates of an open question as numbers in the picture; a click on one answers.

import {byId, el} from "./dom.js";

const APART = 40; // CSS pixels between the middles of two numbers
const EDGE = 24; // and from the middle of one to the edge, where its thing is out of sight

export class Candidates {
  #numbers = []; // {candidate, button}

  /** `answer(choice, text)` answers the open question, `point(group | null)` shows what a number stands for. */
  constructor({store, viewer, answer, point}) {
    Object.assign(this, {viewer, answer, point});
    store.watch(["question"], ({question}) => this.#build(question));
  }

  #build(question) {
    this.point(null);
    const shown = question?.candidates.filter((candidate) => candidate.centre) ?? [];
    this.#numbers = shown.map((candidate) => ({candidate, button: this.#button(candidate)}));
    byId("numbers").replaceChildren(...this.#numbers.map(({button}) => button));
    this.draw();
  }

  #button({number, name, group}) {
    const pointed = () => this.point(group);
    const left = () => this.point(null);
    return el(
      "button",
      {
        type: "button", class: "number", "aria-label": `${number}: ${name}`, title: name,
        on: {click: () => this.answer(number, `${number}: ${name}`), pointerenter: pointed, pointerleave: left, focus: pointed, blur: left},
      },
      String(number),
    );
  }

  /** Puts the numbers where their things are now. Of those that would cover each other the later gives way. */
  draw() {
    const {clientWidth, clientHeight} = byId("numbers");
    const placed = [];
    for (const {candidate, button} of this.#numbers) {
      const spot = this.viewer.project(candidate.centre);
      button.hidden = spot === null;
      if (spot === null) continue;
      const {x, y} = aside({
        x: Math.min(Math.max(spot.x, EDGE), clientWidth - EDGE), y: Math.min(Math.max(spot.y, EDGE), clientHeight - EDGE),
      }, placed);
      placed.push({x, y});
      button.style.transform = `translate(${x}px, ${y}px) translate(-50%, -50%)`;
    }
  }
}

/** The spot, moved away from those that are too near. */
function aside(spot, placed) {
  const near = placed.find(({x, y}) => Math.hypot(spot.x - x, spot.y - y) < APART - 1);
  if (!near) return spot;
  const [dx, dy] = [spot.x - near.x || 1, spot.y - near.y];
  const far = APART / Math.hypot(dx, dy);
  return aside({x: near.x + dx * far, y: near.y + dy * far}, placed.filter((other) => other !== near));
}
