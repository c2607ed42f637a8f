// A map in a page: the box, its keys and its switches. Replay, comparison and the live page all have it.

import { Legend } from "./legend.js";
import { MissionMap } from "./map.js";
import { html, useEffect, useRef, useState } from "./parts.js";

const MARKS = [["sigma", "σ(d)"], ["frontiers", "Frontiers"], ["graph", "Graph"], ["reference", "Shortest way"]];

/** Keys of a map that has the focus, or of the page around it. */
export function mapKey(map, event, { arrows = false } = {}) {
  const pans = { ArrowUp: [0, 1], ArrowDown: [0, -1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] };
  if (arrows && pans[event.key]) map.pan(...pans[event.key]);
  else if (event.key === "+" || event.key === "=") map.zoom(0.75);
  else if (event.key === "-" || event.key === "−") map.zoom(-0.75);
  else if (event.key === "0") map.fit();
  else return false;
  event.preventDefault();
  event.stopPropagation();
  return true;
}

/** @param {{label: string, onMap: (map: MissionMap) => void, note?: string, tools?: boolean}} props */
export function Stage({ label, onMap, note = "", tools = true, attribution = "" }) {
  const box = useRef(null);
  const map = useRef(null);
  const [marks, setMarks] = useState({ sigma: true, frontiers: true, graph: true, reference: true });
  const [legend, setLegend] = useState(false);
  useEffect(() => {
    map.current = new MissionMap(box.current);
    onMap(map.current);
    return () => map.current.remove();
  }, []);
  const flip = (name) => {
    const next = { ...marks, [name]: !marks[name] };
    setMarks(next);
    map.current.setMarks(next);
  };
  return html`<div class="stage">
    <div class="map" ref=${box} tabindex="0" role="application" aria-label=${`${label}. Arrows move the map, plus and minus zoom, 0 shows everything.`}
      onKeyDown=${(event) => mapKey(map.current, event, { arrows: true })}></div>
    ${tools
      ? html`<div class="map-tools" role="group" aria-label="What the map shows">
          ${MARKS.map(([name, words]) => html`<button class="small" aria-pressed=${String(marks[name])} onClick=${() => flip(name)}>${words}</button>`)}
          <button class="small" onClick=${() => map.current.fit()} title="0">Fit</button>
          <button class="small" aria-expanded=${String(legend)} aria-pressed=${String(legend)} onClick=${() => setLegend(!legend)}>Legend</button>
        </div>`
      : null}
    ${legend ? html`<div class="map-legend card"><${Legend} range=${[1, 5]} /></div>` : null}
    ${note ? html`<p class="map-note tiny">${note}</p>` : null}
    ${attribution ? html`<p class="map-credit tiny">${attribution}</p>` : null}
  </div>`;
}
