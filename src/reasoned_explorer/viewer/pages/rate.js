// The page on which people judge missions: one at a time, blind to the method.

import { html, render, isTaken, Trouble, useEffect, useRef, useState } from "./parts.js";
import { isDark, onTheme, toggleTheme } from "./palette.js";
import { about, drafts, enter, mission as open, picture, save, worldMap } from "./rate_api.js";
import { ANSWERS, Form, isWhole } from "./rate_form.js";
import { Round, Way } from "./rate_scene.js";

const WHO = "rex-rate-rater";
const EMPTY = { answer: null, how_well: null, comment: "" };
const QUIET = { words: "", tone: "" };

/** A draft as a form takes it, whatever lies in the browser's storage. */
function formOf(found) {
  const answer = ANSWERS.some(([value]) => value === found?.answer) ? found.answer : null;
  const grade = Number.isInteger(found?.how_well) && found.how_well >= 1 && found.how_well <= 5 ? found.how_well : null;
  return { answer, how_well: grade, comment: typeof found?.comment === "string" ? found.comment : "" };
}

const ahead = (mission) => Math.floor((Math.max(1, mission.pictures.length) - 1) / 2);

/** The place that the address names, or the first that has no answer, or the end. */
function firstPlace({ items, rated }) {
  const named = Number(location.hash.slice(1));
  if (Number.isInteger(named) && named >= 1 && named <= items.length) return named - 1;
  const open = rated.indexOf(0);
  return open < 0 ? items.length : open;
}

/** The next mission without an answer after a place, from the start again at the end; the length where there is none. */
function nextOpen(rated, place) {
  const later = rated.indexOf(0, place + 1);
  if (later >= 0) return later;
  const earlier = rated.indexOf(0);
  return earlier < 0 ? rated.length : earlier;
}

/** Keys that belong to a radio button that has the focus. */
const isRadioKey = (event) => event.ctrlKey || event.metaKey || event.altKey || event.key === " " || event.key === "Tab" || event.key.startsWith("Arrow");

function Who({ facts, onEnter, fault }) {
  const [name, setName] = useState("");
  return html`<main class="who card">
    <h1>Judge missions</h1>
    <p>A robot was told in a sentence what to find outdoors. You see what it was told, where it ended, and what is to be seen there. Say whether it did what was asked.</p>
    <p class="soft">There are ${facts.missions.toLocaleString("en")} missions. Stop whenever you like: each answer is kept at once, and you can go on later under the same name.</p>
    <form onSubmit=${(event) => { event.preventDefault(); onEnter(name); }}>
      <label>Your name, or another word that stands for you
        <input type="text" autofocus required maxlength=${facts.longest_name} autocomplete="username" value=${name} onInput=${(event) => setName(event.target.value)} /></label>
      <button class="main" type="submit">Begin</button>
    </form>
    ${fault ? html`<${Trouble} words=${fault} />` : null}
  </main>`;
}

function Bar({ progress, place, onGo, onLeave, fixed }) {
  const [dark, setDark] = useState(isDark());
  useEffect(() => onTheme(() => setDark(isDark())), []);
  const of = progress.items.length;
  const rated = progress.rated.filter(Boolean).length;
  return html`<header class="bar">
    <span class="brand">Judge missions</span>
    <button class="quiet" disabled=${place === 0} onClick=${() => onGo(place - 1)} title="The one before (PageUp)" aria-label="The mission before">‹ Back</button>
    <span class="figures">${place < of ? html`mission <b>${place + 1}</b> of ${of}` : "the end"}</span>
    <button class="quiet" disabled=${place >= of} onClick=${() => onGo(place + 1)} title="The one after (PageDown)" aria-label="The mission after">Forward ›</button>
    <progress class="done" max=${of} value=${rated} aria-label=${`${rated} of ${of} rated`}></progress>
    <span class="soft small figures">${rated} rated</span>
    <span class="spread"></span>
    <span class="soft small clip who-is" title=${progress.rater}>${progress.rater}</span>
    ${fixed ? null : html`<button class="quiet small" onClick=${onLeave}>Somebody else</button>`}
    <button class="quiet" onClick=${toggleTheme} aria-label=${dark ? "Light colours" : "Dark colours"} title=${dark ? "Light colours" : "Dark colours"}>${dark ? "☀" : "☾"}</button>
  </header>`;
}

/** Fetch what the next mission shows while this one is looked at. */
function fetchAhead(item, rater) {
  open(item, rater).then(async (mission) => {
    await worldMap(item);
    mission.pictures.forEach((_, place) => (new Image().src = picture(item, place)));
  }, () => {});
}

function Rating({ facts, start, onLeave }) {
  const [progress, setProgress] = useState(start);
  const [place, setPlace] = useState(() => firstPlace(start));
  const [mission, setMission] = useState(null);
  const [form, setForm] = useState(EMPTY);
  const [looked, setLooked] = useState(0);
  const [status, setStatus] = useState(QUIET);
  const [saving, setSaving] = useState(false);
  const [fault, setFault] = useState("");
  // What holds at this moment: keys come faster than the page is drawn, and must not fall on another mission.
  const now = useRef({ form: EMPTY, ready: null, saving: false });
  const pressed = useRef(null);
  const commentBox = useRef(null);
  const goal = useRef(null);
  const { rater, items } = progress;
  const item = items[place];

  const fill = (changed) => {
    now.current.form = changed;
    setForm(changed);
  };
  const go = (to) => {
    const next = Math.min(items.length, Math.max(0, to));
    if (next === place) return;
    now.current.ready = null;
    setPlace(next);
    setStatus(QUIET);
  };

  useEffect(() => {
    history.replaceState(null, "", place < items.length ? `#${place + 1}` : "#");
    setFault("");
    now.current.ready = null;
    if (!item) {
      setMission(null);
      return undefined;
    }
    let here = true;
    open(item, rater).then(
      (found) => {
        if (!here) return;
        fill(formOf(drafts.get(drafts.key(rater, item)) ?? found.mine));
        now.current.ready = item;
        setLooked(ahead(found));
        setMission(found);
        goal.current?.focus({ preventScroll: true });
      },
      (why) => here && setFault(why.message),
    );
    return () => (here = false);
  }, [item]);

  const change = (part) => {
    if (now.current.ready !== item) return;
    const changed = { ...now.current.form, ...part };
    fill(changed);
    setStatus(QUIET);
    drafts.set(drafts.key(rater, item), changed);
  };

  const keep = async () => {
    const said = now.current.form;
    if (now.current.saving || now.current.ready !== item || !isWhole(said)) return;
    now.current.saving = true;
    setSaving(true);
    setStatus({ words: "Saving …", tone: "" });
    try {
      await save(item, { rater, ...said });
    } catch (why) {
      setStatus({ words: `Not saved: ${why.message} What you said stays here; press Enter to try again.`, tone: "bad" });
      return;
    } finally {
      now.current.saving = false;
      setSaving(false);
    }
    const rated = progress.rated.map((one, at) => (at === place ? 1 : one));
    setProgress((before) => ({ ...before, rated: before.rated.map((one, at) => (at === place ? 1 : one)) }));
    const here = now.current.ready === item;
    // What was said while it was on its way is not sent yet: it stays.
    if (here && now.current.form !== said) return;
    drafts.set(drafts.key(rater, item), null);
    if (!here) return;
    go(nextOpen(rated, place));
    setStatus({ words: `Mission ${place + 1} is saved.`, tone: "good" });
  };

  const turn = (by) => mission?.pictures.length && setLooked((at) => (at + by + mission.pictures.length) % mission.pictures.length);

  pressed.current = (event) => {
    const target = event.target instanceof Element ? event.target : document.body;
    const writes = target.closest("textarea, input[type=text]");
    if (writes && event.key === "Escape") target.blur();
    if (writes && event.key === "Enter" && (event.ctrlKey || event.metaKey)) return keep();
    if (target.matches("input[type=radio]") ? isRadioKey(event) : isTaken(event)) return undefined;
    const answer = ANSWERS.find(([, , key]) => key === event.key.toLowerCase());
    if (answer) change({ answer: answer[0] });
    else if (/^[1-5]$/.test(event.key)) change({ how_well: Number(event.key) });
    else if (event.key === "Enter") {
      if (target.closest("button:not([type=submit]), a")) return undefined;
      keep();
    } else if (event.key === "ArrowLeft") turn(-1);
    else if (event.key === "ArrowRight") turn(1);
    else if (event.key === "PageUp") go(place - 1);
    else if (event.key === "PageDown") go(place + 1);
    else if (event.key === "c") commentBox.current?.focus();
    else return undefined;
    event.preventDefault();
    return undefined;
  };
  useEffect(() => {
    const press = (event) => pressed.current(event);
    addEventListener("keydown", press);
    return () => removeEventListener("keydown", press);
  }, []);

  const ahead1 = () => {
    const next = items[nextOpen(progress.rated, place)];
    if (next && next !== item) fetchAhead(next, rater);
  };

  const bar = html`<${Bar} progress=${progress} place=${place} onGo=${go} onLeave=${onLeave} fixed=${facts.rater !== null} />`;
  if (!item) return html`<div class="frame">${bar}<${End} progress=${progress} onGo=${go} status=${status} /></div>`;
  if (fault) return html`<div class="frame">${bar}<main><${Trouble} words=${fault} /></main></div>`;
  if (!mission) return html`<div class="frame">${bar}<main><p class="soft wait">Opening the mission …</p></main></div>`;
  return html`<div class="frame">${bar}
    <main class="rate ${mission.item === item ? "" : "waits"}">
      <div class="goal">
        <span class="soft small">It was told</span>
        <h1 tabindex="-1" ref=${goal}>“${mission.goal}”</h1>
        ${mission.mine ? html`<span class="chip accent">You have rated this one. A change is kept beside what you said before.</span>` : null}
      </div>
      <${Round} mission=${mission} looked=${looked} onLook=${setLooked} onLoaded=${ahead1} />
      <${Way} mission=${mission} looked=${looked} />
      <${Form} question=${facts.question} form=${form} onChange=${change} onSave=${keep} commentBox=${commentBox} longest=${facts.longest_comment}
        saving=${saving} status=${status} mine=${mission.mine} />
      <p class="keys tiny soft"><kbd>y</kbd> <kbd>p</kbd> <kbd>n</kbd> answer · <kbd>1</kbd>–<kbd>5</kbd> how well · <kbd>Enter</kbd> save · <kbd>←</kbd> <kbd>→</kbd> look round · <kbd>PageUp</kbd> back · <kbd>c</kbd> comment, <kbd>Esc</kbd> leaves it</p>
    </main>
  </div>`;
}

function End({ progress, onGo, status }) {
  const open = progress.rated.filter((one) => !one).length;
  return html`<main class="who card">
    <h1>${open ? "That was the last one" : "All missions are rated"}</h1>
    <p>${open ? `${open} of ${progress.rated.length} have no answer yet.` : "Thank you. You can go back and change what you said."}</p>
    <p class="status small ${status.tone}" role="status">${status.words}</p>
    <button class="main" onClick=${() => onGo(open ? progress.rated.indexOf(0) : progress.rated.length - 1)}>${open ? "To the first without an answer" : "To the last one"}</button>
  </main>`;
}

function Page() {
  const [facts, setFacts] = useState(null);
  const [start, setStart] = useState(null);
  const [fault, setFault] = useState("");
  const begin = (name) => enter(name).then(
    (found) => {
      drafts.set(WHO, found.rater);
      setFault("");
      setStart(found);
    },
    (why) => setFault(why.message),
  );
  useEffect(() => {
    about().then(
      (found) => {
        setFacts(found);
        const name = found.rater ?? drafts.get(WHO);
        if (typeof name === "string") begin(name);
      },
      (why) => setFault(why.message),
    );
  }, []);
  const leave = () => {
    drafts.set(WHO, null);
    history.replaceState(null, "", "#");
    setStart(null);
  };
  if (start) return html`<${Rating} facts=${facts} start=${start} onLeave=${leave} />`;
  if (facts) return html`<${Who} facts=${facts} onEnter=${begin} fault=${fault} />`;
  return fault ? html`<${Trouble} words=${fault} />` : null;
}

render(html`<${Page} />`, document.getElementById("page"));
