// What was said: turns of the person and the answers to them. A turn is
// {key, id, text, typed, answer: null | {ok, wrong, text, lines, receipt, pictures, link}, kind: "said" | "earlier" | "note"}.

const KEY = "scenewright-turns";
const KEPT = 100; // turns
let key = 0;

/** What this tab said before it was loaded again: `{turns, told, run}`; nothing in a new tab. */
export function keptTurns() {
  try {
    const {turns, told, run} = JSON.parse(sessionStorage.getItem(KEY));
    return {turns: turns.map((turn) => ({...turn, key: key++, id: null})), told, run};
  } catch {
    return {};
  }
}

/** Keeps what was said and answered for when the tab is loaded again. */
export function keepTurns(store) {
  store.watch(["turns", "told", "run"], ({turns, told, run}) => {
    const answered = turns.filter((turn) => turn.answer).slice(-KEPT);
    try {
      sessionStorage.setItem(KEY, JSON.stringify({turns: answered, told, run}));
    } catch {
      sessionStorage.removeItem(KEY); // there is no room for it
    }
  });
}

/** Adds what the person said or did; `id` is the number of the message that was sent, `typed` tells words from clicks. */
export function addTurn(store, text, id, typed = false) {
  store.update({turns: [...store.state.turns, {key: key++, id, text, typed, answer: null, kind: "said"}]});
}

/** Adds an answer without a question: a remark of the page itself. */
export function addNote(store, answer) {
  store.update({turns: [...store.state.turns, {key: key++, id: null, text: "", answer, kind: "note"}]});
}

/** Puts an answer beside what it answers; returns false if nothing of that number waits. */
export function answerTurn(store, id, answer) {
  const {turns} = store.state;
  const at = turns.findLastIndex((turn) => turn.id === id && turn.answer === null);
  if (at < 0) return false;
  store.update({turns: turns.with(at, {...turns[at], answer})});
  return true;
}

/** Whether something waits for its answer. */
export const waiting = (state) => state.turns.some((turn) => turn.id !== null && turn.answer === null);

/** Takes over the steps that the server knows and this page did not see: of an earlier visit, or of another tab. */
export function takeHistory(store, history, known) {
  const unseen = history.slice(known).map(({text, summary}) => ({
    key: key++, id: null, text, kind: "earlier", answer: {ok: true, text: summary},
  }));
  if (unseen.length) store.update({turns: [...store.state.turns, ...unseen]});
}
