// A mission while it runs: what is written is added to what is there, and nothing is fetched twice.

import * as api from "./api.js";
import { Feed } from "./feed.js";
import { Panel, TABS } from "./panel.js";
import { html, isTaken, render, useEffect, useRef, useState } from "./parts.js";
import { calmly, Player } from "./player.js";
import { stepFrom, timeKey, Title } from "./replay.js";
import { mapKey, Stage } from "./stage.js";
import { Mission } from "./state.js";
import { Timeline } from "./timeline.js";
import { fixed } from "./words.js";

function State({ feed, mission }) {
  if (!feed) return html`<span class="chip">connecting…</span>`;
  if (mission?.summary) return html`<span class="chip">ended</span>`;
  if (feed.stale) return html`<span class="chip bad" role="status"><span aria-hidden="true">!</span>stale since ${Math.floor(feed.silentS)} s${feed.connected ? "" : ", connecting again"}</span>`;
  if (!feed.connected) return html`<span class="chip warn" role="status">connection lost, connecting again</span>`;
  return html`<span class="chip good"><span aria-hidden="true" class="beat">●</span>live${feed.ageS === null ? "" : `, last line ${fixed(feed.ageS, 0)} s ago`}</span>`;
}

function Live() {
  const [feed, setFeed] = useState(null);
  const [, setVersion] = useState(0); // of the mission: it grows in place
  const [follow, setFollow] = useState(true);
  const [tab, setTab] = useState(0);
  const [selected, setSelected] = useState(null);
  const [source, setSource] = useState(null);
  const [ground, setGround] = useState({ note: "", attribution: "" });
  const at = useRef({ mission: null, map: null, moment: null, follow: true, source: null });
  const cursor = useRef(null);
  const tell = useRef(null);
  tell.current ??= calmly(() => setVersion((n) => n + 1));
  const following = (on) => {
    at.current.follow = on;
    setFollow(on);
  };
  const [player] = useState(
    () =>
      new Player((t) => {
        const { mission, map } = at.current;
        if (!mission) return;
        at.current.moment = mission.at(t);
        map?.show(at.current.moment);
        if (at.current.follow) map?.keepInView(at.current.moment);
        cursor.current?.(t);
        tell.current();
      }),
  );
  const onStep = (by) => {
    const { mission } = at.current;
    if (!mission?.steps.length) return;
    following(false);
    player.seek(mission.moment(stepFrom(mission, player.t, by)));
  };

  const ready = useRef(false);
  const present = () => {
    const { mission, map, source: from } = at.current;
    if (!mission || !map) return;
    map.setMission(mission);
    map.fit();
    if (!from || ready.current) return;
    ready.current = true;
    api.worldMap(from.run, from.mission, mission.header).then(({ world, why }) => {
      at.current.map?.setWorld(world);
      setGround({ note: world ? "" : `No ground is shown: ${why}`, attribution: world?.attribution ?? "" });
    });
  };
  const newest = () => {
    const { mission } = at.current;
    player.end = mission.end;
    if (at.current.follow) player.seek(mission.end);
    tell.current();
  };
  /** What is not in the stream: where pictures and map are, and what distance costs. */
  const settle = () =>
    api.about().then(async ({ live_mission: from }) => {
      if (!from) return;
      at.current.source = from;
      setSource(from);
      present();
      const told = await api.mission(from.run, from.mission).catch(() => null);
      const { mission } = at.current;
      if (!told?.derived || !mission) return;
      mission.sigma = told.derived.sigma ?? [];
      mission.pictures = told.derived.pictures ?? "none";
      at.current.map?.show(at.current.moment ?? mission.at(mission.end));
      tell.current();
    }).catch(() => {});

  useEffect(() => {
    const one = new Feed({
      onHeader: (header) => {
        const known = at.current.mission?.header;
        if (known && JSON.stringify(known) === JSON.stringify(header)) return; // the same after a lost connection
        at.current.mission = new Mission({ header });
        at.current.mission.running = true;
        ready.current = false;
        player.end = 0;
        present();
        settle();
        tell.current();
      },
      onStep: (step) => {
        if (at.current.mission?.append(step)) newest();
      },
      onSummary: (summary) => {
        if (!at.current.mission) return;
        at.current.mission.summary = summary;
        at.current.mission.running = false;
        newest();
      },
      onState: setFeed,
    });
    const keys = (event) => {
      if (isTaken(event)) return;
      const index = ["1", "2", "3"].indexOf(event.key);
      if (index >= 0 && index < TABS.length) setTab(index);
      else if (event.key === "f") following(!at.current.follow);
      else if (timeKey(event, player, onStep)) following(event.key === "End");
      else if (at.current.map) mapKey(at.current.map, event);
    };
    addEventListener("keydown", keys);
    return () => {
      removeEventListener("keydown", keys);
      one.close();
      tell.current.stop();
      player.stop();
    };
  }, []);

  const { mission } = at.current;
  if (!mission) return html`<div class="pad"><p class="row"><${State} feed=${feed} /></p><p class="soft" role="status">Waiting for the first line of a mission.</p></div>`;
  const moment = at.current.moment ?? mission.at(player.t);
  const select = (frontier) => {
    setSelected(frontier);
    at.current.map?.select(frontier);
  };
  const onMap = (map) => {
    at.current.map = map;
    present();
  };
  const toggle = () => {
    following(!at.current.follow);
    if (at.current.follow) newest();
  };
  return html`<div class="replay live" onPointerDown=${(event) => event.target.closest(".strip") && following(false)}>
    <${Title} mission=${mission}><${State} feed=${feed} mission=${mission} /><button aria-pressed=${String(follow)} onClick=${toggle} title="f">Follow</button><//>
    <${Stage} label="Map of the mission" onMap=${onMap} note=${ground.note} attribution=${ground.attribution} />
    <section class="panel" aria-label="What happened in this step"><${Panel} ...${{ mission, moment, source, selected, tab }} onSelect=${select} onTab=${setTab} /></section>
    <${Timeline} missions=${[mission]} player=${player} cursor=${cursor} onStep=${onStep} />
  </div>`;
}

export function mount(main) {
  main.className = "fills";
  render(html`<${Live} />`, main);
  return () => render(null, main);
}
