// The WebSocket to the server: says `resume` when it opens, reconnects when it closes, and keeps what is said meanwhile.

const FIRST_WAIT = 250; // ms until the first new attempt
const LONGEST_WAIT = 4000;
const MAGIC = 0x31565753; // "SWV1", little-endian

/** The header of a binary message. Throws an Error if it is none. */
export function headerOf(buffer) {
  const view = new DataView(buffer);
  if (buffer.byteLength < 8 || view.getUint32(0, true) !== MAGIC) throw new Error("the server sent an unknown message");
  return JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, view.getUint32(4, true))));
}

export class Connection {
  #socket = null;
  #waiting = []; // said while there was no connection
  #unanswered = new Map(); // id -> message that was sent
  #wait = FIRST_WAIT;
  #timer = 0;
  #next = 1;
  #open = false; // whether the server has answered `resume`
  #asking = false; // whether the server is asked if it is there

  /** `revision()` tells which revision the page holds; `onMessage`, `onColumns(header, buffer)`, `onLost(messages)` and
   * `onStatus("connecting" | "lost" | "refused")` are called with what happens. */
  constructor({revision, onMessage, onColumns, onStatus, onLost}) {
    Object.assign(this, {revision, onMessage, onColumns, onStatus, onLost});
    addEventListener("online", () => this.#again());
    document.addEventListener("visibilitychange", () => document.hidden || this.#again());
    this.#connect();
  }

  /** Sends a message, or keeps it until there is a connection; returns its number. */
  send(message) {
    const numbered = {...message, id: this.#next++};
    if (this.#open) this.#write(numbered);
    else this.#waiting.push(numbered);
    return numbered.id;
  }

  /** Asks for what is missing since a revision, or for everything. */
  resume(revision) {
    this.#socket.send(JSON.stringify({type: "resume", revision}));
  }

  #write(message) {
    this.#unanswered.set(message.id, message);
    this.#socket.send(JSON.stringify(message));
  }

  #connect() {
    clearTimeout(this.#timer);
    const socket = new WebSocket(`ws://${location.host}/ws`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.resume(this.revision());
    socket.onmessage = ({data}) => this.#take(data);
    socket.onclose = () => this.#closed();
    this.#socket = socket;
  }

  #take(data) {
    if (data instanceof ArrayBuffer) {
      const header = headerOf(data);
      if (header.id !== undefined) this.#unanswered.delete(header.id);
      return this.onColumns(header, data);
    }
    const message = JSON.parse(data);
    if (message.type === "said" || message.type === "error") this.#unanswered.delete(message.id);
    this.onMessage(message);
    if (message.type === "welcome") this.#opened();
  }

  #opened() {
    this.#open = true;
    this.#wait = FIRST_WAIT;
    for (const message of this.#waiting.splice(0)) this.#write(message);
  }

  /** What was sent and not answered is told, not sent again: it may have been done. */
  #closed() {
    this.#open = false;
    const lost = [...this.#unanswered.values()];
    this.#unanswered.clear();
    this.onStatus("lost");
    if (lost.length) this.onLost(lost);
    this.#timer = setTimeout(() => this.#again(), this.#wait);
    this.#wait = Math.min(this.#wait * 1.6, LONGEST_WAIT);
  }

  /** Connects again, unless the server is away or no longer knows this page. */
  async #again() {
    if (this.#asking || this.#socket.readyState !== WebSocket.CLOSED) return;
    clearTimeout(this.#timer);
    this.#asking = true;
    const answer = await fetch("/", {cache: "no-store"}).catch(() => null);
    this.#asking = false;
    if (answer?.ok) return this.#connect();
    if (answer) this.onStatus("refused");
    this.#timer = setTimeout(() => this.#again(), this.#wait);
  }
}
