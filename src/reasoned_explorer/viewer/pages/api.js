// What the server is asked. Every fault becomes one plain sentence for people.

/** A fault with a sentence that can be shown as it stands. */
export class ApiError extends Error {
  /** @param {string} sentence @param {number} status 0 where no answer came at all */
  constructor(sentence, status) {
    super(sentence);
    this.status = status;
  }
}

const kept = new Map();

/**
 * Get JSON.
 * @param {string} path beginning with /api/
 * @param {{signal?: AbortSignal}} options
 */
export async function get(path, { signal } = {}) {
  let answer;
  try {
    answer = await fetch(path, { signal, headers: { Accept: "application/json" } });
  } catch (fault) {
    if (fault.name === "AbortError") throw fault;
    throw new ApiError("The server does not answer. Is rex view still running?", 0);
  }
  let body = null;
  try {
    body = await answer.json();
  } catch (fault) {
    if (fault.name === "AbortError") throw fault;
    if (answer.ok) throw new ApiError("The server's answer cannot be read: it is no JSON, or it was cut off.", answer.status);
  }
  if (answer.ok) return body;
  const said = typeof body?.error === "string" ? body.error : `The server answered with ${answer.status}.`;
  throw new ApiError(said, answer.status);
}

/** Get JSON once and keep it while the page is open: for what does not change. */
function once(path) {
  if (!kept.has(path)) {
    const asked = get(path);
    kept.set(path, asked);
    asked.catch(() => kept.delete(path));
  }
  return kept.get(path);
}

/** Forget a kept answer, so that the next question goes to the server. */
export const forget = (path) => kept.delete(path);

const id = encodeURIComponent;
export const paths = {
  about: "/api/about",
  runs: "/api/runs",
  live: "/api/live",
  run: (run) => `/api/runs/${id(run)}`,
  mission: (run, mission) => `/api/runs/${id(run)}/missions/${id(mission)}`,
  map: (run, mission) => `/api/runs/${id(run)}/missions/${id(mission)}/map`,
  view: (run, mission, step, index, width) =>
    `/api/runs/${id(run)}/missions/${id(mission)}/views/${step}/${index}.png?width=${width}`,
};

export const about = () => get(paths.about);
export const runs = () => get(paths.runs);
export const run = (name) => once(paths.run(name));
export const mission = (name, one) => get(paths.mission(name, one));

/** The map of a mission's world, or null with the reason where there is none. */
export async function worldMap(name, one, header) {
  if (!header.world_digest) return { world: null, why: "no world is known, as outdoors." };
  try {
    return { world: await once(paths.map(name, one)), why: "" };
  } catch (fault) {
    return { world: null, why: fault.message };
  }
}
