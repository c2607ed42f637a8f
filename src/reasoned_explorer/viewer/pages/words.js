// Figures and findings in words for people.

const DASH = "–";

export const fixed = (value, digits = 2) => (value === null || value === undefined ? DASH : Number(value).toFixed(digits));
export const metres = (value) => (value === null || value === undefined ? DASH : `${Number(value).toFixed(value < 10 ? 1 : 0)} m`);
export const count = (value) => Number(value).toLocaleString("en");

/** Mission time as mm:ss. */
export function clock(seconds) {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return DASH;
  const whole = Math.max(0, Math.floor(seconds + 1e-6));
  return `${String(Math.floor(whole / 60)).padStart(2, "0")}:${String(whole % 60).padStart(2, "0")}`;
}

/** The class and sign of an outcome; the sign tells it without colour. */
export function outcome(text) {
  if (text === "success") return { tone: "good", sign: "✓" };
  if (text === "failure") return { tone: "bad", sign: "✕" };
  return { tone: "", sign: "?" };
}

/** Radians, clockwise from north, as degrees. */
export const degrees = (rad) => `${Math.round(((((rad * 180) / Math.PI) % 360) + 360) % 360)}°`;

/** Where a view looks, seen from the robot's heading. */
export function bearing(viewRad, poseRad) {
  const turn = Math.atan2(Math.sin(viewRad - poseRad), Math.cos(viewRad - poseRad));
  const deg = Math.round((turn * 180) / Math.PI);
  if (Math.abs(deg) <= 3) return "ahead";
  if (Math.abs(deg) >= 177) return "behind";
  return `${Math.abs(deg)}° ${deg < 0 ? "left" : "right"}`;
}

/** What was chosen in a step, and why. */
export function choice(step) {
  const chosen = step.choice;
  if (!chosen) return step.views.length ? "Nothing was chosen: the search ends here." : "Nothing was seen or chosen here.";
  const worth =
    chosen.q === null
      ? "no score could be had for it"
      : chosen.value === null
        ? `Q ${fixed(chosen.q)}`
        : `Q ${fixed(chosen.q)} − σ(d) ${fixed(chosen.penalty)} = ${fixed(chosen.value)}`;
  return `Frontier ${chosen.frontier} in ${metres(chosen.distance_m)}: ${worth}.`;
}

/** How the travel of a step went. */
export function travel(step) {
  if (!step.legs.length) return "";
  const gone = step.legs.reduce((sum, leg) => sum + leg.length_m, 0);
  const stopped = step.legs.find((leg) => leg.outcome !== "arrived");
  const end = stopped ? `${stopped.outcome}${stopped.detail ? ` (${stopped.detail})` : ""}` : "arrived";
  return `Went ${metres(gone)} in ${fixed(step.travel_s, 0)} s: ${end}.`;
}

/** What the checker said of a step's views. */
export function checked(step) {
  if (!step.views.length) return "";
  const seen = step.views.filter((view) => view.found);
  if (seen.length) {
    return seen.map((view) => `Goal seen in view ${step.views.indexOf(view) + 1} (${fixed(view.confidence)}): ${view.evidence}`).join(" · ");
  }
  const faults = step.views.filter((view) => view.check_fault);
  if (faults.length === step.views.length) return `No answer: ${faults[0].check_fault}`;
  return faults.length ? `Goal not seen; ${faults.length} of ${step.views.length} views have no answer.` : "Goal not seen in any view.";
}

/** How a mission ended, in one sentence. */
export function ending(summary, complete) {
  if (!summary) return complete ? "" : "Incomplete: the record ends before the mission does.";
  if (summary.declared && summary.success) return `Found Goal: ${summary.judge}.`;
  if (summary.declared && summary.success === null) return `Declared “Found Goal”; nobody judges: ${summary.judge}.`;
  if (summary.declared) return `Declared “Found Goal”, but the judge disagrees: ${summary.judge}.`;
  return `Not found (${summary.end}): ${summary.reason}.`;
}
