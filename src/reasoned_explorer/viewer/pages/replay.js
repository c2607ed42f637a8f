// The replay of one mission: map, panel and time line.

import * as api from "./api.js";
import { Panel, TABS } from "./panel.js";
import { html, isTaken, Outcome, presses, render, Trouble, useEffect, useMemo, useRef, useState } from "./parts.js";
import { calmly, Player, SPEEDS } from "./player.js";
import { mapKey, Stage } from "./stage.js";
import { Mission } from "./state.js";
import { Table } from "./table.js";
import { Timeline } from "./timeline.js";
import { metres } from "./words.js";

/** The step that "one step on" or "one step back" leads to from a moment. */
export function stepFrom(mission, t, by) {
  const index = mission.stepAt(t);
  const at = mission.moment(Math.max(0, index));
  if (by < 0 && t > at + 0.05) return index; // first back to this step's own decision
  if (by > 0 && t < at - 0.05) return index;
  return Math.min(mission.steps.length - 1, Math.max(0, index + by));
}

/** Keys that all pages with a time line have. Returns whether the key was one. */
export function timeKey(event, player, onStep) {
  if (presses(event)) return false;
  const keys = {
    ArrowRight: () => (event.shiftKey ? player.seek(player.t + 1) : onStep(1)),
    ArrowLeft: () => (event.shiftKey ? player.seek(player.t - 1) : onStep(-1)),
    PageDown: () => onStep(10),
    PageUp: () => onStep(-10),
    Home: () => player.seek(0),
    End: () => player.seek(player.end),
    " ": () => player.toggle(),
    "[": () => player.setSpeed(SPEEDS[Math.max(0, SPEEDS.indexOf(player.speed) - 1)]),
    "]": () => player.setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, SPEEDS.indexOf(player.speed) + 1)]),
  };
  if (!keys[event.key]) return false;
  if (event.key !== " " && event.key !== "[" && event.key !== "]") player.toggle(false);
  keys[event.key]();
  event.preventDefault();
  return true;
}

/** Outcome for people from a record's summary. */
export const outcomeOf = (mission) =>
  mission.summary ? (mission.summary.success === null ? "not judged" : mission.summary.success ? "success" : "failure") : "not judged";

function Compare({ run, mission }) {
  const [peers, setPeers] = useState([]);
  useEffect(() => {
    let gone = false;
    api.run(run).then((answer) => {
      const table = new Table(answer);
      const row = table.find(mission);
      if (!gone && row) setPeers(table.peers(row).map((one) => table.item(one)));
    }, () => {});
    return () => (gone = true);
  }, [run, mission]);
  if (!peers.length) return null;
  const go = (event) => event.target.value && (location.hash = `#/compare/${run}/${mission}/${run}/${event.target.value}`);
  return html`<label class="row small"><span class="soft">Compare with</span>
    <select class="compare-with" onChange=${go}><option value="">another method…</option>${peers.map((one) => html`<option value=${one.id}>${one.method} (${one.outcome})</option>`)}</select></label>`;
}

export function Title({ run, missionId, mission, children }) {
  const { header, summary } = mission;
  return html`<div class="title">
    ${run ? html`<a class="button quiet back" href=${`#/runs/${run}`} aria-label="Back to the list" title="Back to the list">←</a>` : null}
    <h1 class="clip" title=${header.goal}>${header.goal}</h1>
    ${header.level ? html`<span class="chip">level ${header.level}</span>` : null}
    ${summary ? html`<${Outcome} text=${outcomeOf(mission)} />` : null}
    <span class="soft small clip agent" title=${header.planner}>${header.planner}</span>
    <span class="soft small nowrap">${summary ? metres(summary.path_length_m) : ""}</span>
    <span class="spread"></span>${children}
  </div>`;
}

function Replay({ run, missionId, record, start }) {
  const [{ mission }] = useState(() => ({ mission: new Mission(record) }));
  const map = useRef(null);
  const cursor = useRef(null);
  const now = useRef(mission.at(start));
  const [moment, setMoment] = useState(now.current);
  const [selected, setSelected] = useState(null);
  const [tab, setTab] = useState(0);
  const [ground, setGround] = useState({ note: "", attribution: "" });
  const tell = useRef(null);
  tell.current ??= calmly(() => setMoment(now.current));
  const [player] = useState(
    () =>
      new Player((t) => {
        const before = now.current;
        now.current = mission.at(t);
        map.current?.show(now.current);
        cursor.current?.(t);
        const same = before.index === now.current.index && before.phase === now.current.phase && t < mission.end === before.t < mission.end;
        if (!same) tell.current();
      }),
  );
  player.end = mission.end;
  const onStep = (by) => player.seek(mission.moment(stepFrom(mission, player.t, by)));

  useEffect(() => {
    player.seek(start);
    const keys = (event) => {
      if (isTaken(event)) return;
      const index = ["1", "2", "3"].indexOf(event.key);
      if (index >= 0 && index < TABS.length) setTab(index);
      else if (!timeKey(event, player, onStep) && map.current) mapKey(map.current, event);
    };
    addEventListener("keydown", keys);
    let written = player.t;
    const address = setInterval(() => {
      // The address says where one is, so that it can be sent to somebody; it is written when nothing moves.
      if (player.playing || player.t === written) return;
      written = player.t;
      history.replaceState(null, "", `#/missions/${run}/${missionId}?t=${player.t.toFixed(1)}`);
    }, 500);
    return () => {
      removeEventListener("keydown", keys);
      clearInterval(address);
      tell.current.stop();
      player.stop();
    };
  }, []);

  // The time line is drawn once, and not with each step that the panel shows.
  const line = useMemo(() => html`<${Timeline} missions=${[mission]} player=${player} cursor=${cursor} onStep=${onStep} />`, [mission]);
  const onMap = (made) => {
    map.current = made;
    made.setMission(mission);
    made.fit();
    made.show(now.current);
    api.worldMap(run, missionId, mission.header).then(({ world, why }) => {
      if (map.current !== made) return;
      made.setWorld(world);
      setGround({ note: world ? "" : `No ground is shown: ${why}`, attribution: world?.attribution ?? "" });
    });
  };
  const select = (frontier) => {
    setSelected(frontier);
    map.current?.select(frontier);
  };
  return html`<div class="replay">
    <${Title} run=${run} mission=${mission}><${Compare} run=${run} mission=${missionId} /><//>
    <${Stage} label="Map of the mission" onMap=${onMap} note=${ground.note} attribution=${ground.attribution} />
    <section class="panel" aria-label="What happened in this step">
      <${Panel} ...${{ mission, moment, selected, tab }} source=${{ run, mission: missionId }} onSelect=${select} onTab=${setTab} />
    </section>
    ${line}
  </div>`;
}

function Loader({ run, missionId, start }) {
  const [state, setState] = useState({});
  useEffect(() => {
    const stop = new AbortController();
    api.get(api.paths.mission(run, missionId), { signal: stop.signal }).then(
      (record) => setState({ record }),
      (fault) => fault.name !== "AbortError" && setState({ fault: fault.message }),
    );
    return () => stop.abort();
  }, [run, missionId]);
  if (state.fault) return html`<${Trouble} words=${state.fault} />`;
  if (!state.record) return html`<p class="soft pad" role="status">Reading the mission…</p>`;
  return html`<${Replay} run=${run} missionId=${missionId} record=${state.record} start=${start} />`;
}

export function mount(main, [run, missionId], query) {
  const start = Number.parseFloat(query.get("t") ?? "0") || 0;
  main.className = "fills";
  render(html`<${Loader} run=${run} missionId=${missionId} start=${start} />`, main);
  return () => render(null, main);
}
