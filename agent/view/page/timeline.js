// Time: a bar that plays and scrubs, where something in the scene moves. The server tells the rows of each moment.

import {byId} from "./dom.js";

/** `send(message)` returns the number of the message. Returns `{toggle, take, failed, leave}`: `take(header, message)` takes a moment, `failed(id)`
 * tells that none comes, and `leave(anew)` shows the scene as it is stored again, before rows of it change, or come anew. */
export function timeline({store, viewer, send}) {
  const [bar, input, told] = [byId("timeline"), byId("time"), byId("time-told")];
  let start = null; // the message with the rows of the scene as it is stored; kept from the first moment that is asked for
  let asked = null; // {id, time} of the moment that was asked for and has not come
  let wanted = null; // the time that is to be asked for next
  let boxes = null; // of the things that move, at the time that is shown
  let began = null; // {clock, time} since when it plays
  let version = null; // of the motion of `start`
  const unanswered = new Set(); // numbers of the messages that ask for a moment

  const step = () => {
    const {motion, playing} = store.state;
    if (!playing || !motion) return;
    const length = Math.max(motion.stop - motion.start, 1e-3);
    show(motion.start + ((began.time - motion.start + (performance.now() - began.clock) / 1000) % length));
  };

  function show(time) {
    wanted = time;
    store.update({time, compare: null});
    ask();
  }

  function ask() {
    const {motion, connection} = store.state;
    if (asked || wanted === null || !motion || connection !== "ready") return;
    const time = start === null ? motion.start : wanted;
    asked = {time, id: send({type: "frame", time})};
    unanswered.add(asked.id);
    if (start !== null) wanted = null;
  }

  async function take(header, message) {
    unanswered.delete(header.id);
    if (asked?.id !== header.id) return;
    asked = null;
    if (!store.state.motion || header.revision !== store.state.revision) return again();
    if (start === null) start = message;
    else viewer.decode(message);
    boxes = header.boxes;
    place();
    if (wanted !== null) return ask();
    await viewer.idle();
    requestAnimationFrame(step);
  }

  /** Asks again for the moment that is shown: the scene is another one. */
  function again() {
    start = null;
    const {time, motion} = store.state;
    wanted = motion && time !== null && time !== motion.start ? time : null;
    ask();
  }

  /** Things lie where they are at the time that is shown: handles and the view find them there. */
  function place() {
    const {things, playing} = store.state;
    const elsewhere = (thing) => boxes[thing.group] !== undefined && boxes[thing.group] !== thing.box;
    if (!boxes || playing || !things.some(elsewhere)) return;
    store.update({things: things.map((thing) => (elsewhere(thing) ? {...thing, box: boxes[thing.group]} : thing))});
  }

  function leave(anew) {
    if (!anew && start !== null) viewer.decode(start);
    start = null;
    asked = null;
    boxes = null;
  }

  input.addEventListener("input", () => {
    store.update({playing: false});
    show(Number(input.value));
  });
  store.watch(["motion", "revision", "connection"], ({motion, connection}) => {
    bar.hidden = !motion;
    if (connection === "lost") asked = null;
    if (motion?.version !== version) {
      leave(false);
      version = motion?.version ?? null;
      if (!motion) store.update({time: null, playing: false});
    }
    if (!motion) return;
    input.min = motion.start;
    input.max = motion.stop;
    input.step = 0.01;
    if (connection === "ready" && start === null && !asked) again();
  });
  store.watch(["things", "playing"], place);
  store.watch(["time", "motion"], ({time, motion}) => {
    if (!motion) return;
    const now = Math.min(Math.max(time ?? motion.start, motion.start), motion.stop);
    input.value = now;
    told.textContent = `${now.toFixed(1)} of ${motion.stop.toFixed(1)} s`;
    input.setAttribute("aria-valuetext", `${now.toFixed(1)} seconds`);
  });
  return {
    take,
    leave,
    failed(id) {
      if (asked?.id === id) {
        asked = null;
        store.update({playing: false});
      }
      return unanswered.delete(id);
    },
    toggle() {
      const {motion, playing, time} = store.state;
      if (!motion) return;
      const ended = time === null || time >= motion.stop - 0.01;
      began = {clock: performance.now(), time: ended ? motion.start : time};
      store.update({playing: !playing});
      step();
    },
  };
}
