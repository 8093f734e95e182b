// The page's own renderer, with its own policy of sorting and drawing.

import { SplatViewer } from '/viewer/viewer.js';
import { drained, turn } from './walk.js';

export async function start(canvas, { columns, near, camera }) {
  window.requestAnimationFrame = (draw) => (turn().then(() => draw(performance.now())), 1); // at once, not at the next refresh
  let took = null;
  const viewer = new SplatViewer(canvas, { onFrame: () => took?.() });
  viewer.near = near;
  const see = ({ eye, target, up, fov_y }) =>
    (viewer.camera = { position: eye, forward: target.map((value, i) => value - eye[i]), up, fov_y });
  see(camera);
  for (let i = 0; i < columns; i++) viewer.decode(await (await fetch(`/columns/${i}`)).arrayBuffer());
  await viewer.idle();
  return {
    viewer,
    frame: (at) =>
      new Promise((resolve) => {
        took = () => {
          took = null;
          drained(viewer.gl);
          resolve();
        };
        see(at);
      }),
    picture: async (at) => {
      see(at);
      await viewer.idle();
      viewer.draw();
      return canvas.toDataURL('image/png');
    },
  };
}
