// The clock of a replay: mission seconds that can be set, and that run when asked to.

export const SPEEDS = [1, 5, 20, 60, 120];

export class Player {
  /** @param {(t: number, settled: boolean) => void} onTime called at most once a frame; settled: nothing is running */
  constructor(onTime) {
    this.t = 0;
    this.end = 0;
    this.speed = 20;
    this.playing = false;
    this._onTime = onTime;
    this._frame = 0;
    this._before = 0;
    this._state = new Set();
  }

  onState(listener) {
    this._state.add(listener);
    return () => this._state.delete(listener);
  }

  /** Go to a moment; it is shown with the next frame. */
  seek(t) {
    this.t = Math.min(this.end, Math.max(0, t));
    if (!this._frame && !this.playing) this._frame = requestAnimationFrame(() => this._show());
  }

  toggle(play = !this.playing) {
    if (play === this.playing) return;
    if (play && this.t >= this.end - 1e-6) this.t = 0;
    this.playing = play;
    cancelAnimationFrame(this._frame);
    this._before = performance.now();
    this._frame = requestAnimationFrame((now) => (play ? this._run(now) : this._show()));
    this._tell();
  }

  setSpeed(speed) {
    this.speed = speed;
    this._tell();
  }

  stop() {
    this.playing = false;
    cancelAnimationFrame(this._frame);
    this._frame = 0;
  }

  _tell() {
    for (const listener of this._state) listener(this);
  }

  _show() {
    this._frame = 0;
    this._onTime(this.t, true);
  }

  _run(now) {
    this.t = Math.min(this.end, this.t + (Math.max(0, now - this._before) / 1000) * this.speed);
    this._before = now;
    this._onTime(this.t, false);
    if (this.t >= this.end) {
      this.playing = false;
      this._frame = 0;
      this._tell();
      this._onTime(this.t, true);
    } else this._frame = requestAnimationFrame((next) => this._run(next));
  }
}

/** Keep what is costly to a few times a second; the last call is always done. */
export function calmly(work, every = 200) {
  let timer = 0;
  let last = 0;
  const run = (now) => {
    last = now;
    timer = 0;
    work();
  };
  const ask = () => {
    if (timer) return;
    const now = performance.now();
    if (now - last >= every) run(now);
    else timer = setTimeout(() => run(performance.now()), every - (now - last));
  };
  ask.stop = () => clearTimeout(timer);
  return ask;
}
