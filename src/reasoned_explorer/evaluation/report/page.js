"use strict";
// The table of missions: filtered by the address behind "#", drawn a piece at a time.
(() => {
  const PIECE = 200;
  const data = JSON.parse(document.getElementById("missions-data").textContent);
  const [METHOD, ID, LEVEL, PLACE, CITY, GOAL, CAUSE, SUCCESS, ORACLE, SEEN, RADII, WITHIN, SPL, CASR, CT, TT, PATH, SHORTEST,
    STEPS, CALLS, SMALL, LARGE, JUDGE, REASON] = Array.from({ length: 24 }, (_, place) => place);
  const form = document.getElementById("filters");
  const body = document.querySelector("#list tbody");
  const status = document.getElementById("status");
  const more = document.getElementById("more");
  const outcomes = new Map([
    ["success", ["success", (row) => row[SUCCESS] === 1]],
    ["oracle", ["oracle success", (row) => row[ORACLE] === 1]],
    ["seen", ["oracle success, seen", (row) => row[SEEN] === 1]],
    ["small", ["ran into something small", (row) => row[SMALL] > 0]],
    ["large", ["ran into something large", (row) => row[LARGE] > 0]],
    ...data.causes.map(([key, name], place) => [key, [name, (row) => row[CAUSE] === place]]),
  ]);

  function fill(name, options) {
    for (const [value, text] of options) form.elements[name].append(new Option(text, value));
  }
  fill("method", data.methods.map((name) => [name, name]));
  fill("level", [...new Set(data.rows.map((row) => row[LEVEL]))].sort().map((level) => [level, level]));
  fill("city", data.cities.map((name) => [name, name || "no city"]));
  fill("place", data.places.map((name) => [name, name]));
  fill("outcome", [...outcomes].filter(([, [, test]]) => data.rows.some(test)).map(([key, [name]]) => [key, name]));

  function wanted() {
    const hash = location.hash.slice(1);
    return new URLSearchParams(hash.includes("=") ? hash : "");
  }

  // Ids of the missions of two methods: all that both have, or those in which they differ.
  function shared(first, second, by) {
    const place = by === "success" ? SUCCESS : by === "oracle" ? ORACLE : null;
    const known = new Map(data.rows.filter((row) => row[METHOD] === second).map((row) => [row[ID], row]));
    const both = data.rows.filter((row) => row[METHOD] === first && known.has(row[ID]));
    return new Set(both.filter((row) => place === null || row[place] !== known.get(row[ID])[place]).map((row) => row[ID]));
  }

  // What is asked for, as [where it is looked for, what is looked for there], each a list of [name, test].
  function tests(filter) {
    const where = [], what = [];
    const named = (key, names, place, text) => {
      if (!filter.has(key)) return;
      const at = names.indexOf(filter.get(key));
      const unknown = at < 0 ? " (there is none of that name)" : "";
      where.push([text(filter.get(key)) + unknown, (row) => row[place] === at]);
    };
    if (filter.has("versus")) {
      const [first, second] = [data.methods.indexOf(filter.get("method")), data.methods.indexOf(filter.get("versus"))];
      const by = filter.get("by");
      const ids = shared(first, second, by);
      where.push([`${filter.get("method")} and ${filter.get("versus")}`,
        (row) => row[METHOD] === first || row[METHOD] === second]);
      what.push([by === "any" ? "the same missions" : by === "oracle" ? "where oracle success differs" : "where success differs",
        (row) => ids.has(row[ID])]);
    } else named("method", data.methods, METHOD, (name) => name);
    if (filter.has("level")) where.push([`level ${filter.get("level")}`, (row) => String(row[LEVEL]) === filter.get("level")]);
    named("city", data.cities, CITY, (name) => name || "no city");
    named("place", data.places, PLACE, (name) => name);
    named("mission", data.ids, ID, (name) => `mission ${name}`);
    if (filter.has("outcome")) {
      what.push(outcomes.get(filter.get("outcome")) ?? [filter.get("outcome"), () => false]);
    }
    if (filter.has("radius")) {
      const at = data.radii.indexOf(Number(filter.get("radius")));
      what.push([`success at R = ${filter.get("radius")} m`, (row) => at >= 0 && (row[RADII] >> at) % 2 === 1]);
    }
    if (filter.has("within")) {
      const at = data.limits.indexOf(Number(filter.get("within")));
      what.push([`success within ${Number(filter.get("within")) / 60} min`, (row) => at >= 0 && (row[WITHIN] >> at) % 2 === 1]);
    }
    return [where, what];
  }

  function cell(text, kind) {
    const made = document.createElement("td");
    made.textContent = text;
    if (kind) made.className = kind;
    return made;
  }
  const share = (value) => value.toFixed(2).replace(/^0/, "");
  const whole = (value) => value === null ? "–" : value.toFixed(0);

  function line(row) {
    const made = document.createElement("tr");
    made.dataset.mission = data.ids[row[ID]];
    made.dataset.method = data.methods[row[METHOD]];
    const head = document.createElement("th");
    head.scope = "row";
    head.className = "name";
    head.textContent = data.methods[row[METHOD]];
    const goal = cell(data.goals[row[GOAL]]);
    const id = document.createElement("small");
    id.textContent = data.ids[row[ID]];
    goal.append(id);
    const judged = cell(data.words[row[JUDGE]]);
    const reason = document.createElement("small");
    reason.textContent = data.words[row[REASON]];
    judged.append(reason);
    made.append(head, cell(row[LEVEL]), cell(data.places[row[PLACE]]), goal, cell(data.causes[row[CAUSE]][1]),
      cell(share(row[SPL]), "n"), cell(share(row[CASR]), "n"), cell(whole(row[CT]), "n"), cell(whole(row[TT]), "n"),
      cell(whole(row[PATH]), "n"), cell(whole(row[SHORTEST]), "n"), cell(row[STEPS], "n"), cell(row[CALLS], "n"),
      cell(`${row[SMALL]} / ${row[LARGE]}`, "n"), judged);
    return made;
  }

  let found = [], shown = 0;
  function draw(count) {
    const piece = document.createDocumentFragment();
    for (const row of found.slice(shown, shown + count)) piece.append(line(row));
    body.append(piece);
    shown = Math.min(found.length, shown + count);
    more.hidden = shown >= found.length;
    more.textContent = `Show ${Math.min(PIECE, found.length - shown)} more of ${(found.length - shown).toLocaleString("en")}`;
  }

  function apply(jump) {
    const filter = wanted();
    const [where, what] = tests(filter);
    const there = data.rows.filter((row) => where.every(([, test]) => test(row)));
    found = there.filter((row) => what.every(([, test]) => test(row)));
    for (const name of ["method", "level", "city", "place", "outcome"]) {
      form.elements[name].value = filter.get(name) ?? "";
      if (form.elements[name].selectedIndex < 0) form.elements[name].value = "";
    }
    const of = where.length ? ` of ${where.map(([name]) => name).join(", ")}` : "";
    const asked = what.length ? `: ${what.map(([name]) => name).join(", ")}` : "";
    const number = (count) => count.toLocaleString("en");
    status.textContent = what.length
      ? `${number(found.length)} of ${number(there.length)} missions${of}${asked}`
      : `${number(found.length)} missions${of}`;
    body.replaceChildren();
    shown = 0;
    draw(PIECE);
    if (jump && [...filter].length) {
      const heading = document.getElementById("h-missions");
      heading.focus({ preventScroll: true });
      heading.scrollIntoView();
    }
  }

  form.addEventListener("change", (event) => {
    const filter = wanted();
    // What only a number of a table can ask for goes when a person chooses.
    for (const name of ["versus", "by", "radius", "within", "mission"]) filter.delete(name);
    if (event.target.value === "") filter.delete(event.target.name);
    else filter.set(event.target.name, event.target.value);
    history.pushState(null, "", `#${filter}`);
    apply(false);
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  document.getElementById("all").addEventListener("click", () => {
    history.pushState(null, "", "#missions");
    apply(false);
  });
  more.addEventListener("click", () => draw(PIECE));
  window.addEventListener("hashchange", () => apply(true));
  window.addEventListener("popstate", () => apply(false));
  apply(true);
})();
