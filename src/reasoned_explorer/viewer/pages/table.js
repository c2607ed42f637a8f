// The missions of a run as a table: decoded, filtered, sorted and counted. No page in here.

/** Columns that can be chosen from, each with its heading. */
export const FACETS = [
  ["level", "Level"],
  ["method", "Method"],
  ["outcome", "Outcome"],
  ["cause", "Cause"],
  ["place", "Place"],
];

const TEXT = ["goal", "place", "method"];

export class Table {
  /** @param {{columns: string[], rows: any[][], words?: string[], coded?: string[]}} answer of /api/runs/{run} */
  constructor(answer) {
    this.columns = answer.columns;
    this.rows = answer.rows;
    this.words = answer.words ?? [];
    this.at = new Map(answer.columns.map((name, index) => [name, index]));
    this.coded = new Set(answer.coded ?? []);
    this._lower = this.words.map((word) => String(word ?? "").toLowerCase());
    this._byId = null;
  }

  /** The value of a cell, with coded ones looked up. */
  value(row, name) {
    const raw = row[this.at.get(name)];
    if (raw === null || raw === undefined) return null;
    return this.coded.has(name) ? this.words[raw] : raw;
  }

  /** The whole row as an object. */
  item(row) {
    return Object.fromEntries(this.columns.map((name) => [name, this.value(row, name)]));
  }

  /** The row of a mission's id, or undefined. */
  find(id) {
    this._byId ??= new Map(this.rows.map((row) => [this.value(row, "id"), row]));
    return this._byId.get(id);
  }

  /**
   * The rows that fit.
   * @param {{text: string, chosen: Object<string, string>}} filter chosen: by column, "" for all
   * @param {string} [except] a column whose choice is left out of account
   */
  filtered({ text, chosen }, except = "") {
    const tests = [];
    for (const [name] of FACETS) {
      const wanted = chosen[name];
      const at = this.at.get(name);
      if (!wanted || name === except || at === undefined) continue;
      if (this.coded.has(name)) {
        const code = this.words.indexOf(wanted);
        tests.push((row) => row[at] === code);
      } else {
        tests.push((row) => String(row[at] ?? "") === wanted);
      }
    }
    for (const part of text.toLowerCase().split(/\s+/).filter(Boolean)) tests.push(this._holds(part));
    return tests.length ? this.rows.filter((row) => tests.every((test) => test(row))) : this.rows;
  }

  _holds(part) {
    const fits = this._lower.map((word) => word.includes(part)); // each word once, not each row
    const places = TEXT.filter((name) => this.at.has(name)).map((name) => [this.at.get(name), this.coded.has(name)]);
    return (row) =>
      places.some(([at, coded]) => (coded ? fits[row[at]] : String(row[at] ?? "").toLowerCase().includes(part)));
  }

  /** How many rows each value of a column has, in the order of the values. */
  counts(rows, name) {
    const at = this.at.get(name);
    const counted = new Map();
    for (const row of rows) counted.set(row[at], (counted.get(row[at]) ?? 0) + 1);
    const decode = (raw) => (raw === null || raw === undefined ? "" : this.coded.has(name) ? this.words[raw] : raw);
    return [...counted]
      .map(([raw, count]) => [String(decode(raw)), count])
      .sort((a, b) => a[0].localeCompare(b[0], "en", { numeric: true }));
  }

  /** Rows in the order of a column; what is unknown comes last either way. */
  sorted(rows, name, descending) {
    const at = this.at.get(name);
    if (at === undefined) return rows;
    const sign = descending ? -1 : 1;
    const rank = this.coded.has(name) ? this._ranks() : null;
    return [...rows].sort((a, b) => {
      const x = rank ? rank[a[at]] : a[at];
      const y = rank ? rank[b[at]] : b[at];
      if (x === y) return 0;
      if (x === null || x === undefined) return 1;
      if (y === null || y === undefined) return -1;
      return (x < y ? -1 : 1) * sign;
    });
  }

  _ranks() {
    if (!this._rank) {
      const order = this.words.map((_, index) => index);
      const compare = new Intl.Collator("en", { numeric: true }).compare;
      order.sort((a, b) => compare(this._lower[a], this._lower[b]));
      this._rank = new Array(order.length);
      order.forEach((word, place) => (this._rank[word] = place));
    }
    return this._rank;
  }

  /** The other missions of the same episode: what a mission can be compared with. */
  peers(row) {
    const at = this.at.get("mission_id");
    const vehicle = this.at.get("vehicle");
    if (at === undefined || row[at] === null) return [];
    return this.rows.filter((other) => other !== row && other[at] === row[at] && other[vehicle] === row[vehicle]);
  }
}
