// Colours for canvases: the style sheet's, as the present theme resolves them, and a scale for scores.

let probe = null;
let cache = new Map();
const listeners = new Set();

/** The colour of a CSS variable in the theme that holds. */
export function colour(name) {
  if (!cache.has(name)) {
    if (!probe) {
      probe = document.createElement("span");
      probe.hidden = true;
      document.body.append(probe);
    }
    probe.style.color = `var(${name})`;
    cache.set(name, getComputedStyle(probe).color);
  }
  return cache.get(name);
}

/** Call back whenever light and dark change; returns what ends it. */
export function onTheme(listener) {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

function changed() {
  cache = new Map();
  for (const listener of listeners) listener();
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);

/** Whether the page is dark now. */
export function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
}

/** Take the other theme, and remember it. */
export function toggleTheme() {
  const theme = isDark() ? "light" : "dark";
  document.documentElement.dataset.theme = theme;
  try {
    localStorage.setItem("rex-theme", theme);
  } catch {
    // no storage: it holds while the page is open
  }
  changed();
}

// Cividis (Nuñez, Anderton and Renslow 2018), ten of its stops: even in lightness, the same to all eyes.
const CIVIDIS = [
  [0, 34, 78], [18, 53, 112], [59, 73, 108], [87, 93, 109], [112, 113, 115],
  [138, 134, 120], [165, 156, 116], [195, 180, 105], [225, 204, 85], [254, 232, 56],
];

/** Colour of a share from 0 to 1. */
export function scale(share) {
  const at = Math.min(1, Math.max(0, share)) * (CIVIDIS.length - 1);
  const low = Math.min(CIVIDIS.length - 2, Math.floor(at));
  const mix = CIVIDIS[low].map((part, i) => Math.round(part + (CIVIDIS[low + 1][i] - part) * (at - low)));
  return `rgb(${mix.join(" ")})`;
}

/** Colour of a score between the ends of a range; null means there is none. */
export const scoreColour = (q, [low, high]) => (q === null || q === undefined ? null : scale((q - low) / (high - low)));
