// What the signs of the map mean, drawn by what draws the map.

import { frontierMark } from "./mission_layer.js";
import { html, useLayoutEffect, useRef, useState } from "./parts.js";
import { onTheme, scale } from "./palette.js";

const STATES = [
  ["open", { state: "open", q: 4 }],
  ["on shunned ground", { state: "open", q: 2, forbidden: true }],
  ["no score", { state: "open", q: null }],
  ["visited", { state: "visited", q: null }],
  ["given up", { state: "given up", q: null }],
  ["blocked", { state: "blocked", q: null }],
];

function Sign({ look, range }) {
  const at = useRef(null);
  const [, again] = useState(0);
  useLayoutEffect(() => onTheme(() => again((n) => n + 1)), []);
  useLayoutEffect(() => {
    const c = at.current.getContext("2d");
    c.setTransform(2, 0, 0, 2, 0, 0);
    c.clearRect(0, 0, 18, 18);
    frontierMark(c, 9, 9, look, range, 5.5);
  });
  return html`<canvas ref=${at} width="36" height="36" class="sign" aria-hidden="true"></canvas>`;
}

/** Q as a scale with its ends. */
export function Scale({ range: [low, high] }) {
  const stops = [0, 0.2, 0.4, 0.6, 0.8, 1];
  return html`<span class="scale" role="img" aria-label=${`Colour of Q, from ${low} (dark violet) to ${high} (yellow)`}>
    <span class="tiny">Q ${low}</span>
    <span class="scale-bar" ref=${(el) => el && (el.style.background = `linear-gradient(90deg, ${stops.map(scale).join(", ")})`)}></span>
    <span class="tiny">${high}</span>
  </span>`;
}

export function Legend({ range }) {
  return html`<ul class="legend">
    <li><${Scale} range=${range} /></li>
    ${STATES.map(([name, look]) => html`<li><${Sign} look=${look} range=${range} />${name}</li>`)}
    <li><span class="key key-chosen" aria-hidden="true"></span>chosen</li>
    <li><span class="key key-robot" aria-hidden="true">▲</span>robot and its view</li>
    <li><span class="key key-start" aria-hidden="true"></span>start</li>
    <li><span class="key key-goal" aria-hidden="true">★</span>goal, success radius</li>
    <li><span class="key key-reference" aria-hidden="true"></span>shortest way</li>
    <li><span class="key key-sigma" aria-hidden="true"></span>σ(d)</li>
  </ul>`;
}
