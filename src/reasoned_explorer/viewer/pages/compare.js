// Two missions side by side, in step by mission time.

import * as api from "./api.js";
import { html, isTaken, Outcome, render, Trouble, useEffect, useMemo, useRef, useState } from "./parts.js";
import { calmly, Player } from "./player.js";
import { outcomeOf, stepFrom, timeKey } from "./replay.js";
import { mapKey, Stage } from "./stage.js";
import { Mission } from "./state.js";
import { spentSeconds, Timeline } from "./timeline.js";
import { Views } from "./views.js";
import { checked, choice, clock, ending, fixed, metres } from "./words.js";

const LETTERS = ["A", "B"];

/** What one of the two is doing now. */
function Side({ letter, side, moment, onMap, ground }) {
  const { mission, source } = side;
  const over = moment.t >= mission.end;
  const [ct, tt] = spentSeconds(mission, moment.t);
  return html`<section class="side" aria-label=${`Mission ${letter}: ${mission.header.planner}`}>
    <div class="side-head row"><span class="letter" aria-hidden="true">${letter}</span>
      <h2 class="clip spread" title=${mission.header.planner}><a href=${`#/missions/${source.run}/${source.mission}?t=${moment.t.toFixed(1)}`}>${mission.header.planner}</a></h2>
      <${Outcome} text=${outcomeOf(mission)} /></div>
    <${Stage} label=${`Map of mission ${letter}`} onMap=${onMap} note=${ground.note} attribution=${ground.attribution} />
    <div class="side-words">
      <p class="small row"><b>${over ? `Over at ${clock(mission.end)}` : `Step ${moment.index + 1} of ${mission.steps.length}`}</b>
        <span class="spread"></span><span class="soft figures">CT ${fixed(ct, 0)} s · TT ${fixed(tt, 0)} s${moment.index >= 0 ? ` · ${metres(mission.pathLength(moment.known))}` : ""}</span></p>
      ${moment.step
        ? html`<p class="small">${over ? ending(mission.summary, false) : choice(moment.step)} <span class="soft">${over ? "" : checked(moment.step)}</span></p>
            <div class="side-views"><${Views} step=${moment.step} source=${source} range=${mission.qRange} selected=${null} onSelect=${() => {}} pictures=${mission.pictures} /></div>`
        : null}
    </div>
  </section>`;
}

function Compare({ sides }) {
  const maps = useRef([]);
  const unfollow = useRef(null);
  const cursor = useRef(null);
  const now = useRef(sides.map(({ mission }) => mission.at(0)));
  const [moments, setMoments] = useState(now.current);
  const [grounds, setGrounds] = useState([{}, {}]);
  const tell = useRef(null);
  tell.current ??= calmly(() => setMoments(now.current));
  const [player] = useState(
    () =>
      new Player((t) => {
        now.current = sides.map(({ mission }) => mission.at(t));
        maps.current.forEach((map, i) => map?.show(now.current[i]));
        cursor.current?.(t);
        tell.current();
      }),
  );
  player.end = Math.max(...sides.map(({ mission }) => mission.end));

  /** The nearest decision of either mission in that direction. */
  const onStep = (by) => {
    const moves = sides.map(({ mission }) => mission.moment(stepFrom(mission, player.t, by))).filter((t) => (by > 0 ? t > player.t + 0.05 : t < player.t - 0.05));
    if (moves.length) player.seek(by > 0 ? Math.min(...moves) : Math.max(...moves));
    else player.seek(by > 0 ? player.end : 0);
  };

  useEffect(() => {
    player.seek(0);
    const keys = (event) => {
      if (isTaken(event)) return;
      if (!timeKey(event, player, onStep) && maps.current[0]) mapKey(maps.current[0], event);
    };
    addEventListener("keydown", keys);
    return () => {
      removeEventListener("keydown", keys);
      unfollow.current?.();
      tell.current.stop();
      player.stop();
    };
  }, []);

  const line = useMemo(
    () => html`<${Timeline} missions=${sides.map((side) => side.mission)} names=${sides.map((side) => side.mission.header.planner)} player=${player} cursor=${cursor} onStep=${onStep} />`,
    [sides],
  );
  const onMap = (index) => (made) => {
    const { mission, source } = sides[index];
    maps.current[index] = made;
    made.setMission(mission);
    made.show(now.current[index]);
    const both = sides.map((side) => side.mission.bounds());
    const whole = [0, 1, 2, 3].map((i) => (i < 2 ? Math.min(both[0][i], both[1][i]) : Math.max(both[0][i], both[1][i])));
    const own = made.fit.bind(made);
    made.fit = () => own(whole);
    made.fit();
    if (maps.current[0] && maps.current[1]) unfollow.current = maps.current[0].follow(maps.current[1]);
    api.worldMap(source.run, source.mission, mission.header).then(({ world, why }) => {
      if (maps.current[index] !== made) return;
      made.setWorld(world);
      setGrounds((known) => known.map((one, i) => (i === index ? { note: world ? "" : `No ground is shown: ${why}`, attribution: world?.attribution ?? "" } : one)));
    });
  };
  const { header } = sides[0].mission;
  const same = header.goal === sides[1].mission.header.goal && header.world === sides[1].mission.header.world;
  return html`<div class="compare">
    <div class="title"><a class="button quiet back" href=${`#/runs/${sides[0].source.run}`} aria-label="Back to the list" title="Back to the list">←</a>
      <h1 class="clip" title=${header.goal}>${header.goal}</h1>${header.level ? html`<span class="chip">level ${header.level}</span>` : null}
      ${same ? null : html`<span class="chip warn">not the same episode: “${sides[1].mission.header.goal}”</span>`}</div>
    ${sides.map((side, index) => html`<${Side} key=${index} letter=${LETTERS[index]} side=${side} moment=${moments[index]} onMap=${onMap(index)} ground=${grounds[index]} />`)}
    ${line}
  </div>`;
}

function Loader({ pairs }) {
  const [state, setState] = useState({});
  useEffect(() => {
    let gone = false;
    Promise.all(pairs.map(([run, mission]) => api.mission(run, mission))).then(
      (records) => gone || setState({ sides: records.map((record, i) => ({ mission: new Mission(record), source: { run: pairs[i][0], mission: pairs[i][1] } })) }),
      (fault) => gone || setState({ fault: fault.message }),
    );
    return () => (gone = true);
  }, []);
  if (state.fault) return html`<${Trouble} words=${state.fault} />`;
  return state.sides ? html`<${Compare} sides=${state.sides} />` : html`<p class="soft pad" role="status">Reading both missions…</p>`;
}

export function mount(main, parts) {
  main.className = "fills";
  const [runA, a, runB, b] = parts;
  render(b ? html`<${Loader} key=${parts.join("/")} pairs=${[[runA, a], [runB, b]]} />` : html`<${Trouble} words="Two missions are needed for a comparison." />`, main);
  return () => render(null, main);
}
