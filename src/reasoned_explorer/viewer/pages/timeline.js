// The time line: each step's looking, thinking and travelling, in a strip that can be dragged through.

import { html, useEffect, useLayoutEffect, useRef, useState } from "./parts.js";
import { colour, onTheme } from "./palette.js";
import { SPEEDS } from "./player.js";
import { clock, fixed } from "./words.js";

const LANE = 26;
const GAP = 6;
const AXIS = 16;
const PAD = 10;

/** Step lengths of the axis: the first that leaves room for its figures. */
const TICKS = [5, 10, 30, 60, 120, 300, 600, 1200, 3600, 7200];

function drawLane(c, mission, top, x) {
  let at = 0;
  mission.steps.forEach((step, index) => {
    at = step.started_s;
    // The seconds of a step are stacked: looking, thinking (CT), then travelling.
    const rest = Math.max(0, step.ended_s - step.started_s - step.look_s - step.think_s - step.travel_s);
    for (const [name, seconds] of [["--look", step.look_s], ["--think", step.think_s], ["--rule", rest], ["--travel", step.travel_s]]) {
      if (seconds <= 0) continue;
      c.fillStyle = colour(name);
      c.fillRect(x(at), top, Math.max(0.5, x(at + seconds) - x(at)), LANE);
      at += seconds;
    }
    if (index && x(step.ended_s) - x(step.started_s) > 4) {
      c.fillStyle = colour("--surface");
      c.fillRect(x(step.started_s) - 0.5, top, 1, LANE);
    }
  });
  c.textAlign = "center";
  c.textBaseline = "middle";
  for (const { t } of mission.troubles()) sign(c, "×", x(t), top + LANE - 7, "--bad");
  mission.steps.forEach((step, index) => {
    if (step.views.some((view) => view.found)) sign(c, "★", x(mission.decided(index)), top + 8, "--map-goal");
  });
}

function sign(c, text, px, py, name) {
  c.font = "700 13px system-ui, sans-serif";
  c.lineWidth = 4;
  c.lineJoin = "round";
  c.strokeStyle = colour("--surface");
  c.fillStyle = colour(name);
  c.strokeText(text, px, py);
  c.fillText(text, px, py);
}

function drawAxis(c, end, width, top, x) {
  const every = TICKS.find((tick) => x(tick) - x(0) > 56) ?? TICKS.at(-1);
  c.fillStyle = colour("--soft");
  c.font = "11px system-ui, sans-serif";
  c.textBaseline = "top";
  for (let t = 0; t <= end; t += every) {
    c.fillRect(x(t), top, 1, 4);
    c.textAlign = t === 0 ? "left" : x(t) > width - 30 ? "right" : "center";
    c.fillText(clock(t), x(t), top + 5);
  }
}

/**
 * @param {{missions: import("./state.js").Mission[], names?: string[], player: import("./player.js").Player,
 *   cursor: {current: ((t: number) => void)|null}, onStep: (by: number) => void}} props
 */
export function Timeline({ missions, names = [], player, cursor, onStep }) {
  const box = useRef(null);
  const canvas = useRef(null);
  const needle = useRef(null);
  const readout = useRef(null);
  const sums = useRef(null);
  const wide = useRef(0);
  const left = useRef(0);
  const [, redraw] = useState(0);
  const again = () => redraw((n) => n + 1);
  useEffect(() => player.onState(again), [player]);
  useEffect(() => onTheme(again), []);
  useEffect(() => {
    const resized = new ResizeObserver(([{ contentRect }]) => {
      wide.current = contentRect.width; // asked for once: a question while time moves would lay the whole page out
      again();
    });
    resized.observe(box.current);
    wide.current = box.current.clientWidth;
    return () => resized.disconnect();
  }, []);

  const height = missions.length * (LANE + GAP) + AXIS;
  const end = Math.max(1, ...missions.map((mission) => mission.end));
  const width = () => wide.current || box.current.clientWidth;
  const toX = (t) => PAD + (t / end) * (width() - 2 * PAD);

  useLayoutEffect(() => {
    const ratio = Math.min(2, devicePixelRatio || 1);
    const c = canvas.current.getContext("2d");
    canvas.current.width = Math.round(width() * ratio);
    canvas.current.height = Math.round(height * ratio);
    canvas.current.style.height = `${height}px`;
    box.current.style.height = `${height}px`;
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, width(), height);
    missions.forEach((mission, lane) => drawLane(c, mission, lane * (LANE + GAP), toX));
    drawAxis(c, end, width(), missions.length * (LANE + GAP) - GAP + 2, toX);
    cursor.current?.(player.t);
  });

  cursor.current = (t) => {
    if (!needle.current) return;
    needle.current.style.transform = `translateX(${toX(Math.min(t, end))}px)`;
    const words = missions.map((mission) => spent(mission, t));
    readout.current.textContent = `${clock(t)} / ${clock(end)}`;
    if (sums.current) sums.current.textContent = words[0];
    box.current.setAttribute("aria-valuenow", String(Math.round(t)));
    box.current.setAttribute("aria-valuetext", `${clock(t)}; ${words.join("; ")}`);
  };

  const drag = (event) => {
    player.toggle(false);
    player.seek(((event.clientX - left.current - PAD) / Math.max(1, width() - 2 * PAD)) * end);
  };
  const down = (event) => {
    if (event.button) return;
    left.current = box.current.getBoundingClientRect().left;
    box.current.setPointerCapture(event.pointerId);
    drag(event);
  };
  const move = (event) => box.current.hasPointerCapture(event.pointerId) && drag(event);

  return html`<section class="timeline" aria-label="Time line">
    <div class="controls">
      <button class="main play" onClick=${() => player.toggle()} aria-label=${player.playing ? "Pause" : "Play"} title="Space">
        <span aria-hidden="true">${player.playing ? "❚❚" : "▶"}</span></button>
      <button onClick=${() => onStep(-1)} aria-label="Step back" title="←">‹</button>
      <button onClick=${() => onStep(1)} aria-label="Step on" title="→">›</button>
      <select aria-label="Speed" value=${String(player.speed)} onChange=${(event) => player.setSpeed(Number(event.target.value))}>
        ${SPEEDS.map((speed) => html`<option value=${String(speed)}>${speed}×</option>`)}
      </select>
      <output class="time figures" ref=${readout}></output>
      ${missions.length === 1 ? html`<span class="soft small figures nowrap" ref=${sums} aria-hidden="true"></span>` : null}
      <span class="spread"></span>
      <ul class="time-keys" aria-label="Colours of the time line">
        <li><span class="swatch look"></span>look</li><li><span class="swatch think"></span>think (CT)</li><li><span class="swatch travel"></span>travel</li>
        <li><b class="goal-sign">★</b> goal seen</li><li><b class="bad-sign">×</b> stopped</li>
      </ul>
    </div>
    ${names.length ? html`<p class="unseen">Lanes from above: ${names.join(", ")}</p>` : null}
    <div class="strip" ref=${box} role="slider" tabindex="0" aria-label="Mission time" aria-valuemin="0" aria-valuemax=${Math.round(end)}
      aria-orientation="horizontal" onPointerDown=${down} onPointerMove=${move}>
      <canvas ref=${canvas} aria-hidden="true"></canvas>
      <span class="needle" ref=${needle} aria-hidden="true"></span>
    </div>
  </section>`;
}

/** CT and TT up to a moment, in words. */
export function spent(mission, t) {
  const [ct, tt] = spentSeconds(mission, t);
  return `CT ${fixed(ct, 0)} s, TT ${fixed(tt, 0)} s`;
}

/** CT and TT up to a moment, seconds. */
export function spentSeconds(mission, t) {
  const index = mission.stepAt(t);
  if (index < 0) return [0, 0];
  const step = mission.steps[index];
  const before = mission.steps[index - 1];
  const gone = Math.min(t, step.ended_s) - step.started_s;
  const looked = Math.min(gone, step.look_s);
  const thought = Math.min(Math.max(0, gone - step.look_s), step.think_s);
  const travelled = Math.min(Math.max(0, gone - step.look_s - step.think_s), step.travel_s);
  return [(before?.ct_s ?? 0) + thought, (before?.tt_s ?? 0) + looked + travelled];
}
