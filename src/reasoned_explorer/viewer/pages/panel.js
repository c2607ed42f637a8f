// What is said beside the map: the step, its views, what was imagined, the frontiers and the mission.

import { html, useState } from "./parts.js";
import { Tree } from "./tree.js";
import { Score, Views } from "./views.js";
import { checked, choice, clock, degrees, ending, fixed, metres, travel } from "./words.js";

const PHASES = { look: "looking", think: "thinking", travel: "travelling", over: "over" };
export const TABS = ["Imagined", "Frontiers", "Mission"];

/** What was decided in a step, and what came in between. */
export function StepWords({ mission, moment }) {
  const { step, index } = moment;
  const events = step.interventions ?? [];
  const last = index === mission.steps.length - 1;
  return html`<div class="step-words">
    <p><b>Choice</b> ${choice(step)} <span class="soft">${travel(step)}</span></p>
    <p class=${step.views.some((view) => view.found) ? "seen" : ""}><b>Checker</b> ${checked(step)}</p>
    ${events.map((event) => html`<p class="guard"><b>Guard</b> ${event.detail} (${event.cause}); ${event.done} <span class="soft">${clock(event.t_s)}</span></p>`)}
    ${step.legs.filter((leg) => leg.outcome === "collision").map((leg) => html`<p class="guard"><b>Collision</b> ${leg.detail}</p>`)}
    ${step.notes.map((note) => html`<p><b>Note</b> ${note}</p>`)}
    ${last && (mission.summary || mission.complete === false) && !mission.running ? html`<p class="ending"><b>End</b> ${ending(mission.summary, false)}</p>` : null}
  </div>`;
}

function Frontiers({ mission, moment, selected, onSelect }) {
  const values = new Map(mission.valuesAt(moment.known).map((row) => [row[0], row]));
  const shown = mission
    .frontiersAt(moment)
    .filter((one) => one.state === "open")
    .sort((a, b) => (values.get(b.id)?.[4] ?? b.q ?? -Infinity) - (values.get(a.id)?.[4] ?? a.q ?? -Infinity) || a.id - b.id);
  if (!shown.length) return html`<p class="soft small pad">No frontier is open.</p>`;
  return html`<table class="frontiers">
    <caption class="unseen">Open frontiers, the best first</caption>
    <thead><tr><th scope="col">Frontier</th><th scope="col">Q</th><th scope="col">way</th><th scope="col">σ(d)</th><th scope="col">Q − σ(d)</th></tr></thead>
    <tbody>${shown.map((one) => {
      const [, , far, sigma, value] = values.get(one.id) ?? [];
      const mark = one.id === moment.chosen ? " chosen" : "";
      return html`<tr key=${one.id} class="${selected === one.id ? "selected" : ""}${mark}">
        <th scope="row"><button class="quiet" aria-pressed=${String(selected === one.id)} onClick=${() => onSelect(selected === one.id ? null : one.id)}>${one.id}${mark ? " · chosen" : ""}${one.forbidden ? " · shunned ground" : ""}</button></th>
        <td><${Score} q=${one.q} range=${mission.qRange} /></td><td>${metres(far)}</td><td>${fixed(sigma)}</td><td><b>${fixed(value)}</b></td></tr>`;
    })}</tbody>
  </table>`;
}

const yes = (value) => (value === null || value === undefined ? "not judged" : value ? "yes" : "no");

function Facts({ rows }) {
  return html`<dl class="facts">${rows.filter(([, value]) => value !== null && value !== undefined && value !== "").map(([name, value]) => html`<dt>${name}</dt><dd>${value}</dd>`)}</dl>`;
}

function MissionWords({ mission }) {
  const { header, summary } = mission;
  const judged = summary
    ? [
        ["End", summary.end], ["Success", yes(summary.success)], ["Oracle success", yes(summary.oracle_success)],
        ["Ground kept", summary.compliant === null ? null : yes(summary.compliant)],
        ["SPL, CASR", `${fixed(summary.spl)}, ${fixed(summary.casr)}`],
        ["Path", `${metres(summary.path_length_m)}; shortest ${metres(summary.reference_length_m)}`],
        ["To the goal", metres(summary.distance_to_goal_m)],
        ["Time", `CT ${fixed(summary.ct_s, 0)} s + TT ${fixed(summary.tt_s, 0)} s`],
        ["Calls", Object.entries(summary.calls).map(([role, n]) => `${n} ${role}`).join(", ") || "none"],
        ["Collisions", summary.collisions.length ? `${summary.collisions.length}: ${summary.collisions.join(", ")}` : "none"],
        ["Judge", summary.judge],
      ]
    : [["End", "the record has none (yet)"]];
  return html`<div class="pad">
    <${Facts} rows=${judged} />
    <h3>Set up</h3>
    <${Facts} rows=${[
      ["Planner", header.planner], ["Minds", header.minds], ["Eyes", header.captioner], ["Vehicle", header.vehicle], ["World", header.world],
      ["Start", `${fixed(header.start[0], 0)} m east, ${fixed(header.start[1], 0)} m north, heading ${degrees(header.start[3])}`],
      ["Clock", `${header.clock}; CT ${header.ct_label}`], ["Seed", String(header.seed)], ["Goal is read as", (header.understood ?? []).join("; ")],
      ["Notes", (header.notes ?? []).join(" ")], ["Map", header.attribution],
    ]} />
  </div>`;
}

/** The whole panel of a replay or of a live mission. */
export function Panel({ mission, moment, source, selected, onSelect, tab, onTab, pictures = mission.pictures }) {
  const [own, setOwn] = useState(0);
  const at = tab ?? own;
  const go = onTab ?? setOwn;
  if (!moment?.step) return html`<p class="soft pad">The mission has begun; there is no step yet.</p>`;
  const keys = (event) => {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!by) return;
    event.preventDefault();
    event.stopPropagation();
    go((at + by + TABS.length) % TABS.length);
    event.currentTarget.querySelectorAll("[role=tab]")[(at + by + TABS.length) % TABS.length].focus();
  };
  const waits = !moment.decided;
  return html`<div class="panel-inside">
    <div class="step-head row"><h2>Step ${moment.index + 1}<span class="soft"> of ${mission.steps.length}</span></h2>
      <span class="chip phase ${moment.phase}">${PHASES[moment.phase]}</span>
      <span class="spread"></span><span class="soft small figures">look ${fixed(moment.step.look_s, 1)} · think ${fixed(moment.step.think_s, 1)} · travel ${fixed(moment.step.travel_s, 1)} s</span></div>
    <div class=${waits ? "undecided" : ""}><${StepWords} mission=${mission} moment=${moment} /></div>
    <${Views} step=${moment.step} source=${source} range=${mission.qRange} selected=${selected} onSelect=${onSelect} pictures=${pictures} />
    <div class="tabs" role="tablist" aria-label="More of this step" onKeyDown=${keys}>
      ${TABS.map((name, index) => html`<button role="tab" id=${`tab-${index}`} aria-controls="tab-panel" aria-selected=${String(at === index)} tabindex=${at === index ? "0" : "-1"} onClick=${() => go(index)}>${name}</button>`)}
    </div>
    <div class="tab-panel" role="tabpanel" id="tab-panel" aria-labelledby=${`tab-${at}`}>
      ${at === 0 ? html`<${Tree} step=${moment.step} range=${mission.qRange} />` : at === 1 ? html`<${Frontiers} ...${{ mission, moment, selected, onSelect }} />` : html`<${MissionWords} mission=${mission} />`}
    </div>
  </div>`;
}
