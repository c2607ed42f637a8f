// The stream of a mission that is being written, and how old what it said is.

import { paths } from "./api.js";

export const STALE_MS = 6000; // nothing came for this long, not even a sign of life

/** Follows /api/live. It comes back by itself when the connection is lost, and tells no line twice. */
export class Feed {
  /** @param {{onHeader: Function, onStep: Function, onSummary: Function, onState: Function}} listeners */
  constructor(listeners) {
    this._on = listeners;
    this._last = -1; // number of the last line
    this._wait = 1000;
    this.heard = performance.now();
    this.ageS = null;
    this.open = false;
    this._connect();
    this._clock = setInterval(() => this._on.onState(this.state()), 500);
  }

  /** {stale: bool, silentS: seconds without a word, connected: bool, ageS: age of the newest line} */
  state() {
    const silent = performance.now() - this.heard;
    return { stale: silent > STALE_MS, silentS: silent / 1000, connected: this.open, ageS: this.ageS === null ? null : this.ageS + silent / 1000 };
  }

  close() {
    clearInterval(this._clock);
    clearTimeout(this._again);
    this._source?.close();
  }

  _connect() {
    const source = (this._source = new EventSource(paths.live));
    source.onopen = () => {
      this.open = true;
      this._wait = 1000;
    };
    source.onerror = () => {
      this.open = false;
      if (source.readyState !== EventSource.CLOSED) return; // the browser tries again by itself
      source.close();
      this._again = setTimeout(() => this._connect(), this._wait);
      this._wait = Math.min(15000, this._wait * 1.7);
    };
    source.addEventListener("header", (event) => this._line(event, ({ header }) => this._on.onHeader(header)));
    source.addEventListener("step", (event) => this._line(event, ({ step }) => this._on.onStep(step)));
    source.addEventListener("summary", (event) => this._line(event, ({ summary }) => this._on.onSummary(summary)));
    source.addEventListener("alive", (event) => {
      this.heard = performance.now();
      const told = parsed(event.data);
      this.ageS = typeof told?.age_s === "number" ? told.age_s : this.ageS;
    });
  }

  _line(event, tell) {
    this.heard = performance.now();
    this.ageS = 0;
    const number = Number.parseInt(event.lastEventId, 10);
    const line = parsed(event.data);
    if (line === null) return; // half a line: the next connection brings it whole
    if (event.type === "header") this._last = -1; // another mission begins
    else if (Number.isFinite(number) && number <= this._last) return;
    if (Number.isFinite(number)) this._last = number;
    tell(event.type in line ? line : { [event.type]: line });
  }
}

function parsed(text) {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
}
