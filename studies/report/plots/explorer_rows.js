// Rows of the charts that follow the explorer, from the columns of a sweep (docs/internals/pages.md). A page has
// them for the machine that its reader has chosen, a plot for the one that the page begins with. A view says what is
// chosen: {axis, place, colour, figure, chosen, lets, budget}, of which a plot has the first four. No element of the page is touched
// here.
"use strict";

marti.rows = (() => {
  /** Numbers of the points that differ from `place` along `axis` only, in the axis' order. */
  function line(explorer, axis, place) {
    const found = [];
    for (let i = 0; i < explorer.ordinal.length; ++i) {
      if (explorer.axes.every((_, a) => a === axis || explorer.place[a][i] === place[a])) found.push(i);
    }
    return found.sort((a, b) => explorer.place[axis][a] - explorer.place[axis][b]);
  }

  /** Speed-up that is the number of nodes, for a unit of the axis; 0 when it is no axis of nodes. */
  function ideal(explorer, axis, points) {
    if (explorer.axes[axis].name !== "machine.nodes" || !explorer.columns.efficiency) return 0;
    let most = 0;
    for (const p of points) {
      const efficiency = explorer.columns.efficiency[p];
      const x = explorer.axes[axis].values[explorer.place[axis][p]];
      if (efficiency > 0) most = Math.max(most, explorer.columns.speed_up[p] / efficiency / x);
    }
    return most;
  }

  const most = 4; // lines that a reader tells apart in one chart

  /** Indices of the values of the axis that colours show in a chart of lines: the chosen one and those around it. */
  function around(explorer, colour, place) {
    const all = explorer.axes[colour].texts.length;
    const first = Math.max(0, Math.min(place[colour] - 1, all - most));
    return [...Array(Math.min(most, all)).keys()].map((i) => first + i);
  }

  /** What an exact point is called and, where colours show an axis, its value there. */
  function named(explorer, p, colour) {
    const row = { ordinal: explorer.ordinal[p] };
    if (colour !== null) row.colour = explorer.axes[colour].texts[explorer.place[colour][p]];
    return row;
  }

  /** The machine of a point: "machine.nodes = 16, cache.size = 16 KiB". */
  const machine = ({ axes, place }, p) => axes.map((axis, a) => `${axis.name} = ${axis.texts[place[a][p]]}`).join(", ");

  function exact(explorer, { axis, chosen }, p, colour, kind) {
    const { numeric, values, texts } = explorer.axes[axis];
    const at = explorer.place[axis][p];
    const { end, bound, speed_up: speedUp } = explorer.columns;
    const row = { kind, ...named(explorer, p, colour), value: texts[at], ms: end[p], ms_bound: bound[p] };
    if (numeric) row.x = values[at];
    if (speedUp) row.speed_up = speedUp[p];
    if (speedUp?.[p] && bound[p] > 0) row.speed_up_bound = (speedUp[p] * end[p]) / bound[p];
    if (p === chosen) row.chosen = 1;
    return row;
  }

  function explore(explorer, view) {
    const { axis, place } = view;
    const shown = view.colour === axis ? null : view.colour;
    const points = line(explorer, axis, place);
    const unit = ideal(explorer, axis, points);
    const rows = points.map((p) => {
      const row = exact(explorer, view, p, shown, "exact");
      return unit > 0 ? { ...row, ideal: unit * row.x } : row;
    });
    const full = explorer.axes[axis].name === "machine.nodes" && explorer.columns.saturation?.[points.at(-1)];
    if (full >= rows[0]?.x && full <= rows.at(-1).x) rows.push({ kind: "saturation", x: full });
    for (const value of shown === null ? [] : around(explorer, shown, place)) {
      if (value === place[shown]) continue;
      const other = place.map((at, a) => (a === shown ? value : at));
      for (const p of line(explorer, axis, other)) rows.push(exact(explorer, view, p, shown, "other"));
    }
    return rows;
  }

  /** Exact points along an axis: its texts and some figures. */
  function slice(explorer, live, view) {
    const along = live.axis ?? view.axis;
    const axis = explorer.axes[along];
    return line(explorer, along, view.place).map((p) => {
      const row = { ordinal: explorer.ordinal[p], value: axis.texts[explorer.place[along][p]] };
      for (const field of live.fields) row[field] = explorer.columns[field][p];
      if (p === view.chosen) row.chosen = 1;
      return row;
    });
  }

  /** The field of the figure that the reader has chosen. */
  const fieldOf = ({ fields }, { figure }) => fields.find(({ name }) => name === figure);

  /** Exact points along the axis: its texts and the chosen figure. */
  function figure(explorer, view) {
    const { name, title } = fieldOf(explorer, view);
    return slice(explorer, { fields: [name] }, view).map(({ [name]: amount, ...row }) => ({ ...row, figure: title, amount }));
  }

  /** Every point that has the figure `live.by`, by that and time; `lets` are those that the table's filter lets through. */
  function all(explorer, live, { colour, lets }) {
    const front = new Set(explorer.fronts[live.by]);
    const rows = explorer.ordinal.map((_, p) => ({
      ...named(explorer, p, colour),
      machine: machine(explorer, p),
      [live.by]: explorer.columns[live.by][p],
      ms: explorer.columns.end[p],
      front: front.has(p) ? 1 : 0,
      ...(lets && !lets[p] && { filtered: 1 }),
    }));
    return rows.filter((row) => row[live.by] !== null);
  }

  /** Numbers of points by what they are known for: the fastest, the knee, the best within the budget. */
  function roles(explorer, budget) {
    const found = [["fastest", explorer.fastest], ["knee", explorer.start]];
    const within = explorer.fronts.price.filter((p) => explorer.columns.price[p] <= (budget ?? -1));
    if (within.length > 0) found.push([`best within ${budget}`, within.at(-1)]);
    return found;
  }

  /** The points that a chart of all points marks by name, and the budget. */
  function marks(explorer, live, { chosen, budget }) {
    const names = new Map();
    const add = (name, p) => p !== undefined && names.set(p, [...(names.get(p) ?? []), name]);
    for (const [name, p] of roles(explorer, budget)) {
      if (live.by === "price" || name === "fastest") add(name, p);
    }
    add("chosen", chosen);
    const rows = [...names].map(([p, role]) => ({
      ordinal: explorer.ordinal[p],
      machine: machine(explorer, p),
      role: role.join(", "),
      side: role[0],
      chosen: p === chosen ? 1 : 0,
      [live.by]: explorer.columns[live.by][p],
      ms: explorer.columns.end[p],
    }));
    if (live.by === "price" && budget > 0) rows.push({ budget: 1, price: budget });
    return rows.filter((row) => row[live.by] !== null);
  }

  /** What a page begins with and a plot shows: the machines around the knee. */
  const firstView = ({ axis, axes, place, start, colour, columns, budget }) => {
    const figure = ["energy_a_ray", "hit_ratio", "end"].find((name) => columns[name]);
    return { axis, place: axes.map((_, a) => place[a][start]), colour: colour ?? null, figure, budget: budget ?? null };
  };

  /** Rows of the chart with this `live`, for a view. */
  function of(explorer, live, view) {
    if (live.rows === "explorer") return explore(explorer, view);
    if (live.rows === "figure") return figure(explorer, view);
    return live.rows === "slice" ? slice(explorer, live, view) : all(explorer, live, view);
  }

  return { line, around, machine, roles, marks, fieldOf, firstView, of };
})();
