// What a rater sees of a mission: where it ended, all round, and the way there on a map.

import { html, useEffect, useRef, useState } from "./parts.js";
import { picture, worldMap } from "./rate_api.js";
import { WayMap } from "./rate_map.js";

/** All round the end: one picture large, all of them small; arrow keys turn. */
export function Round({ mission, looked, onLook, onLoaded }) {
  const { item, pictures } = mission;
  const [broken, setBroken] = useState(new Set());
  const done = useRef(new Set());
  useEffect(() => {
    setBroken(new Set());
    done.current = new Set();
  }, [item]);
  const settle = (place) => {
    done.current.add(place);
    if (done.current.size === pictures.length) onLoaded();
  };
  const fail = (place) => {
    setBroken((before) => new Set([...before, place]));
    settle(place);
  };
  if (!pictures.length) return html`<${Words} captions=${mission.captions} />`;
  const none = html`<span class="no-picture">no picture</span>`;
  return html`<section class="round" aria-label="What is to be seen where it ended">
    <figure class="large">
      ${broken.has(looked) ? none : html`<img key=${`${item} ${looked}`} src=${picture(item, looked)} alt=${`Where it ended, ${pictures[looked]}`} width="448" height="448" />`}
      <figcaption>Seen from where it ended, <b>${pictures[looked]}</b></figcaption>
      <button class="turn left" aria-label="Turn to the left" title="Turn to the left (←)" onClick=${() => onLook((looked + pictures.length - 1) % pictures.length)}>‹</button>
      <button class="turn right" aria-label="Turn to the right" title="Turn to the right (→)" onClick=${() => onLook((looked + 1) % pictures.length)}>›</button>
    </figure>
    <ul class="strip">
      ${pictures.map(
        (label, place) => html`<li key=${`${item} ${place}`}>
          <button aria-pressed=${place === looked ? "true" : "false"} onClick=${() => onLook(place)}>
            ${broken.has(place) ? none : html`<img src=${picture(item, place)} alt="" width="112" height="112" onLoad=${() => settle(place)} onError=${() => fail(place)} />`}
            <span>${label}</span>
          </button>
        </li>`,
      )}
    </ul>
  </section>`;
}

/** Where no picture can be had. */
function Words({ captions }) {
  return html`<section class="round words">
    <h2>There is no picture of this place</h2>
    ${captions.length
      ? html`<p class="soft">What the robot’s captioner said of its last look. It may be wrong.</p>
          <ul>${captions.map((text) => html`<li>${text}</li>`)}</ul>`
      : html`<p class="soft">Nothing was said of it either. Judge by the map, or leave this mission out.</p>`}
  </section>`;
}

/** The way that was gone. */
export function Way({ mission, looked }) {
  const box = useRef(null);
  const map = useRef(null);
  const [without, setWithout] = useState(false);
  useEffect(() => {
    map.current = new WayMap(box.current);
    return () => map.current.remove();
  }, []);
  useEffect(() => {
    let here = true;
    map.current.show(mission, null);
    setWithout(false);
    worldMap(mission.item).then((world) => {
      if (!here) return;
      setWithout(world === null);
      if (world) map.current.show(mission, world);
    });
    return () => (here = false);
  }, [mission.item]);
  useEffect(() => {
    const { pictures, end } = mission;
    const turn = pictures.length ? looked - Math.floor((pictures.length - 1) / 2) : 0;
    map.current.look(end.heading_rad + (pictures.length ? (turn * 2 * Math.PI) / pictures.length : 0));
  }, [mission.item, looked]);
  return html`<section class="way" aria-label="Where it went">
    <div class="map" ref=${box} role="img" aria-label="Map of the way from the start to the end"></div>
    <div class="map-tools">
      <button onClick=${() => map.current.fit()}>Whole way</button>
      <button onClick=${() => map.current.close()}>The end</button>
    </div>
    ${without ? html`<p class="map-note tiny">The ground is not known any more.</p>` : null}
    <ul class="key tiny">
      <li><span class="key-start"></span>start</li>
      <li><span class="key-way"></span>the way it went</li>
      <li><span class="key-end"></span>where it ended</li>
    </ul>
    ${mission.attribution ? html`<p class="map-credit tiny">${mission.attribution}</p>` : null}
  </section>`;
}
