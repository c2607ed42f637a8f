// Preact and htm, from one place; and the small parts that several views use.

export { html, render, useState, useEffect, useLayoutEffect, useRef, useMemo, useCallback } from "./vendor/htm/standalone.module.js";
import { html } from "./vendor/htm/standalone.module.js";
import { outcome } from "./words.js";

/** What became of a mission: a sign, a word and a colour. */
export function Outcome({ text }) {
  const { tone, sign } = outcome(text);
  return html`<span class="chip ${tone}"><span aria-hidden="true">${sign}</span>${text ?? "not judged"}</span>`;
}

export const Trouble = ({ words }) => html`<p class="trouble" role="alert">${words}</p>`;

/** Whether a key that was pressed belongs to what has the focus, and not to the page. */
export function isTaken(event) {
  const at = event.target;
  if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return true;
  if (document.querySelector("dialog[open]")) return true;
  if (!(at instanceof Element)) return false;
  return Boolean(at.closest("input, select, textarea, [role=tree], [role=grid], [role=tablist]"));
}

/** Whether space or enter would press something. */
export const presses = (event) =>
  (event.key === " " || event.key === "Enter") && event.target instanceof Element && Boolean(event.target.closest("button, a, summary"));
