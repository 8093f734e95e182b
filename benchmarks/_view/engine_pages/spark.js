// Spark on three.js with its defaults: splats of a PLY file, sorted in its worker.

import * as THREE from 'three';
import { SparkRenderer, SplatMesh } from 'spark';
import { drained } from './walk.js';

export async function start(canvas, { camera, near, far }) {
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: false, powerPreference: 'high-performance' });
  renderer.setSize(canvas.width, canvas.height, false);
  const scene = new THREE.Scene();
  scene.add(new SparkRenderer({ renderer }));
  const splats = new SplatMesh({ url: '/scene.ply' });
  scene.add(splats);
  await splats.initialized;
  const eye = new THREE.PerspectiveCamera(camera.fov_y, canvas.width / canvas.height, near, far);
  const frame = async (at) => {
    eye.up.set(...at.up);
    eye.position.set(...at.eye);
    eye.lookAt(...at.target);
    renderer.render(scene, eye);
    drained(renderer.getContext());
  };
  return {
    frame,
    picture: async (at) => {
      await frame(at);
      return canvas.toDataURL('image/png');
    },
  };
}
