// The map of a mission: Leaflet moves it, two canvases draw it.

import "./vendor/leaflet/leaflet.js";
import { CanvasLayer } from "./canvas_layer.js";
import { drawMoment, drawTask } from "./mission_layer.js";
import { onTheme } from "./palette.js";
import { fixed } from "./words.js";
import { WorldDrawing } from "./world_layer.js";

const L = globalThis.L;
const still = matchMedia("(prefers-reduced-motion: reduce)");

export class MissionMap {
  /** @param {HTMLElement} box where the map goes */
  constructor(box) {
    this.map = L.map(box, {
      crs: L.CRS.Simple,
      attributionControl: false,
      zoomControl: false,
      preferCanvas: true,
      zoomAnimation: false, // the canvases are drawn anew at each zoom
      fadeAnimation: false,
      inertia: !still.matches,
      zoomSnap: 0.25,
      zoomDelta: 0.75,
      wheelPxPerZoomLevel: 110,
      minZoom: -3,
      maxZoom: 6,
      keyboard: false, // arrows belong to the time line; the replay moves the map by other keys
    });
    L.control.zoom({ position: "topright" }).addTo(this.map);
    L.control.scale({ imperial: false, position: "bottomright" }).addTo(this.map);
    this.marks = { sigma: true, graph: true, frontiers: true, reference: true };
    this.selected = null;
    this.mission = null;
    this.moment = null;
    this.world = new WorldDrawing({});
    this.map.setView([0, 0], 0, { animate: false });
    this.ground = new CanvasLayer((sheet) => this._drawGround(sheet), { order: 200 }).addTo(this.map);
    this.live = new CanvasLayer((sheet) => this._drawLive(sheet), { order: 210 }).addTo(this.map);
    this._tip = L.tooltip({ direction: "top", offset: [0, -10], opacity: 1, className: "map-tip" });
    this.map.on("mousemove click", (event) => this._hover(event.latlng));
    this.map.on("mouseout", () => this.map.closeTooltip(this._tip));
    this._endTheme = onTheme(() => {
      this.ground.redraw();
      this.live.redraw();
    });
    this._resized = new ResizeObserver(() => this.map.invalidateSize({ animate: false, pan: false }));
    this._resized.observe(box);
  }

  remove() {
    this._resized.disconnect();
    this._endTheme();
    this.map.remove();
  }

  setMission(mission) {
    this.mission = mission;
    this.moment = mission.at(0);
    this.ground.redraw();
    this.live.redraw();
  }

  setWorld(world) {
    this.world = new WorldDrawing(world ?? {});
    this.ground.redraw();
  }

  /** Show a moment of the mission. Only the upper canvas is drawn. */
  show(moment) {
    this.moment = moment;
    this.live.redraw();
  }

  setMarks(marks) {
    this.marks = { ...this.marks, ...marks };
    this.ground.redraw();
    this.live.redraw();
  }

  /** Ring a frontier, or none. */
  select(frontier) {
    this.selected = frontier;
    this.live.redraw();
  }

  /** Show a rectangle, or everything that happened. */
  fit(bounds = this.mission?.bounds()) {
    if (!bounds || !Number.isFinite(bounds[0])) return;
    const [x0, y0, x1, y1] = bounds;
    this.map.fitBounds([[y0, x0], [y1, x1]], { animate: false, padding: [28, 28], maxZoom: 4 });
  }

  /** Move the map only where the robot has left its middle. */
  keepInView({ robot }) {
    const at = this.map.latLngToContainerPoint([robot.y, robot.x]);
    const { x, y } = this.map.getSize();
    if (at.x < x * 0.12 || at.x > x * 0.88 || at.y < y * 0.12 || at.y > y * 0.88) {
      this.map.panTo([robot.y, robot.x], { animate: false });
    }
  }

  pan(east, north) {
    this.map.panBy([east * 90, -north * 90], { animate: false });
  }

  zoom(levels) {
    this.map.setZoom(this.map.getZoom() + levels, { animate: false });
  }

  /** Keep two maps on the same place; returns what ends it. */
  follow(other) {
    let busy = false;
    const pair = (from, to) => () => {
      if (busy) return;
      busy = true;
      to.map.setView(from.map.getCenter(), from.map.getZoom(), { animate: false });
      busy = false;
    };
    const here = pair(this, other);
    const there = pair(other, this);
    this.map.on("move zoom", here);
    other.map.on("move zoom", there);
    return () => {
      this.map.off("move zoom", here);
      other.map.off("move zoom", there);
    };
  }

  _drawGround(sheet) {
    this.world.draw(sheet);
    if (this.mission) drawTask(sheet, this.mission, this);
  }

  _drawLive(sheet) {
    if (this.mission && this.moment) drawMoment(sheet, this.mission, this.moment, this);
  }

  /** Say what is under the pointer. Names are text, whatever they hold. */
  _hover({ lat: y, lng: x }) {
    if (!this.mission || !this.moment) return;
    const within = 10 / 2 ** this.map.getZoom();
    const found = this._under(x, y, within);
    if (!found) {
      this.map.closeTooltip(this._tip);
      return;
    }
    const text = document.createElement("span");
    text.textContent = found.words;
    this._tip.setLatLng([found.y, found.x]).setContent(text);
    this.map.openTooltip(this._tip);
  }

  _under(x, y, within) {
    const near = (px, py) => Math.hypot(px - x, py - y) <= within;
    for (const one of this.mission.frontiersAt(this.moment)) {
      if (!near(one.x_m, one.y_m)) continue;
      const row = this.mission.valuesAt(this.moment.known).find(([id]) => id === one.id);
      const worth = row && row[4] !== null ? `, − σ(${fixed(row[2], 0)} m) ${fixed(row[3])} = ${fixed(row[4])}` : "";
      const state = one.state === "open" ? "" : ` · ${one.state}${one.reason ? `: ${one.reason}` : ""}`;
      return { x: one.x_m, y: one.y_m, words: `frontier ${one.id}: Q ${fixed(one.q)}${worth}${one.forbidden ? " · shunned ground" : ""}${state}` };
    }
    for (const [, kind, gx, gy, grade] of this.mission.header.goal_objects ?? []) {
      if (near(gx, gy)) return { x: gx, y: gy, words: `goal: ${kind.replaceAll("_", " ")} (grade ${grade})` };
    }
    const thing = this.world.nearest(x, y, within);
    if (!thing) return null;
    const kind = String(thing.class).replaceAll("_", " ");
    return { x: thing.x, y: thing.y, words: thing.name ? `${kind}: ${thing.name}` : kind };
  }
}
