// One canvas over a Leaflet map on which something draws itself in metres or in pixels of the map.

import "./vendor/leaflet/leaflet.js";

const L = globalThis.L;

/** What a drawing is given: the canvas, and where metres lie on it. */
class Sheet {
  constructor(context, map, ratio) {
    this.context = context;
    this.size = map.getSize();
    this.ratio = ratio;
    this.scale = 2 ** map.getZoom(); // pixels per metre
    const origin = map.latLngToContainerPoint([0, 0]);
    this.x0 = origin.x;
    this.y0 = origin.y;
  }

  px(x) {
    return this.x0 + x * this.scale;
  }

  py(y) {
    return this.y0 - y * this.scale;
  }

  /** From now on a unit is a metre, y up. */
  inMetres() {
    const k = this.scale * this.ratio;
    this.context.setTransform(k, 0, 0, -k, this.x0 * this.ratio, this.y0 * this.ratio);
  }

  /** From now on a unit is a pixel of the page. */
  inPixels() {
    this.context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
  }

  shows(x, y, margin = 20) {
    const px = this.px(x);
    const py = this.py(y);
    return px > -margin && py > -margin && px < this.size.x + margin && py < this.size.y + margin;
  }
}

/** A layer of a map; `draw` is called with a Sheet whenever the map has moved or `redraw` was asked for. */
export const CanvasLayer = L.Layer.extend({
  initialize(draw, { order = 200 } = {}) {
    this._draw = draw;
    this._order = order;
    this._asked = 0;
  },

  onAdd(map) {
    this._canvas = document.createElement("canvas");
    this._canvas.className = "map-canvas";
    this._canvas.style.zIndex = String(this._order);
    this._canvas.setAttribute("aria-hidden", "true");
    map.getContainer().append(this._canvas); // beside the panes: they move while the map is dragged, this is redrawn
    map.on("move zoom viewreset resize", this._now, this);
    this._now();
    return this;
  },

  onRemove(map) {
    map.off("move zoom viewreset resize", this._now, this);
    cancelAnimationFrame(this._asked);
    this._canvas.remove();
    return this;
  },

  /** Draw with the next frame of the screen, once however often it is asked. */
  redraw() {
    if (this._asked || !this._map) return;
    this._asked = requestAnimationFrame(() => this._now());
  },

  _now() {
    cancelAnimationFrame(this._asked);
    this._asked = 0;
    const map = this._map;
    if (!map || !map._loaded) return;
    const size = map.getSize();
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const canvas = this._canvas;
    if (canvas.width !== Math.round(size.x * ratio) || canvas.height !== Math.round(size.y * ratio)) {
      canvas.width = Math.round(size.x * ratio);
      canvas.height = Math.round(size.y * ratio);
      canvas.style.width = `${size.x}px`;
      canvas.style.height = `${size.y}px`;
    }
    const context = canvas.getContext("2d");
    const sheet = new Sheet(context, map, ratio);
    sheet.inPixels();
    context.clearRect(0, 0, size.x, size.y);
    this._draw(sheet);
  },
});
