// The exported page: shows the scene that the file holds; a click names what is under the pointer. It needs no server.

import { add, dot, norm, scale } from './camera.js';
import { SplatViewer } from './viewer.js';

const byId = (id) => document.getElementById(id);
const about = JSON.parse(byId('about').textContent);
const told = byId('told');
const named = Object.keys(about.names).length > 0;
const help = `Drag to turn, wheel or two fingers to approach, W A S D to move${named ? '; click a thing for its name' : ''}.`;

function makeWorker() {
  return new Worker(URL.createObjectURL(new Blob([byId('worker').textContent], { type: 'text/javascript' })));
}

// The bytes of base64 text that were packed with gzip.
async function unpacked(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
}

function home(viewer) {
  const { position, forward, up, fov_y } = about.camera;
  viewer.camera = { position, forward, up, fov_y };
  const [low, high] = about.bounds;
  const ahead = dot(add(scale(add(low, high), 0.5), position, -1), forward);
  viewer.controls.distance = ahead > 0 ? ahead : norm(add(high, low, -1)) / 4;
}

// Plays and scrubs through the moments that the file holds: each has the rows that change with time, as they are then.
function playable(viewer) {
  const moments = [...document.querySelectorAll('.moments')].map((part) => ({ time: Number(part.dataset.time), text: part.textContent }));
  if (!moments.length) return;
  const [bar, input, play, shown] = ['time-bar', 'time', 'play', 'time-told'].map(byId);
  const stop = moments.at(-1).time;
  let wanted = 0; // number of the moment that is to be shown
  let busy = false;
  let began = null; // {clock, time} since when it plays
  Object.assign(input, { min: 0, max: moments.length - 1, step: 1, value: 0 });
  const nearest = (time) => Math.round(((time - moments[0].time) / (stop - moments[0].time)) * (moments.length - 1));
  const tell = () => {
    shown.textContent = `${moments[wanted].time.toFixed(1)} of ${stop.toFixed(1)} s`;
    input.setAttribute('aria-valuetext', `${moments[wanted].time.toFixed(1)} seconds`);
    play.setAttribute('aria-pressed', String(began !== null));
    play.textContent = began ? 'Pause' : 'Play';
  };
  async function draw() {
    if (busy) return;
    busy = true;
    let last = -1;
    while (last !== wanted) {
      last = wanted;
      const moment = moments[last];
      moment.rows ??= await unpacked(moment.text);
      viewer.decode(moment.rows);
      await viewer.idle();
    }
    busy = false;
    if (began) requestAnimationFrame(step);
  }
  function go(number) {
    wanted = number;
    input.value = number;
    tell();
    draw();
  }
  function step() {
    if (!began) return;
    const length = stop - moments[0].time;
    const number = nearest(moments[0].time + ((began.time - moments[0].time + (performance.now() - began.clock) / 1000) % length));
    if (number === wanted) requestAnimationFrame(step);
    else go(number);
  }
  input.oninput = () => {
    began = null;
    go(Number(input.value));
  };
  play.onclick = () => {
    const now = moments[wanted].time;
    began = began ? null : { clock: performance.now(), time: now >= stop ? moments[0].time : now };
    tell();
    step();
  };
  bar.hidden = false;
  tell();
}

async function show() {
  const viewer = new SplatViewer(byId('canvas'), { makeWorker });
  viewer.near = about.near;
  Object.assign(viewer.controls, { up: about.up, floor: about.floor, metres: about.metres_per_unit ?? 1 });
  home(viewer);
  const parts = [...document.querySelectorAll('.columns')];
  for (const [number, part] of parts.entries()) {
    told.textContent = `Loading: ${Math.round((100 * number) / parts.length)} %`;
    viewer.decode(await unpacked(part.textContent));
    part.remove(); // the text is not needed any more
  }
  await viewer.idle();
  told.textContent = help;
  playable(viewer);
  byId('home').onclick = () => home(viewer);
  const modes = [...byId('modes').querySelectorAll('[data-mode]')];
  for (const button of modes) {
    button.onclick = () => {
      viewer.controls.mode = button.dataset.mode;
      modes.forEach((other) => other.setAttribute('aria-pressed', String(other === button)));
      byId('canvas').focus();
    };
  }
  byId('canvas').addEventListener('click', (event) => {
    if (viewer.controls.dragged) return;
    const found = viewer.pick(event.offsetX, event.offsetY);
    const name = found && about.names[found.group];
    viewer.highlight = { groups: name ? new Set([found.group]) : new Set() };
    told.textContent = name ?? help;
  });
  window.viewer = viewer;
}

show().catch((error) => (told.textContent = error.message));
