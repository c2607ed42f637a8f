// The imagined tree of a step. Keys say who is whose child: a child's key is its parent's and one figure more.

import { html, useEffect, useRef, useState } from "./parts.js";
import { bearing, fixed } from "./words.js";
import { Score } from "./views.js";

const name = (key) => key.join(".");

/**
 * Views with what is imagined beyond them.
 * @returns {{id: string, label: string, node: object|null, view: object|null, children: object[]}[]}
 */
export function treeOf(step) {
  const places = new Map();
  const roots = [];
  for (const view of step.views) {
    const place = { id: name(view.key), view, node: null, children: [] };
    places.set(place.id, place);
    roots.push(place);
  }
  const nodes = [...step.tree].sort((a, b) => a.key.length - b.key.length);
  for (const node of nodes) {
    const place = { id: name(node.key), view: null, node, children: [] };
    places.set(place.id, place);
    let parent = null;
    for (let length = node.key.length - 1; length > 0 && !parent; length -= 1) parent = places.get(name(node.key.slice(0, length)));
    (parent?.children ?? roots).push(place);
  }
  return roots;
}

const best = (place) =>
  place.children.reduce((most, child) => Math.max(most, child.node?.score ?? -Infinity, best(child)), -Infinity);
const size = (place) => place.children.reduce((sum, child) => sum + 1 + size(child), 0);

/** How sure the evaluator is of each level from 1 to 5. */
function Levels({ levels }) {
  const words = levels.map((share, index) => `${index + 1}: ${Math.round(share * 100)} %`).join(", ");
  return html`<span class="levels" role="img" aria-label=${`Levels ${words}`} title=${words}>
    ${levels.map((share) => html`<i ref=${(el) => el && (el.style.height = `${Math.max(6, share * 100)}%`)}></i>`)}
  </span>`;
}

function Branch({ place, depth, step, range, open, active, toggle, focus }) {
  const { id, node, view, children } = place;
  const unfolded = open.has(id);
  const q = node ? node.score : view.q;
  const flags = [(node ?? view).blocked && "blocked", (node ?? view).forbidden && "shunned ground"].filter(Boolean);
  const text = node ? node.text || node.fault || "(nothing)" : `View ${bearing(view.heading_rad, step.pose[3])}`;
  const click = (event) => {
    event.stopPropagation();
    focus(id);
    if (children.length) toggle(id);
  };
  return html`<li role="treeitem" id=${`node-${id}`} data-node=${id} aria-level=${depth} aria-expanded=${children.length ? String(unfolded) : undefined} aria-selected=${String(active === id)}
    tabindex=${active === id ? "0" : "-1"} onClick=${click} onFocus=${(event) => event.target === event.currentTarget && focus(id)}>
    <div class="node ${view ? "root" : ""} ${node?.fault ? "faulty" : ""}">
      <span class="fold" aria-hidden="true">${children.length ? (unfolded ? "▾" : "▸") : ""}</span>
      <${Score} q=${q} range=${range} />
      ${node?.levels ? html`<${Levels} levels=${node.levels} />` : null}
      <span class="node-text">${text}${flags.map((flag) => html` <span class="chip bad">${flag}</span>`)}
        ${view && children.length ? html`<span class="soft tiny"> ${size(place)} imagined, best ${fixed(Number.isFinite(best(place)) ? best(place) : null)}</span>` : null}</span>
    </div>
    ${children.length && unfolded ? html`<ul role="group">${children.map((child) => html`<${Branch} key=${child.id} ...${{ place: child, depth: depth + 1, step, range, open, active, toggle, focus }} />`)}</ul>` : null}
  </li>`;
}

/** The tree, with the keys that trees have. */
export function Tree({ step, range }) {
  const box = useRef(null);
  const roots = treeOf(step);
  const [open, setOpen] = useState(new Set());
  const [active, setActive] = useState(roots[0]?.id ?? null);
  const wanted = useRef(false);
  // Keys may come faster than the page is drawn: each acts on what the one before it left.
  const now = useRef({});
  now.current = { open, active };
  useEffect(() => {
    // The branch that was chosen, or the best one, is unfolded at first.
    const chosen = step.views.find((view) => view.frontier !== null && view.frontier === step.choice?.frontier);
    const first = chosen ? name(chosen.key) : roots.reduce((one, other) => (best(other) > best(one) ? other : one), roots[0])?.id;
    setOpen(new Set(first ? [first] : []));
    setActive(roots[0]?.id ?? null);
  }, [step]);
  useEffect(() => {
    // Where a key has gone on meanwhile, what is drawn then takes the focus.
    if (!wanted.current || active !== now.current.active) return;
    wanted.current = false;
    box.current?.querySelector('[role="treeitem"][tabindex="0"]')?.focus();
  });
  if (!step.tree.length) return html`<p class="soft small pad">Nothing was imagined in this step.</p>`;

  const openAll = (ids) => {
    now.current.open = ids;
    setOpen(ids);
  };
  const activate = (id) => {
    now.current.active = id;
    setActive(id);
  };
  const toggle = (id, unfold = !now.current.open.has(id)) => {
    const next = new Set(now.current.open);
    if (unfold) next.add(id);
    else next.delete(id);
    openAll(next);
  };
  const visibleOf = (places, parent = null) =>
    places.flatMap((place) => [
      { place, parent },
      ...(now.current.open.has(place.id) ? visibleOf(place.children, place) : []),
    ]);
  const all = (unfold) => {
    const ids = [];
    const gather = (places) => places.forEach((place) => (ids.push(place.id), gather(place.children)));
    gather(roots);
    openAll(new Set(unfold ? ids : []));
  };
  const keys = (event) => {
    const visible = visibleOf(roots);
    const at = visible.findIndex(({ place }) => place.id === now.current.active);
    const { place, parent } = visible[at] ?? {};
    const go = (to) => {
      if (to) activate(to.id);
      wanted.current = true;
    };
    const moves = {
      ArrowDown: () => go(visible[at + 1]?.place),
      ArrowUp: () => go(visible[at - 1]?.place),
      Home: () => go(visible[0]?.place),
      End: () => go(visible.at(-1)?.place),
      ArrowRight: () => (place.children.length && !now.current.open.has(place.id) ? toggle(place.id, true) : go(place.children[0])),
      ArrowLeft: () => (now.current.open.has(place.id) && place.children.length ? toggle(place.id, false) : go(parent)),
      Enter: () => place.children.length && toggle(place.id),
      " ": () => place.children.length && toggle(place.id),
      "*": () => all(true),
    };
    if (!place || !moves[event.key]) return;
    event.preventDefault();
    event.stopPropagation();
    moves[event.key]();
  };
  return html`<div>
    <div class="row tree-tools"><span class="soft tiny spread">${step.tree.length} imagined scenes, scored from 1 to 5</span>
      <button class="quiet small" onClick=${() => all(true)}>Unfold all</button><button class="quiet small" onClick=${() => all(false)}>Fold</button></div>
    <ul class="tree" role="tree" aria-label="Imagined scenes" ref=${box} onKeyDown=${keys}>
      ${roots.map((place) => html`<${Branch} key=${place.id} ...${{ place, depth: 1, step, range, open, active, toggle, focus: activate }} />`)}
    </ul>
  </div>`;
}
