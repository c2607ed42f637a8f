// A mission at one moment, over the map: the only thing that is drawn again while time goes on.

import { colour, onTheme, scoreColour } from "./palette.js";

export const SIGMA_LEVELS = [0.1, 0.5, 0.9];
const SPRITE = { width: 40, height: 22, x: 11, y: 11 };
const FIGURE_SCALE = 2.2; // pixels per metre from which frontiers have figures
const FIELD_M = 14; // how far the field of view is drawn
const TURN = 2 * Math.PI;

function stroke(c, width, style, dash = []) {
  c.lineWidth = width;
  c.strokeStyle = style;
  c.setLineDash(dash);
  c.stroke();
  c.setLineDash([]);
}

/** A five-pointed star: a goal object. */
function star(c, x, y, radius) {
  c.beginPath();
  for (let i = 0; i < 10; i += 1) {
    const far = i % 2 ? radius * 0.45 : radius;
    c.lineTo(x + far * Math.sin((i * Math.PI) / 5), y - far * Math.cos((i * Math.PI) / 5));
  }
  c.closePath();
}

/** Goal, start and reference way: they do not change with time. */
export function drawTask(sheet, mission, { marks }) {
  const { context: c } = sheet;
  const { header } = mission;
  const casing = colour("--map-casing");
  const way = header.reference_way ?? [];
  if (marks.reference && way.length > 1) {
    c.beginPath();
    for (const [x, y] of way) c.lineTo(sheet.px(x), sheet.py(y));
    stroke(c, 4, casing);
    stroke(c, 1.75, colour("--map-reference"), [2, 5]);
  }
  const goal = colour("--map-goal");
  const radius = header.success_radius_m * sheet.scale;
  const zones = (header.goal_objects ?? []).filter(([, , x, y]) => sheet.shows(x, y, radius + 10));
  c.beginPath(); // one shape: where zones overlap it is no darker
  for (const [, , x, y] of zones) {
    c.moveTo(sheet.px(x) + radius, sheet.py(y));
    c.arc(sheet.px(x), sheet.py(y), radius, 0, TURN);
  }
  c.fillStyle = goal;
  c.globalAlpha = 0.12;
  c.fill();
  c.globalAlpha = 1;
  for (const [, , x, y, grade] of zones) {
    const [px, py] = [sheet.px(x), sheet.py(y)];
    c.beginPath();
    c.arc(px, py, radius, 0, TURN);
    c.globalAlpha = grade >= 2 ? 0.8 : 0.45;
    stroke(c, 1, goal, [6, 4]);
    c.globalAlpha = 1;
    star(c, px, py, grade >= 2 ? 8 : 6);
    c.fillStyle = grade >= 2 ? goal : casing;
    c.fill();
    stroke(c, 1.25, grade >= 2 ? casing : goal);
  }
  const [x, y] = header.start;
  c.beginPath();
  c.rect(sheet.px(x) - 5, sheet.py(y) - 5, 10, 10);
  c.fillStyle = casing;
  c.fill();
  stroke(c, 2.5, colour("--map-track"));
}

/** Everything that changes with time. */
export function drawMoment(sheet, mission, moment, { marks, selected = null }) {
  const frontiers = mission.frontiersAt(moment);
  if (marks.sigma && mission.sigma.length && moment.index >= 0) drawSigma(sheet, mission, moment);
  if (marks.graph) drawGraph(sheet, mission, moment, frontiers);
  drawTrack(sheet, mission, moment);
  if (marks.graph) drawPoints(sheet, mission, moment);
  if (marks.frontiers) for (const one of frontiers) drawFrontier(sheet, one, mission.qRange);
  if (marks.sigma && moment.index >= 0) drawSigmaFigures(sheet, mission, moment);
  drawChosen(sheet, frontiers, moment, selected);
  drawRobot(sheet, mission, moment);
}

const SIDE = 78; // pixels between two figures on a ring
const SPOTS = [-90, 90, -60, -120, 60, 120, -30, 210, 30, 150, 0, 180].map((deg) => (deg * Math.PI) / 180);
/** Whether there is room for the figures of the rings: in the map, and not under its buttons. */
const isClear = ({ size }, x, y) => x > 40 && x < size.x - 60 && y > 52 && y < size.y - 30;

function drawSigma(sheet, mission, { robot }) {
  const { context: c } = sheet;
  const [px, py] = [sheet.px(robot.x), sheet.py(robot.y)];
  const style = colour("--map-sigma");
  const inner = mission.sigmaDistance(SIGMA_LEVELS[0]);
  const outer = mission.sigmaDistance(SIGMA_LEVELS[2]);
  if (inner !== null && outer !== null) {
    // What lies in the band costs more and more; beyond it the full penalty is due.
    c.beginPath();
    c.arc(px, py, outer * sheet.scale, 0, TURN);
    c.arc(px, py, inner * sheet.scale, 0, TURN, true);
    c.fillStyle = style;
    c.globalAlpha = 0.12;
    c.fill();
    c.globalAlpha = 1;
  }
  for (const level of SIGMA_LEVELS) {
    const distance = mission.sigmaDistance(level);
    if (distance === null) continue;
    c.beginPath();
    c.arc(px, py, distance * sheet.scale, 0, TURN);
    c.globalAlpha = 0.75;
    stroke(c, level === 0.5 ? 1.5 : 1, style, level === 0.5 ? [] : [2, 4]);
    c.globalAlpha = 1;
  }
}

/** The figures of the rings, side by side where there is room for them. */
function drawSigmaFigures(sheet, mission, { robot }) {
  const { context: c } = sheet;
  const rings = SIGMA_LEVELS.map((level) => [level, mission.sigmaDistance(level)]).filter(([, distance]) => distance !== null);
  const at = (distance, index, spot) => {
    const radius = distance * sheet.scale;
    const angle = spot + (index - 1) * (SIDE / Math.max(radius, SIDE));
    return [sheet.px(robot.x) + radius * Math.cos(angle), sheet.py(robot.y) + radius * Math.sin(angle)];
  };
  const spot = SPOTS.find((one) => rings.every(([, distance], index) => isClear(sheet, ...at(distance, index, one))));
  if (spot === undefined) return;
  c.font = "600 11px system-ui, sans-serif";
  c.textAlign = "center";
  c.textBaseline = "middle";
  c.lineWidth = 4;
  c.lineJoin = "round";
  c.strokeStyle = colour("--map-halo");
  c.fillStyle = colour("--map-sigma");
  rings.forEach(([level, distance], index) => {
    const [x, y] = at(distance, index, spot);
    const text = `σ ${level} · ${Math.round(distance)} m`;
    c.strokeText(text, x, y);
    c.fillText(text, x, y);
  });
  c.textAlign = "start";
}

function drawGraph(sheet, mission, moment, frontiers) {
  const { context: c } = sheet;
  const style = colour("--map-edge");
  c.beginPath();
  for (const frontier of frontiers) {
    if (frontier.state !== "open") continue;
    const parent = mission.points[mission._pointOf.get(frontier.parent)];
    if (!parent) continue;
    c.moveTo(sheet.px(parent.x), sheet.py(parent.y));
    c.lineTo(sheet.px(frontier.x_m), sheet.py(frontier.y_m));
  }
  c.globalAlpha = 0.45;
  stroke(c, 1, style, [3, 3]);
  c.beginPath();
  for (const { from, to, step } of mission.edges) {
    if (step > moment.index) break;
    c.moveTo(sheet.px(mission.points[from].x), sheet.py(mission.points[from].y));
    c.lineTo(sheet.px(mission.points[to].x), sheet.py(mission.points[to].y));
  }
  c.globalAlpha = 0.7;
  stroke(c, 1.25, style);
  c.globalAlpha = 1;
}

function drawTrack(sheet, mission, moment) {
  const { context: c } = sheet;
  c.lineJoin = "round";
  c.lineCap = "round";
  c.beginPath();
  for (let i = 0; i <= moment.trackEnd; i += 1) {
    const p = mission.track[i];
    c.lineTo(sheet.px(p.x), sheet.py(p.y));
  }
  c.lineTo(sheet.px(moment.robot.x), sheet.py(moment.robot.y));
  stroke(c, 5, colour("--map-casing"));
  stroke(c, 2.75, colour("--map-track"));
  c.lineCap = "butt";
}

function drawPoints(sheet, mission, moment) {
  const { context: c } = sheet;
  const radius = sheet.scale < 0.7 ? 1.5 : 2.75;
  c.beginPath();
  for (const point of mission.points) {
    if (point.step > moment.index) break;
    if (!sheet.shows(point.x, point.y)) continue;
    const [x, y] = [sheet.px(point.x), sheet.py(point.y)];
    c.moveTo(x + radius, y);
    c.arc(x, y, radius, 0, TURN);
  }
  c.fillStyle = colour("--map-casing");
  c.fill();
  stroke(c, 1.25, colour("--map-track"));
}

/** Shape tells the state, colour the score: open ● filled, visited ○, given up ✕, blocked ▬ across. */
export function frontierMark(c, x, y, { state, q, forbidden }, range, size) {
  const fill = scoreColour(q, range);
  const ink = colour("--map-edge");
  c.beginPath();
  if (state === "open") {
    if (forbidden) {
      c.moveTo(x, y - size * 1.2);
      c.lineTo(x + size * 1.1, y + size * 0.8);
      c.lineTo(x - size * 1.1, y + size * 0.8);
      c.closePath();
    } else c.arc(x, y, size, 0, TURN);
    c.fillStyle = fill ?? colour("--map-casing");
    c.fill();
    stroke(c, 3, colour("--map-casing"));
    stroke(c, 1.25, colour("--map-reference"), fill ? [] : [2, 2]);
  } else if (state === "visited") {
    c.arc(x, y, size * 0.55, 0, TURN);
    stroke(c, 1.5, fill ?? ink);
  } else if (state === "blocked") {
    c.rect(x - size * 0.75, y - size * 0.25, size * 1.5, size * 0.5);
    c.fillStyle = ink;
    c.fill();
  } else {
    c.moveTo(x - size * 0.6, y - size * 0.6);
    c.lineTo(x + size * 0.6, y + size * 0.6);
    c.moveTo(x + size * 0.6, y - size * 0.6);
    c.lineTo(x - size * 0.6, y + size * 0.6);
    stroke(c, 1.75, ink);
  }
}

const sprites = new Map();
onTheme(() => sprites.clear());

/** A frontier's mark with its figure, drawn once and then copied: there may be thousands in a picture. */
function sprite(frontier, range, size, figure, ratio) {
  const q = frontier.q === null ? null : Math.round(frontier.q * 10) / 10;
  const key = `${frontier.state} ${q} ${frontier.forbidden} ${size} ${figure} ${ratio} ${range}`;
  let made = sprites.get(key);
  if (made) return made;
  made = document.createElement("canvas");
  made.width = SPRITE.width * ratio;
  made.height = SPRITE.height * ratio;
  const c = made.getContext("2d");
  c.scale(ratio, ratio);
  frontierMark(c, SPRITE.x, SPRITE.y, { ...frontier, q }, range, size);
  if (figure && frontier.state === "open" && q !== null) {
    c.font = "600 10px system-ui, sans-serif";
    c.textBaseline = "middle";
    c.lineWidth = 3;
    c.strokeStyle = colour("--map-halo");
    c.fillStyle = colour("--map-label");
    c.strokeText(q.toFixed(1), SPRITE.x + size + 3, SPRITE.y);
    c.fillText(q.toFixed(1), SPRITE.x + size + 3, SPRITE.y);
  }
  sprites.set(key, made);
  return made;
}

function drawFrontier(sheet, frontier, range) {
  if (!sheet.shows(frontier.x_m, frontier.y_m)) return;
  const size = sheet.scale < 0.7 ? 4 : 6;
  const mark = sprite(frontier, range, size, sheet.scale >= FIGURE_SCALE, sheet.ratio);
  sheet.context.drawImage(mark, Math.round(sheet.px(frontier.x_m)) - SPRITE.x, Math.round(sheet.py(frontier.y_m)) - SPRITE.y, SPRITE.width, SPRITE.height);
}

function drawChosen(sheet, frontiers, moment, selected) {
  const { context: c } = sheet;
  const ring = (frontier, radius, style, width, dash) => {
    if (!frontier) return;
    c.beginPath();
    c.arc(sheet.px(frontier.x_m), sheet.py(frontier.y_m), radius, 0, TURN);
    stroke(c, width + 2, colour("--map-casing"));
    stroke(c, width, style, dash);
  };
  const chosen = frontiers.find((one) => one.id === moment.chosen);
  if (chosen && moment.t < moment.step.ended_s - 1e-6) {
    c.beginPath();
    c.moveTo(sheet.px(moment.robot.x), sheet.py(moment.robot.y));
    c.lineTo(sheet.px(chosen.x_m), sheet.py(chosen.y_m));
    stroke(c, 1.5, colour("--map-robot"), [6, 4]);
  }
  ring(chosen, 10, colour("--map-robot"), 2.5, []);
  if (selected !== null) ring(frontiers.find((one) => one.id === selected), 13, colour("--map-reference"), 1.5, [3, 3]);
}

function drawRobot(sheet, mission, { robot, step, phase }) {
  const { context: c } = sheet;
  const [px, py] = [sheet.px(robot.x), sheet.py(robot.y)];
  const style = colour("--map-robot");
  const sweep = mission.header.settings?.explorer?.sweep_rad ?? (2 * Math.PI) / 3;
  // Headings run clockwise from north; a canvas counts from east, y down.
  const toward = (heading) => heading - Math.PI / 2;
  const views = step?.views ?? [];
  const single = views.length > 1 ? Math.min(Math.PI / 2, sweep / Math.max(1, views.length - 1)) : Math.PI / 3;
  const field = (heading, width, alpha) => {
    c.beginPath();
    c.moveTo(px, py);
    c.arc(px, py, Math.max(26, FIELD_M * sheet.scale), toward(heading - width / 2), toward(heading + width / 2));
    c.closePath();
    c.globalAlpha = alpha;
    c.fillStyle = style;
    c.fill();
    c.globalAlpha = Math.min(1, alpha * 3);
    stroke(c, 1, style);
    c.globalAlpha = 1;
  };
  if (phase === "travel" || phase === "over" || !views.length) field(robot.h, single, 0.16);
  else for (const view of views) field(view.heading_rad, single * 0.94, 0.13);
  c.save();
  c.translate(px, py);
  c.rotate(robot.h);
  c.beginPath();
  c.moveTo(0, -11);
  c.lineTo(7.5, 8);
  c.lineTo(0, 4.5);
  c.lineTo(-7.5, 8);
  c.closePath();
  c.fillStyle = style;
  c.fill();
  stroke(c, 1.75, colour("--map-casing"));
  c.restore();
}
