// The help that "?" opens: keys, and how to read the map.

import { Legend } from "./legend.js";
import { html, render } from "./parts.js";

const KEYS = [
  ["Everywhere", [["?", "this help"], ["Tab", "to the next control"]]],
  ["List", [["/", "to the filter"], ["↑ ↓", "row by row"], ["Page Up, Page Down", "by pages"], ["Home, End", "first or last row"], ["Enter", "open the replay"], ["c", "compare with another method"]]],
  ["Replay", [["← →", "step by step"], ["Shift ← →", "second by second"], ["Home, End", "start or end"], ["Space", "play or pause"], ["[ ]", "slower or faster"], ["+ −", "zoom the map"], ["0", "everything in view"], ["arrows on the map", "move the map (Tab brings you there)"], ["1 2 3", "imagined, frontiers, mission"]]],
  ["Tree", [["→ ←", "unfold or fold"], ["↑ ↓", "node by node"]]],
];

/** Open the help. It closes with Escape, and the focus goes back to where it was. */
export function openHelp() {
  const box = document.getElementById("help");
  render(
    html`<dialog class="help" aria-labelledby="help-title" onClick=${(event) => event.target === event.currentTarget && event.currentTarget.close()}>
      <div class="row"><h2 id="help-title" class="spread">Keys and signs</h2>
        <button class="quiet" onClick=${() => box.querySelector("dialog").close()} aria-label="Close">✕</button></div>
      <div class="help-parts">
        ${KEYS.map(([name, keys]) => html`<section><h3>${name}</h3><dl>${keys.map(([key, words]) => html`<dt><kbd>${key}</kbd></dt><dd>${words}</dd>`)}</dl></section>`)}
      </div>
      <h3>On the map</h3>
      <${Legend} range=${[1, 5]} />
      <p class="small soft">Q is the score of what is imagined beyond a frontier, 1 to 5. σ(d) is what its distance costs. The frontier with the highest Q − σ(d) is gone to. The rings are straight distances from the robot; the planner itself measures along the ways it knows.</p>
    </dialog>`,
    box,
  );
  const dialog = box.querySelector("dialog");
  if (!dialog.open) dialog.showModal();
}
