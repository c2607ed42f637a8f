// The runs, and the missions of a run: filtered, sorted, and only as many rows in the page as can be seen.

import * as api from "./api.js";
import { html, isTaken, Outcome, render, Trouble, useEffect, useLayoutEffect, useMemo, useRef, useState } from "./parts.js";
import { FACETS, Table } from "./table.js";
import { count, fixed, metres } from "./words.js";

const SPARE = 8; // rows above and below what is seen

/** Columns of the list: [name, heading, what it shows, its class]. */
const COLUMNS = [
  ["outcome", "Outcome", (row) => html`<${Outcome} text=${row.outcome} />`, "c-outcome"],
  ["level", "L", (row) => row.level ?? "–", "c-level num"],
  ["goal", "Goal", (row) => html`<span class="clip" title=${row.goal}>${row.goal}</span>`, "c-goal"],
  ["method", "Method", (row) => html`<span class="clip" title=${row.method}>${row.method}</span>`, "c-method"],
  ["place", "Place", (row) => html`<span class="clip" title=${row.place}>${row.place}</span>`, "c-place"],
  ["cause", "Cause", (row) => html`<span class="clip" title=${row.cause}>${row.cause}</span>`, "c-cause"],
  ["spl", "SPL", (row) => fixed(row.spl), "c-figure num"],
  ["casr", "CASR", (row) => fixed(row.casr), "c-figure num"],
  ["ct_s", "CT s", (row) => fixed(row.ct_s, 0), "c-figure num"],
  ["tt_s", "TT s", (row) => fixed(row.tt_s, 0), "c-figure num"],
  ["steps", "Steps", (row) => row.steps ?? "–", "c-figure num"],
  ["path_length_m", "Path", (row) => metres(row.path_length_m), "c-path num"],
];

/** Filters and places in lists outlive a look at a replay. */
const kept = new Map();
const fresh = () => ({ text: "", chosen: {}, sort: "", descending: false, top: 0, active: 0 });

function Filters({ table, state, change, search }) {
  const options = useMemo(
    () => FACETS.filter(([name]) => table.at.has(name)).map(([name, label]) => [name, label, table.counts(table.filtered(state, name), name)]),
    [table, state.text, state.chosen],
  );
  const any = state.text || Object.values(state.chosen).some(Boolean);
  return html`<form class="filters" role="search" onSubmit=${(event) => event.preventDefault()}>
    <input type="search" ref=${search} placeholder="Goal, place or method  ( / )" aria-label="Filter by text in goal, place or method" value=${state.text} onInput=${(event) => change({ text: event.target.value })} />
    ${options.map(([name, label, counts]) => html`<select key=${name} aria-label=${label} class=${state.chosen[name] ? "set" : ""} value=${state.chosen[name] ?? ""}
        onChange=${(event) => change({ chosen: { ...state.chosen, [name]: event.target.value } })}>
      <option value="">${label}: all</option>
      ${counts.map(([value, many]) => html`<option key=${value} value=${value}>${name === "level" && value ? `level ${value}` : value || "(none)"} (${count(many)})</option>`)}
    </select>`)}
    <button type="button" class="quiet" disabled=${!any} onClick=${() => change({ text: "", chosen: {} })}>Clear</button>
  </form>`;
}

function Peers({ table, run, row, close }) {
  const dialog = useRef(null);
  const peers = table.peers(row).map((one) => table.item(one));
  useEffect(() => dialog.current.showModal(), []);
  const item = table.item(row);
  return html`<dialog ref=${dialog} class="peers" aria-labelledby="peers-title" onClose=${close} onClick=${(event) => event.target === event.currentTarget && event.currentTarget.close()}>
    <h2 id="peers-title">Compare with</h2>
    <p class="small soft">${item.method} on “${item.goal}”, ${item.place}</p>
    ${peers.length ? null : html`<p>No other method was given this episode.</p>`}
    <ul>${peers.map((one) => html`<li key=${one.id}><a class="row" href=${`#/compare/${run}/${item.id}/${run}/${one.id}`}><span class="spread">${one.method}</span><${Outcome} text=${one.outcome} /></a></li>`)}</ul>
    <button onClick=${() => dialog.current.close()}>Close</button>
  </dialog>`;
}

function Rows({ table, rows, run, state, keep, compare }) {
  const box = useRef(null);
  const [top, setTop] = useState(state.top);
  const [height, setHeight] = useState(600);
  const [active, setActive] = useState(Math.min(state.active, rows.length - 1));
  const [tall, setTall] = useState(34);
  useLayoutEffect(() => {
    setTall(matchMedia("(pointer: coarse)").matches ? 44 : 34);
    const resized = new ResizeObserver(() => box.current && setHeight(box.current.clientHeight));
    resized.observe(box.current);
    box.current.scrollTop = state.top;
    requestAnimationFrame(() => performance.mark("rows-shown")); // for whoever measures the page
    return () => resized.disconnect();
  }, []);
  useLayoutEffect(() => {
    if (active >= rows.length) setActive(Math.max(0, rows.length - 1));
  }, [rows]);
  const first = Math.max(0, Math.floor(top / tall) - SPARE);
  const last = Math.min(rows.length, Math.ceil((top + height) / tall) + SPARE);
  const open = (row) => {
    if (table.value(row, "has_record") === 0) return;
    location.hash = `#/missions/${run}/${table.value(row, "id")}`;
  };
  const go = (to) => {
    const at = Math.min(rows.length - 1, Math.max(0, to));
    setActive(at);
    keep({ active: at });
    const view = box.current;
    if (at * tall < view.scrollTop) view.scrollTop = at * tall;
    else if ((at + 1) * tall > view.scrollTop + view.clientHeight) view.scrollTop = (at + 1) * tall - view.clientHeight;
  };
  const keys = (event) => {
    const page = Math.max(1, Math.floor(height / tall) - 1);
    const moves = {
      ArrowDown: () => go(active + 1),
      ArrowUp: () => go(active - 1),
      PageDown: () => go(active + page),
      PageUp: () => go(active - page),
      Home: () => go(0),
      End: () => go(rows.length - 1),
      Enter: () => rows[active] && open(rows[active]),
      c: () => rows[active] && compare(rows[active]),
    };
    if (!moves[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    moves[event.key]();
  };
  const scrolled = (event) => {
    setTop(event.currentTarget.scrollTop);
    keep({ top: event.currentTarget.scrollTop });
  };
  return html`<div class="rows" ref=${box} tabindex="0" role="rowgroup" onScroll=${scrolled} onKeyDown=${keys} aria-label="Missions"
      aria-activedescendant=${rows.length ? `row-${active}` : undefined}>
    <div class="rows-all" role="presentation" ref=${(el) => el && (el.style.height = `${rows.length * tall}px`)}>
      ${rows.slice(first, last).map((raw, i) => {
        const at = first + i;
        const row = table.item(raw);
        return html`<div key=${row.id} id=${`row-${at}`} role="row" aria-rowindex=${at + 2} aria-selected=${String(at === active)} class="line ${at === active ? "active" : ""} ${row.has_record === 0 ? "bare" : ""}"
            ref=${(el) => el && (el.style.transform = `translateY(${at * tall}px)`, el.style.height = `${tall}px`)} onClick=${() => (setActive(at), keep({ active: at }), open(raw))}>
          ${COLUMNS.map(([name, , show, kind]) => html`<span role="gridcell" class=${kind}>${show(row)}</span>`)}
          <span role="gridcell" class="c-more"><button class="quiet small" tabindex="-1" title="Compare with another method (c)" aria-label="Compare" onClick=${(event) => (event.stopPropagation(), compare(raw))}>⇄</button></span>
        </div>`;
      })}
    </div>
  </div>`;
}

function Missions({ run, answer }) {
  const table = useMemo(() => new Table(answer), [answer]);
  if (!kept.has(run)) kept.set(run, fresh());
  const [state, setState] = useState(kept.get(run));
  const [row, setRow] = useState(null);
  const search = useRef(null);
  const keep = (part) => Object.assign(kept.get(run), part); // no new picture of the page
  const change = (part) => {
    const next = { ...kept.get(run), top: 0, active: 0, ...part };
    kept.set(run, next);
    setState(next);
  };
  const rows = useMemo(
    () => (state.sort ? table.sorted(table.filtered(state), state.sort, state.descending) : table.filtered(state)),
    [table, state.text, state.chosen, state.sort, state.descending],
  );
  useEffect(() => {
    const keys = (event) => {
      if (event.key !== "/" || isTaken(event)) return;
      event.preventDefault();
      search.current.focus();
      search.current.select();
    };
    addEventListener("keydown", keys);
    return () => removeEventListener("keydown", keys);
  }, []);
  const sort = (name) => change({ sort: name, descending: state.sort === name ? !state.descending : false });
  const order = (name) => (state.sort !== name ? "none" : state.descending ? "descending" : "ascending");
  return html`<div class="missions">
    <div class="title"><a class="button quiet back" href="#/?all" aria-label="All runs" title="All runs">←</a><h1 class="clip" title=${answer.name}>${answer.name}</h1><span class="spread"></span><${Rate} rows=${rows} table=${table} />
      <output class="count small" aria-live="polite">${rows.length === table.rows.length ? `${count(rows.length)} missions` : `${count(rows.length)} of ${count(table.rows.length)} missions`}</output></div>
    <${Filters} ...${{ table, state, change, search }} />
    <div class="grid card" role="grid" aria-label="Missions of the run" aria-rowcount=${rows.length + 1} aria-colcount=${COLUMNS.length + 1}>
      <div role="rowgroup" class="heads"><div role="row" class="line" aria-rowindex="1">
        ${COLUMNS.map(([name, label, , kind]) => html`<span role="columnheader" aria-sort=${order(name)} class=${kind}><button class="quiet small" onClick=${() => sort(name)}>${label}<span aria-hidden="true">${{ ascending: " ▲", descending: " ▼", none: "" }[order(name)]}</span></button></span>`)}
        <span role="columnheader" class="c-more"><span class="unseen">Compare</span></span>
      </div></div>
      ${rows.length ? html`<${Rows} key=${JSON.stringify([state.text, state.chosen, state.sort, state.descending])} ...${{ table, rows, run, state, keep }} compare=${setRow} />` : html`<p class="soft pad">No mission fits. <button class="quiet" onClick=${() => change({ text: "", chosen: {} })}>Show all</button></p>`}
    </div>
    ${row ? html`<${Peers} table=${table} run=${run} row=${row} close=${() => setRow(null)} />` : null}
  </div>`;
}

/** The share of the shown missions that succeeded. */
function Rate({ rows, table }) {
  const judged = rows.filter((row) => ["success", "failure"].includes(table.value(row, "outcome")));
  if (!judged.length) return null;
  const good = judged.filter((row) => table.value(row, "outcome") === "success").length;
  return html`<span class="soft small nowrap rate">${count(good)} of ${count(judged.length)} judged succeeded (${fixed((100 * good) / judged.length, 1)} %)</span>`;
}

const KINDS = { bench: "benchmark", mission: "one mission", missions: "missions" };

function Runs({ runs }) {
  if (!runs.length) return html`<p class="pad">There is no run here yet. <code>rex bench</code> and <code>rex run --record</code> make some.</p>`;
  return html`<div class="runs"><h1>Runs</h1><ul>
    ${runs.map((one) => html`<li key=${one.id}><a class="card run" href=${`#/runs/${one.id}`}>
      <b class="clip">${one.name}</b><span class="soft small">${KINDS[one.kind] ?? one.kind}</span>
      <span class="figures nowrap">${count(one.missions)} ${one.missions === 1 ? "mission" : "missions"}</span>
      <span class="soft small clip" title=${one.methods.join(", ")}>${one.methods.length > 3 ? `${one.methods.slice(0, 3).join(", ")} and ${one.methods.length - 3} more` : one.methods.join(", ")}</span>
    </a></li>`)}</ul></div>`;
}

function Load({ ask, show }) {
  const [state, setState] = useState({});
  useEffect(() => {
    let gone = false;
    ask().then((answer) => gone || setState({ answer }), (fault) => gone || setState({ fault: fault.message }));
    return () => (gone = true);
  }, []);
  if (state.fault) return html`<${Trouble} words=${state.fault} />`;
  return state.answer ? show(state.answer) : html`<p class="soft pad" role="status">Reading…</p>`;
}

/** Open a run's list, or the list of runs; of a single run at once its missions. */
export function mount(main, [run], query) {
  main.className = "fills";
  if (run) {
    render(html`<${Load} key=${run} ask=${() => api.run(run)} show=${(answer) => html`<${Missions} run=${run} answer=${answer} />`} />`, main);
  } else {
    const all = query.has("all");
    const show = (runs) => {
      if (runs.length === 1 && !all) {
        location.replace(`#/runs/${runs[0].id}`);
        return null;
      }
      return html`<${Runs} runs=${runs} />`;
    };
    render(html`<${Load} key="runs" ask=${api.runs} show=${show} />`, main);
  }
  return () => render(null, main);
}
