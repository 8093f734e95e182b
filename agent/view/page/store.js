// The page's one state. Data goes one way: a message or a command calls `update`, and whoever watches draws what changed.

export class Store {
  #state;
  #watchers = new Set();
  #changed = new Set();

  constructor(initial) {
    this.#state = initial;
  }

  get state() {
    return this.#state;
  }

  /** Takes over the given keys; those who watch one of them draw once, after the present task. */
  update(change) {
    const news = Object.keys(change).filter((key) => change[key] !== this.#state[key]);
    if (!news.length) return;
    this.#state = {...this.#state, ...change};
    if (!this.#changed.size) queueMicrotask(() => this.#draw());
    for (const key of news) this.#changed.add(key);
  }

  /** Calls `draw(state)` now and whenever one of the keys has changed. */
  watch(keys, draw) {
    this.#watchers.add({keys, draw});
    draw(this.#state);
  }

  #draw() {
    const changed = new Set(this.#changed);
    this.#changed.clear();
    for (const {keys, draw} of this.#watchers) if (keys.some((key) => changed.has(key))) draw(this.#state);
  }
}

/** The state before anything is known of the scene. */
export function initialState() {
  return {
    connection: "connecting", // "loading", "ready", "lost", "refused", "broken"
    trouble: "", // why the picture cannot be shown
    loaded: 0, // share of the scene that has come
    scene: null, // the server's `welcome`
    revision: null,
    digest: "", // of the scene: changes with what it looks like, and comes after its Gaussians
    things: [],
    selection: {groups: [], ranges: [], text: "", box: null},
    question: null,
    history: [],
    told: 0, // how many steps of it the conversation tells
    run: null, // of the server, to which the conversation belongs
    canUndo: false,
    canRedo: false,
    embedded: false,
    motion: null, // {start, stop, version}: what changes with time, seconds
    time: null, // that is shown; null: the scene as it is stored, at its start
    playing: false,
    busy: false,
    progress: null, // {id, stage, share}
    turns: [], // see conversation.js
    hidden: new Set(), // groups that are not drawn
    pointed: null, // the group that a list or a number points at
    tool: "select", // "box", "brush"
    mode: "set", // "add", "remove": what a click, a box or a stroke does with the selection
    brush: 24, // radius, CSS pixels
    gizmo: null, // "move", "rotate", "scale"
    compare: null, // share of the width that shows the scene before
    controls: "orbit", // "fly", "walk"
  };
}
