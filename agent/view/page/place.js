// Where a person was in the scene: kept when the tab is loaded again, for the same scene.

const KEY = "scenewright-place";

/** Keeps the camera and what is hidden when the tab goes. */
export function keepPlace(store, viewer) {
  addEventListener("pagehide", () => {
    const {scene, hidden, controls} = store.state;
    if (scene === null) return;
    const place = {title: scene.title, camera: viewer.camera, distance: viewer.controls.distance, hidden: [...hidden], controls};
    sessionStorage.setItem(KEY, JSON.stringify(place));
  });
}

/** Goes back to where the person was; returns false if this tab has not shown the scene before. */
export function takePlace(store, viewer) {
  const kept = JSON.parse(sessionStorage.getItem(KEY) ?? "null");
  if (kept === null || kept.title !== store.state.scene.title) return false;
  store.update({hidden: new Set(kept.hidden), controls: kept.controls});
  viewer.controls.mode = kept.controls; // walking moves the camera to eye height, so before it is set
  viewer.controls.distance = kept.distance;
  viewer.camera = kept.camera;
  return true;
}
