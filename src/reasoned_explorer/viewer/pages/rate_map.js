// Where the robot went and where it ended, on the ground that was there. Nothing that was searched for is marked.

import "./vendor/leaflet/leaflet.js";
import { CanvasLayer } from "./canvas_layer.js";
import { colour, onTheme } from "./palette.js";
import { WorldDrawing } from "./world_layer.js";

const L = globalThis.L;

export class WayMap {
  /** @param {HTMLElement} box where the map goes */
  constructor(box) {
    this.map = L.map(box, {
      crs: L.CRS.Simple,
      attributionControl: false,
      zoomAnimation: false,
      fadeAnimation: false,
      zoomControl: false,
      zoomSnap: 0.25,
      minZoom: -4,
      maxZoom: 5,
      keyboard: false,
    });
    L.control.zoom({ position: "topright" }).addTo(this.map);
    L.control.scale({ imperial: false, position: "bottomright" }).addTo(this.map);
    this.map.setView([0, 0], 0, { animate: false });
    this.world = new WorldDrawing({});
    this.shown = null;
    this.layer = new CanvasLayer((sheet) => this._draw(sheet)).addTo(this.map);
    this._endTheme = onTheme(() => this.layer.redraw());
    this._resized = new ResizeObserver(() => {
      this.map.invalidateSize({ animate: false, pan: false });
      this.fit();
    });
    this._resized.observe(box);
  }

  remove() {
    this._resized.disconnect();
    this._endTheme();
    this.map.remove();
  }

  /** Show a mission's way; `turn` is where the big picture looks, radians clockwise from north. */
  show(mission, world) {
    this.world = new WorldDrawing(world ?? {});
    this.shown = mission;
    this.fit();
    this.layer.redraw();
  }

  look(heading) {
    this.heading = heading;
    this.layer.redraw();
  }

  /** Show the whole way. */
  fit() {
    if (!this.shown) return;
    this.map.fitBounds(L.latLngBounds(this.shown.way.map(([x, y]) => [y, x])), { animate: false, padding: [36, 36], maxZoom: 2.5 });
  }

  /** Show the end with what is round it. */
  close() {
    if (this.shown) this.map.setView([this.shown.end.y, this.shown.end.x], 2.5, { animate: false });
  }

  _draw(sheet) {
    this.world.draw(sheet);
    if (!this.shown) return;
    const { context: c } = sheet;
    const { way, end } = this.shown;
    const path = new Path2D();
    way.forEach(([x, y], at) => (at ? path.lineTo(sheet.px(x), sheet.py(y)) : path.moveTo(sheet.px(x), sheet.py(y))));
    c.lineJoin = "round";
    c.lineCap = "round";
    c.strokeStyle = colour("--map-casing");
    c.lineWidth = 6;
    c.stroke(path);
    c.strokeStyle = colour("--map-track");
    c.lineWidth = 3;
    c.stroke(path);
    this._start(c, sheet.px(way[0][0]), sheet.py(way[0][1]));
    this._end(c, sheet.px(end.x), sheet.py(end.y), this.heading ?? end.heading_rad);
  }

  _start(c, x, y) {
    c.fillStyle = colour("--map-casing");
    c.strokeStyle = colour("--map-track");
    c.lineWidth = 3;
    c.beginPath();
    c.rect(x - 6, y - 6, 12, 12);
    c.fill();
    c.stroke();
  }

  /** A disc, and a fan that shows where the big picture looks. */
  _end(c, x, y, heading) {
    c.fillStyle = colour("--map-robot");
    c.globalAlpha = 0.3;
    c.beginPath();
    c.moveTo(x, y);
    const up = heading - Math.PI / 2; // clockwise from north, on a canvas whose y goes down
    c.arc(x, y, 44, up - Math.PI / 4, up + Math.PI / 4);
    c.closePath();
    c.fill();
    c.globalAlpha = 1;
    c.strokeStyle = colour("--map-casing");
    c.lineWidth = 2.5;
    c.beginPath();
    c.arc(x, y, 8, 0, 2 * Math.PI);
    c.fill();
    c.stroke();
  }
}
