// Rows of the charts that follow the explorer, from the columns and curves of a sweep (docs/report.md). A page has
// them for the machine that its reader has chosen, a plot for the one that the page begins with. No element of the
// page is touched here.
"use strict";

marti.rows = (() => {
  const key = (place, axis) => place.map((value, i) => (i === axis ? "*" : value)).join(",");

  /** Numbers of the points that differ from `place` along `axis` only, in the axis' order. */
  function line(explorer, axis, place) {
    const found = [];
    for (let i = 0; i < explorer.ordinal.length; ++i) {
      if (explorer.axes.every((_, a) => a === axis || explorer.place[a][i] === place[a])) found.push(i);
    }
    return found.sort((a, b) => explorer.place[axis][a] - explorer.place[axis][b]);
  }

  /** What the model says at sample `i` of a curve, with the band of a zone: "below", "between" or "above". */
  function banded(model, curve, i, zone) {
    const which = zone === "between" ? "between" : "beyond";
    const factor = 1 + model.error[which].p95;
    const base = Array.isArray(curve.base) ? curve.base[i] : curve.base;
    const ms = curve.ms[i];
    const row = { kind: "model", zone, x: model.x[i], ms, ms_low: ms / factor, ms_high: ms * factor };
    row.ms_bound = curve.bound[i];
    if (base > 0 && model.speed_up_error[which].known) {
      const speedFactor = 1 + model.speed_up_error[which].p95;
      row.speed_up = base / ms;
      row.speed_up_low = row.speed_up / speedFactor;
      row.speed_up_high = row.speed_up * speedFactor;
      row.speed_up_bound = curve.bound[i] > 0 ? base / curve.bound[i] : null;
    }
    return row;
  }

  /** Rows of sample `i`: none where there is no curve or no measured error, two at the outer points. */
  function samples(explorer, axis, place, i) {
    const model = explorer.models[axis];
    const curve = model && model.curves[key(place, axis)];
    if (!curve || curve.ms[i] === null || curve.ms[i] === undefined) return [];
    const xs = line(explorer, axis, place).map((p) => explorer.axes[axis].values[explorer.place[axis][p]]);
    const first = xs[0];
    const last = xs[xs.length - 1];
    const x = model.x[i];
    const zones = [];
    if (x <= first && model.error.beyond.known) zones.push("below");
    if (x >= first && x <= last && model.error.between.known) zones.push("between");
    if (x >= last && model.error.beyond.known) zones.push("above");
    return zones.map((zone) => banded(model, curve, i, zone));
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

  function explore(explorer, axis, place) {
    const points = line(explorer, axis, place);
    const xs = points.map((p) => explorer.axes[axis].values[explorer.place[axis][p]]);
    const model = explorer.models[axis];
    const curve = model && model.curves[key(place, axis)];
    const unit = ideal(explorer, axis, points);
    const rows = [];
    if (curve) {
      const modelled = model.x.flatMap((_, i) => samples(explorer, axis, place, i));
      const low = Math.min(xs[0], ...modelled.map((row) => row.x));
      const high = Math.max(xs[xs.length - 1], ...modelled.map((row) => row.x));
      if (low < xs[0]) rows.push({ kind: "zone", zone: "below", x: low, x2: xs[0] });
      if (high > xs[xs.length - 1]) rows.push({ kind: "zone", zone: "above", x: xs[xs.length - 1], x2: high });
      if (curve.saturation >= low && curve.saturation <= high) rows.push({ kind: "saturation", x: curve.saturation });
      for (const row of modelled) rows.push(unit > 0 ? { ...row, ideal: unit * row.x } : row);
    }
    points.forEach((p, i) => {
      const row = { kind: "exact", zone: "between", x: xs[i], ms: explorer.columns.end[p] };
      if (explorer.columns.speed_up) row.speed_up = explorer.columns.speed_up[p];
      if (unit > 0) row.ideal = unit * xs[i];
      rows.push(row);
    });
    return rows;
  }

  /** Exact points along an axis: its texts and some figures. */
  function slice(explorer, live, place) {
    const axis = explorer.axes[live.axis];
    return line(explorer, live.axis, place).map((p) => {
      const row = { value: axis.texts[explorer.place[live.axis][p]] };
      for (const field of live.fields) row[field] = explorer.columns[field][p];
      return row;
    });
  }

  /** Every point that has the figure `live.by`, by that and time. */
  function all(explorer, live) {
    const front = new Set(explorer.fronts[live.by]);
    const rows = explorer.ordinal.map((ordinal, i) => ({
      ordinal,
      [live.by]: explorer.columns[live.by][i],
      ms: explorer.columns.end[i],
      front: front.has(i) ? 1 : 0,
    }));
    return rows.filter((row) => row[live.by] !== null);
  }

  /** Rows of the chart with this `live`, for the machine at `place` and the curve along `axis`. */
  function of(explorer, live, axis, place) {
    if (live.rows === "explorer") return explore(explorer, axis, place);
    return live.rows === "slice" ? slice(explorer, live, place) : all(explorer, live);
  }

  return { line, samples, of };
})();
