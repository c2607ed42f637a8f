// What stands where: ground, ways, buildings, trees and objects. Drawn when the map moves, not when time does.

import { colour } from "./palette.js";

const NAME_SCALE = 2; // pixels per metre from which buildings have names
const LABEL_SCALE = 5.5; // and things
const LONGEST = 34; // letters of a name
const DOT_SCALE = 0.8;

function ring(path, points) {
  points.forEach(([x, y], index) => (index ? path.lineTo(x, y) : path.moveTo(x, y)));
  path.closePath();
}

const groundName = (kind) => `--map-${String(kind).toLowerCase()}`;

/** Prepares a world's shapes once (in metres), then draws them at any zoom. */
export class WorldDrawing {
  constructor(world) {
    this.ground = (world.ground ?? []).map(({ kind, rings }) => ({ kind, path: this._rings(rings) }));
    this.ways = (world.ways ?? []).map(({ kind, ground, points, width_m }) => {
      const path = new Path2D();
      points.forEach(([x, y], index) => (index ? path.lineTo(x, y) : path.moveTo(x, y)));
      return { kind: ground ?? kind, path, width: Math.max(0.6, width_m ?? 2) };
    });
    this.buildings = new Path2D();
    this.names = [];
    for (const { rings, name } of world.buildings ?? []) {
      for (const one of rings) ring(this.buildings, one);
      if (name && rings[0]?.length) this.names.push({ name, ...centre(rings[0]) });
    }
    this.objects = world.objects ?? [];
    this.trees = (world.trees ?? []).map((tree) => ({ x: tree[0], y: tree[1], radius: tree[2] ?? 1.8 }));
  }

  _rings(rings) {
    const path = new Path2D();
    for (const one of rings) ring(path, one);
    return path;
  }

  draw(sheet) {
    const { context: c } = sheet;
    c.fillStyle = colour("--map-unknown");
    c.fillRect(0, 0, sheet.size.x, sheet.size.y);
    sheet.inMetres();
    for (const { kind, path } of this.ground) {
      c.fillStyle = colour(known(kind));
      c.fill(path, "evenodd");
    }
    c.lineJoin = "round";
    c.lineCap = "round";
    for (const { kind, path, width } of this.ways) {
      c.strokeStyle = colour(wayName(kind));
      c.lineWidth = width;
      c.stroke(path);
    }
    c.fillStyle = colour("--map-tree");
    c.globalAlpha = 0.7;
    for (const tree of this.trees) {
      if (!sheet.shows(tree.x, tree.y)) continue;
      c.beginPath();
      c.arc(tree.x, tree.y, tree.radius, 0, 2 * Math.PI);
      c.fill();
    }
    c.globalAlpha = 1;
    c.fillStyle = colour("--map-building");
    c.strokeStyle = colour("--map-building-edge");
    c.lineWidth = 1 / sheet.scale;
    c.fill(this.buildings, "evenodd");
    c.stroke(this.buildings);
    sheet.inPixels();
    this._objects(sheet);
    if (sheet.scale >= NAME_SCALE) this._labels(sheet);
  }

  _objects(sheet) {
    if (sheet.scale < DOT_SCALE) return;
    const { context: c } = sheet;
    const radius = sheet.scale >= 3 ? 2.25 : 1.5;
    c.fillStyle = colour("--map-object");
    c.globalAlpha = sheet.scale >= 3 ? 0.8 : 0.5;
    for (const thing of this.objects) {
      if (!sheet.shows(thing.x, thing.y)) continue;
      c.fillRect(sheet.px(thing.x) - radius, sheet.py(thing.y) - radius, 2 * radius, 2 * radius);
    }
    c.globalAlpha = 1;
  }

  /** Names where there is room for them: the first that comes keeps its place. */
  _labels(sheet) {
    const { context: c } = sheet;
    const taken = new Set();
    const write = (whole, x, y) => {
      const text = whole.length > LONGEST ? `${whole.slice(0, LONGEST - 1)}…` : whole;
      if (!sheet.shows(x, y, 0)) return;
      const px = sheet.px(x);
      const py = sheet.py(y);
      const width = c.measureText(text).width;
      const cells = [];
      for (let at = px; at <= px + width + 24; at += 24) cells.push(`${Math.round(at / 24)}:${Math.round(py / 13)}`);
      if (cells.some((cell) => taken.has(cell))) return;
      for (const cell of cells) taken.add(cell);
      c.strokeText(text, px + 5, py);
      c.fillText(text, px + 5, py);
    };
    c.font = "11px system-ui, sans-serif";
    c.textBaseline = "middle";
    c.lineWidth = 3;
    c.lineJoin = "round";
    c.strokeStyle = colour("--map-halo");
    c.fillStyle = colour("--map-label");
    for (const { name, x, y } of this.names) write(name, x, y);
    if (sheet.scale < LABEL_SCALE) return;
    for (const thing of this.objects) write(thing.name || String(thing.class).replaceAll("_", " "), thing.x, thing.y);
  }

  /** The object nearest to a place, within so many metres, or null. */
  nearest(x, y, within) {
    let best = null;
    let least = within;
    for (const thing of this.objects) {
      const far = Math.hypot(thing.x - x, thing.y - y);
      if (far <= least) [best, least] = [thing, far];
    }
    return best;
  }
}

function centre(points) {
  const sum = points.reduce(([x, y], [px, py]) => [x + px, y + py], [0, 0]);
  return { x: sum[0] / points.length, y: sum[1] / points.length };
}

const GROUNDS = new Set(
  ("unknown road pavement plaza cycleway path steps grass wood garden sand water parking pitch playground railway " +
    "construction yard building").split(" "),
);
const known = (kind) => (GROUNDS.has(String(kind).toLowerCase()) ? groundName(kind) : "--map-unknown");

const WAYS = { footway: "pavement", pedestrian: "plaza", path: "path", track: "path", bridleway: "path", steps: "steps", cycleway: "cycleway" };

/** A way's ground where it is told, else what OpenStreetMap's kind of way stands for. */
const wayName = (kind) => (GROUNDS.has(String(kind).toLowerCase()) ? groundName(kind) : groundName(WAYS[kind] ?? "road"));
