// Dark or light: as the system says, or as the person chose.

const KEY = "scenewright-theme";
const NEXT = {system: "light", light: "dark", dark: "system"};
const TOLD = {system: "Theme: system", light: "Theme: light", dark: "Theme: dark"};

function chosen() {
  const kept = localStorage.getItem(KEY);
  return kept in NEXT ? kept : "system";
}

/** Shows the chosen theme; `onChange(text)` is told what is chosen, now and later. */
export function theme(onChange) {
  const show = (name) => {
    document.documentElement.dataset.theme = name;
    onChange(TOLD[name]);
  };
  show(chosen());
  return {
    next() {
      localStorage.setItem(KEY, NEXT[chosen()]);
      show(chosen());
    },
  };
}
