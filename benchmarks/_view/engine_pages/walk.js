// A walk of the camera around its target, and how long each step takes until its pixels are there.

// camera: {eye, target, up} (world), fov_y (degrees). The eye turned about `up` through the target, by `degrees`.
export function turned({ eye, target, up, fov_y }, degrees) {
  const length = Math.hypot(...up);
  const [x, y, z] = up.map((value) => value / length);
  const a = eye.map((value, i) => value - target[i]);
  const angle = (degrees * Math.PI) / 180;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const along = (1 - c) * (x * a[0] + y * a[1] + z * a[2]);
  const across = [y * a[2] - z * a[1], z * a[0] - x * a[2], x * a[1] - y * a[0]];
  const moved = a.map((value, i) => target[i] + c * value + s * across[i] + along * [x, y, z][i]);
  return { eye: moved, target, up, fov_y };
}

// Milliseconds of each step: from the camera's move to a pixel of its picture, which the driver gives only when all that
// was asked of it before is drawn. Between steps the page takes messages, among them those of the sorting worker.
export async function walk(engine, camera, steps, degrees) {
  const found = [];
  for (let step = 0; step < steps; step++) {
    await turn();
    const began = performance.now();
    await engine.frame(turned(camera, degrees * (step + 1)));
    found.push(performance.now() - began);
  }
  return found;
}

// Draw the camera again and again until its order is sorted, and return the picture as a PNG's address.
export async function rest(engine, camera, milliseconds) {
  const end = performance.now() + milliseconds;
  do {
    await engine.frame(camera);
    await new Promise((resolve) => setTimeout(resolve, 20));
  } while (performance.now() < end);
  return engine.picture(camera);
}

// The end of the present task, and of those that already wait; without the pause of a timer or of a screen's refresh.
export function turn() {
  return new Promise((resolve) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => {
      port1.close();
      resolve();
    };
    port2.postMessage(null);
  });
}

export function drained(gl) {
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
}
