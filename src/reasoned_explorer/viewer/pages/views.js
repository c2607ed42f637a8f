// What the robot saw in a step: a card for each view.

import { paths } from "./api.js";
import { html, useEffect, useState } from "./parts.js";
import { scoreColour } from "./palette.js";
import { bearing, fixed } from "./words.js";

const SETTLE_MS = 140; // pictures are asked for when a step has been looked at this long

/** A picture that is fetched only when its step is looked at, small first where the link is slow. */
function Picture({ src, alt }) {
  const [shown, setShown] = useState(null);
  const [fault, setFault] = useState(false);
  useEffect(() => {
    setFault(false);
    const timer = setTimeout(() => setShown(src), shown === null ? 0 : SETTLE_MS);
    return () => clearTimeout(timer);
  }, [src]);
  if (fault) return html`<div class="picture none"><span>no picture</span></div>`;
  return html`<div class="picture ${shown === src ? "" : "waits"}">
    ${shown === src ? html`<img src=${shown} alt=${alt} width="224" height="224" decoding="async" onError=${() => setFault(true)} onLoad=${(event) => event.target.parentNode?.classList.remove("waits")} />` : null}
  </div>`;
}

function Flags({ view, chosen }) {
  return html`
    ${chosen ? html`<span class="chip accent"><span aria-hidden="true">○</span>chosen</span>` : null}
    ${view.found ? html`<span class="chip good"><span aria-hidden="true">★</span>goal seen ${fixed(view.confidence)}</span>` : null}
    ${view.blocked ? html`<span class="chip bad"><span aria-hidden="true">▬</span>blocked</span>` : null}
    ${view.forbidden ? html`<span class="chip warn"><span aria-hidden="true">△</span>shunned ground</span>` : null}`;
}

/** Q as a figure with its colour. */
export function Score({ q, range }) {
  const fill = scoreColour(q, range);
  return html`<span class="score"><span class="dot ${fill ? "" : "empty"}" aria-hidden="true" ref=${(el) => el && (el.style.backgroundColor = fill ?? "")}></span>${fixed(q)}</span>`;
}

function View({ view, step, index, source, range, chosen, selected, onSelect, pictures }) {
  const where = bearing(view.heading_rad, step.pose[3]);
  const faults = [view.caption_fault && `caption: ${view.caption_fault}`, view.plan_fault && `plan: ${view.plan_fault}`, view.check_fault && `check: ${view.check_fault}`].filter(Boolean);
  const caption = view.caption || "(no caption)";
  const is = chosen ? " chosen" : "";
  return html`<li class="view card${is}${selected ? " selected" : ""}">
    <button class="view-head" aria-pressed=${selected ? "true" : "false"} onClick=${() => onSelect(selected ? null : view.frontier)} disabled=${view.frontier === null}
      title=${view.frontier === null ? "no frontier here" : `ring frontier ${view.frontier} on the map`}>
      <b>${where}</b><span class="spread"></span>
      <span class="unseen">Q</span><${Score} q=${view.q} range=${range} />
    </button>
    ${pictures === "none" || !source ? null : html`<${Picture} key=${index} src=${paths.view(source.run, source.mission, step.step, index, 320)} alt=${`View ${where}: ${caption}`} />`}
    <div class="view-text">
      <div class="flags"><${Flags} view=${view} chosen=${chosen} /></div>
      <p class="caption" title=${caption}>${caption}</p>
      ${view.evidence ? html`<p class="tiny evidence"><b>Evidence</b> ${view.evidence}</p>` : null}
      ${faults.map((words) => html`<p class="tiny fault">${words}</p>`)}
    </div>
  </li>`;
}

/** All views of a step, look by look. */
export function Views({ step, source, range, selected, onSelect, pictures }) {
  if (!step.views.length) return html`<p class="soft small">No look was taken in this step.</p>`;
  const looks = new Map();
  step.views.forEach((view, index) => {
    const look = view.key[1] ?? 0;
    if (!looks.has(look)) looks.set(look, []);
    looks.get(look).push([view, index]);
  });
  const chosen = step.choice?.frontier;
  return [...looks].map(
    ([look, views]) => html`${looks.size > 1 ? html`<h3 class="look">Look ${look + 1} of ${looks.size}</h3>` : null}
      <ul class="views">
        ${views.map(([view, index]) => html`<${View} key=${index} view=${view} step=${step} index=${index} source=${source} range=${range} pictures=${pictures}
          chosen=${chosen !== undefined && view.frontier === chosen} selected=${selected !== null && view.frontier === selected} onSelect=${onSelect} />`)}
      </ul>`,
  );
}
