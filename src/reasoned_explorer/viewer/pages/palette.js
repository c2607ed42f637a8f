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

// Viridis (van der Walt and Smith 2015), nine of its stops: even in lightness, and the same order to all eyes.
const VIRIDIS = [
  [68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141],
  [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37],
];

/** Colour of a share from 0 to 1. */
export function scale(share) {
  const at = Math.min(1, Math.max(0, share)) * (VIRIDIS.length - 1);
  const low = Math.min(VIRIDIS.length - 2, Math.floor(at));
  const mix = VIRIDIS[low].map((part, i) => Math.round(part + (VIRIDIS[low + 1][i] - part) * (at - low)));
  return `rgb(${mix.join(" ")})`;
}

/** Colour of a score between the ends of a range; null means there is none. */
export const scoreColour = (q, [low, high]) => (q === null || q === undefined ? null : scale((q - low) / (high - low)));
