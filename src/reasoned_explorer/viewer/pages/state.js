// A mission as something that can be asked "what was at this moment?". No page in here.

const below = (sorted, value, key) => {
  let low = 0;
  let high = sorted.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (key(sorted[middle]) <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1; // the last that is not above, or -1
};

/** From one heading to another the short way. */
function between(from, to, share) {
  const turn = Math.atan2(Math.sin(to - from), Math.cos(to - from));
  return from + turn * share;
}

export class Mission {
  /** @param {{header: object, steps?: object[], summary?: object|null, derived?: object|null, complete?: boolean}} record */
  constructor({ header, steps = [], summary = null, derived = null, complete = false }) {
    this.header = header;
    this.steps = [];
    this.summary = summary;
    this.complete = complete;
    this.sigma = derived?.sigma ?? [];
    this.pictures = derived?.pictures ?? "none";
    this.values = derived?.steps ?? [];
    const [x, y, , heading] = header.start;
    this.track = [{ t: 0, x, y, h: heading }];
    this.points = []; // {id, x, y, step}
    this.edges = []; // {from, to, step}: places in points
    this.frontiers = new Map(); // id -> [{step, ...record}]
    this._pointOf = new Map();
    this.qRange = [1, 5];
    for (const step of steps) this.append(step);
  }

  /** Add the next step, as the live page does; a step that is there already changes nothing. */
  append(step) {
    if (step.step < this.steps.length) return false;
    const index = this.steps.length;
    this.steps.push(step);
    const [x, y] = step.pose;
    let at = this._pointOf.get(step.point);
    if (at === undefined) {
      at = this.points.length;
      this._pointOf.set(step.point, at);
      this.points.push({ id: step.point, x, y, step: index });
    }
    const before = index ? this._pointOf.get(this.steps[index - 1].point) : at;
    if (before !== at) this.edges.push({ from: before, to: at, step: index });
    for (const leg of step.legs) {
      for (const p of leg.track) this.track.push({ t: p.t_s, x: p.x_m, y: p.y_m, h: p.heading_rad });
    }
    for (const frontier of step.frontiers) {
      const known = this.frontiers.get(frontier.id) ?? [];
      known.push({ ...frontier, step: index });
      this.frontiers.set(frontier.id, known);
    }
    return true;
  }

  /** Seconds that the mission took so far. */
  get end() {
    return this.steps.length ? this.steps[this.steps.length - 1].ended_s : 0;
  }

  /** When the travel of a step began: all is seen, imagined and chosen then. */
  decided(index) {
    const step = this.steps[index];
    const first = step.legs[0]?.track[0]?.t_s;
    return first ?? Math.max(step.started_s, step.ended_s - step.travel_s);
  }

  /** The step at a moment, -1 before there is any. */
  stepAt(t) {
    return this.steps.length ? Math.max(0, below(this.steps, t, (step) => step.started_s)) : -1;
  }

  /** Where a chosen step is shown: the moment of its decision (of the last one: its end). */
  moment(index) {
    return index === this.steps.length - 1 && !this.steps[index].choice ? this.steps[index].ended_s : this.decided(index);
  }

  /** What was at a moment of mission time. */
  at(t) {
    const index = this.stepAt(t);
    const step = index < 0 ? null : this.steps[index];
    const decided = index >= 0 && t >= this.decided(index) - 1e-6;
    const known = decided ? index : index - 1;
    const last = Math.max(0, below(this.track, t, (p) => p.t));
    const here = this.track[last];
    const next = this.track[last + 1];
    let robot = { x: here.x, y: here.y, h: here.h };
    if (next && next.t > here.t && t > here.t) {
      const share = Math.min(1, (t - here.t) / (next.t - here.t));
      robot = { x: here.x + (next.x - here.x) * share, y: here.y + (next.y - here.y) * share, h: between(here.h, next.h, share) };
    }
    let phase = step?.legs.length ? "travel" : "think";
    if (this.summary && t >= this.end - 1e-6) phase = "over";
    if (step && !decided) phase = t < step.started_s + step.look_s ? "look" : "think";
    return { t, index, step, decided, known, trackEnd: last, robot, phase, chosen: decided ? (step.choice?.frontier ?? null) : null };
  }

  /** The frontiers that are known after a step, each as it then was; what is under way still counts as open. */
  frontiersAt(moment) {
    const shown = [];
    for (const changes of this.frontiers.values()) {
      const at = below(changes, moment.known, (change) => change.step);
      if (at < 0) continue;
      const frontier = changes[at];
      const underWay = frontier.id === moment.chosen && frontier.step === moment.index && moment.t < moment.step.ended_s - 1e-6;
      shown.push(underWay ? { ...frontier, state: "open" } : frontier);
    }
    return shown;
  }

  /** [frontier, q, distance, σ, value] of the open frontiers at a step's end; empty where it is not known. */
  valuesAt(index) {
    return this.values[index]?.values ?? [];
  }

  /** The distance at which σ reaches a value, metres, or null where it never does. */
  sigmaDistance(level) {
    for (let i = 1; i < this.sigma.length; i += 1) {
      const [d0, s0] = this.sigma[i - 1];
      const [d1, s1] = this.sigma[i];
      if ((s0 - level) * (s1 - level) <= 0 && s0 !== s1) return d0 + ((level - s0) / (s1 - s0)) * (d1 - d0);
    }
    return null;
  }

  /** The rectangle of everything that happened: [min x, min y, max x, max y]. */
  bounds() {
    let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
    const take = (x, y) => {
      x0 = Math.min(x0, x);
      y0 = Math.min(y0, y);
      x1 = Math.max(x1, x);
      y1 = Math.max(y1, y);
    };
    for (const p of this.track) take(p.x, p.y);
    for (const changes of this.frontiers.values()) take(changes[0].x_m, changes[0].y_m);
    for (const [x, y] of this.header.reference_way ?? []) take(x, y);
    return [x0, y0, x1, y1];
  }

  /** Metres travelled up to the end of a step. */
  pathLength(index) {
    let sum = 0;
    for (let i = 0; i <= index; i += 1) for (const leg of this.steps[i].legs) sum += leg.length_m;
    return sum;
  }

  /** What stopped the robot: [step, seconds, words] of collisions, guards and faults. */
  troubles() {
    const found = [];
    this.steps.forEach((step, index) => {
      for (const leg of step.legs) {
        if (leg.outcome === "arrived") continue;
        found.push({ step: index, t: leg.track.at(-1)?.t_s ?? step.ended_s, kind: leg.outcome, words: leg.detail || leg.outcome });
      }
      for (const event of step.interventions ?? []) {
        found.push({ step: index, t: event.t_s, kind: "guard", words: `${event.detail} (${event.cause}); ${event.done}` });
      }
    });
    return found;
  }
}
