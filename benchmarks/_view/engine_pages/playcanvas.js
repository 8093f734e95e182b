// PlayCanvas' engine with its defaults: splats of a PLY file, sorted in its worker.

import * as pc from 'playcanvas';
import { drained } from './walk.js';

export async function start(canvas, { camera, near, far }) {
  const app = new pc.Application(canvas, { graphicsDeviceOptions: { antialias: false, powerPreference: 'high-performance' } });
  app.setCanvasFillMode(pc.FILLMODE_NONE);
  app.setCanvasResolution(pc.RESOLUTION_FIXED, canvas.width, canvas.height);
  const eye = new pc.Entity();
  eye.addComponent('camera', { clearColor: new pc.Color(0, 0, 0), fov: camera.fov_y, nearClip: near, farClip: far, toneMapping: pc.TONEMAP_NONE });
  app.root.addChild(eye);
  const asset = new pc.Asset('scene', 'gsplat', { url: '/scene.ply' });
  app.assets.add(asset);
  await new Promise((resolve, reject) => {
    asset.ready(resolve);
    asset.on('error', reject);
    app.assets.load(asset);
  });
  const splats = new pc.Entity();
  splats.addComponent('gsplat', { asset });
  app.root.addChild(splats);
  app.start();
  window.requestAnimationFrame = () => 0; // from here on a step of the walk is a tick
  const frame = async (at) => {
    eye.setPosition(...at.eye);
    eye.lookAt(...at.target, ...at.up);
    app.tick(performance.now());
    drained(app.graphicsDevice.gl);
  };
  return {
    frame,
    picture: async (at) => {
      await frame(at);
      return canvas.toDataURL('image/png');
    },
  };
}
