// The page's frame and its views, chosen by what stands behind the # of its address.

import * as api from "./api.js";
import { html, isTaken, render, Trouble } from "./parts.js";
import { isDark, onTheme, toggleTheme } from "./palette.js";

const main = document.getElementById("main");
const bar = document.getElementById("bar");
let leave = null;
let about = null;
let turn = 0;

const openHelp = () => import("./help.js").then((help) => help.openHelp());

/** Each view loads what it needs when it is first opened: the list needs no map. */
const VIEWS = {
  "": () => import("./list.js"),
  runs: () => import("./list.js"),
  missions: () => import("./replay.js"),
  compare: () => import("./compare.js"),
  live: () => import("./live.js"),
};

/** The parts of an address: ["missions", run, mission] and what follows its question mark. */
function address() {
  const [path, query = ""] = location.hash.replace(/^#\/?/, "").split("?");
  const parts = path.split("/").map((part) => {
    try {
      return decodeURIComponent(part);
    } catch {
      return part;
    }
  });
  return { parts, query: new URLSearchParams(query) };
}

async function show() {
  const mine = (turn += 1);
  const { parts, query } = address();
  const view = VIEWS[parts[0]];
  leave?.();
  leave = null;
  render(null, main);
  main.replaceChildren();
  main.className = "";
  drawBar(parts);
  if (!view) {
    render(html`<${Trouble} words="There is no such view. The list of runs is under “Runs”." />`, main);
    return;
  }
  try {
    const { mount } = await view();
    if (mine !== turn) return;
    leave = mount(main, parts.slice(1), query) ?? null;
  } catch (fault) {
    if (mine === turn) render(html`<${Trouble} words=${`This view cannot be opened: ${fault.message}`} />`, main);
  }
}

function drawBar(parts = address().parts) {
  const here = (name) => (parts[0] === name ? "page" : undefined);
  const list = ["", "runs", "missions", "compare"].includes(parts[0]) ? "page" : undefined;
  render(
    html`<a class="brand" href="#/">
        <svg viewBox="0 0 24 24" aria-hidden="true"><path d="M4 18l5-6 4 3 6-9" fill="none" stroke="currentColor" stroke-width="2" stroke-linecap="round" stroke-linejoin="round" /><circle cx="19" cy="6" r="2.6" class="brand-dot" /><circle cx="4.5" cy="17.6" r="2" fill="currentColor" /></svg>
        <span>Reasoned Explorer</span>
      </a>
      <nav aria-label="Views">
        <a href="#/" aria-current=${list}>Runs</a>
        ${about?.live ? html`<a href="#/live" aria-current=${here("live")}>Live</a>` : null}
      </nav>
      <span class="spread"></span>
      <span class="soft small clip root" title="What is shown">${about?.root ?? ""}</span>
      <button class="quiet" onClick=${toggleTheme} aria-label=${isDark() ? "Take the light colours" : "Take the dark colours"} title="Light or dark">
        <span aria-hidden="true">${isDark() ? "☀" : "☾"}</span>
      </button>
      <button class="quiet" onClick=${openHelp} title="Keys and signs (?)" aria-label="Help">?</button>`,
    bar,
  );
}

addEventListener("hashchange", show);
addEventListener("keydown", (event) => {
  if (isTaken(event) || event.key !== "?") return;
  event.preventDefault();
  openHelp();
});
onTheme(() => drawBar());
show();
api
  .about()
  .then((answer) => {
    about = answer;
    drawBar();
    const start = about.live && about.live_mission && !location.hash.replace(/^#\/?/, "");
    if (start) location.hash = "#/live";
  })
  .catch(() => {}); // the view itself says that the server is away
