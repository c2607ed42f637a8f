// What the rating page asks of its server, and what it keeps in the browser until that has answered.

import { ApiError, get } from "./api.js";

let secret = null;

/** Send something that changes the run; the server's secret goes along, so that no other page can do it. */
async function send(method, path, body) {
  secret ??= (await ask("/api/csrf")).token;
  let answer;
  try {
    answer = await fetch(path, {
      method,
      headers: { "Content-Type": "application/json", "X-Rex-CSRF": secret },
      body: JSON.stringify(body),
    });
  } catch {
    throw silent();
  }
  if (answer.status === 403) secret = null; // a server that was started anew has another one
  const said = await answer.json().catch(() => null);
  if (answer.ok && said) return said;
  throw new ApiError(typeof said?.error === "string" ? said.error : `The server answered with ${answer.status}.`, answer.status);
}

const silent = () => new ApiError("The server does not answer. Is rex rate still running?", 0);

async function ask(path) {
  try {
    return await get(path);
  } catch (fault) {
    throw fault.status === 0 ? silent() : fault;
  }
}

const id = encodeURIComponent;
const asked = new Map();

/** Ask once while the page is open; a fault is asked for again. */
function once(path) {
  if (!asked.has(path)) {
    const answer = ask(path);
    asked.set(path, answer);
    answer.catch(() => asked.delete(path));
  }
  return asked.get(path);
}

export const about = () => ask("/api/rate/about");
export const enter = (name) => again(() => send("POST", "/api/rate/rater", { name }));
export const mission = (item, rater) => ask(`/api/rate/items/${id(item)}?rater=${id(rater)}`);
export const worldMap = (item) => once(`/api/rate/items/${id(item)}/map`).catch(() => null);
export const picture = (item, place) => `/api/rate/items/${id(item)}/pictures/${place}.png`;
export const save = (item, said) => again(() => send("PUT", `/api/rate/items/${id(item)}`, said));

/** Once more where the server did not know our secret: it was started anew. */
async function again(call) {
  try {
    return await call();
  } catch (fault) {
    if (fault.status !== 403) throw fault;
    return call();
  }
}

/** What is kept in this browser: who rates, and answers that are not sent yet. */
export const drafts = {
  key: (rater, item) => `rex-rate-draft ${item} ${rater}`,
  get(key) {
    try {
      return JSON.parse(localStorage.getItem(key));
    } catch {
      return null;
    }
  },
  set(key, value) {
    try {
      if (value === null) localStorage.removeItem(key);
      else localStorage.setItem(key, JSON.stringify(value));
    } catch {
      // no storage: it holds while the page is open
    }
  },
};
