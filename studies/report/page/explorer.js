// The explorer of a sweep: a control for each axis, the charts that follow them, the table of all points and the chosen
// point. What is chosen is in the page's address.
"use strict";

marti.explorer = (() => {
  const { data, charts } = marti.charts;
  const explorer = data.explorer;
  if (!explorer) return null;
  const { axes } = explorer;
  const first = marti.rows.firstView(explorer);
  const state = { ...first, place: [...first.place] };
  const live = [...charts.values()].filter((chart) => chart.live);
  const declared = new Map(live.map((chart) => [chart.name, chart.spec]));
  const reading = document.getElementById("reading");
  const points = new Map(explorer.ordinal.map((_, p) => [axes.map((_, a) => explorer.place[a][p]).join(), p]));
  const digits = (value) => marti.number(value);

  /** The point where the controls stand; undefined where none was timed. */
  const chosen = () => points.get(state.place.join());

  const view = () => ({ ...state, chosen: chosen(), lets: table.lets });

  function read() {
    const point = chosen();
    const axis = axes[state.axis];
    let text = `${axis.name} = ${axis.texts[state.place[state.axis]]}: `;
    if (point === undefined) {
      text += "this machine was not timed.";
    } else {
      text += `point ${explorer.ordinal[point]}: ${digits(explorer.columns.end[point])} ms a frame`;
      const speedUp = explorer.columns.speed_up && explorer.columns.speed_up[point];
      text += speedUp ? `, speed-up ${digits(speedUp)}.` : ".";
    }
    reading.textContent = text;
  }

  /** What of the choices shapes a chart: where it differs, the chart is drawn anew. */
  function shape({ axis, rows }) {
    if (rows === "all") return String(state.colour);
    if (rows === "slice") return String(axis ?? state.axis);
    if (rows === "figure") return `${state.axis},${state.figure}`;
    const coloured = state.colour !== null && state.colour !== state.axis;
    return [state.axis, ...(coloured ? [state.colour, ...marti.rows.around(explorer, state.colour, state.place)] : [])].join();
  }

  /** Gives each chart what it is to show; those that must be drawn anew. */
  function fill() {
    const now = view();
    return live.filter((chart) => {
      const form = shape(chart.live);
      const another = chart.form !== form;
      const { filter } = table.state;
      const all = chart.live.rows === "all";
      if (all && !another && chart.filter === filter) {
        // Of thousands of points that stay as they are only the named ones change.
        chart.spec.datasets = { marks: marti.rows.marks(explorer, chart.live, now) };
        chart.changed = ["marks"];
        return false;
      }
      const spec = marti.specs.filled(explorer, declared.get(chart.name), chart.live, now, data.about);
      if (chart.live.rows === "explorer" && axes[state.axis].numeric) {
        spec.data.values.push({ kind: "cursor", x: axes[state.axis].values[state.place[state.axis]] });
      }
      Object.assign(chart, { spec, form, filter, title: spec.title.text ?? spec.title, changed: all ? ["rows", "marks"] : ["rows"] });
      return another;
    });
  }

  function showTitles() {
    for (const chart of live) document.getElementById(`title-${chart.name}`).textContent = chart.title;
  }

  async function update() {
    if (state.axis !== null) read();
    const anew = new Set(fill());
    showTitles();
    table.mark(chosen());
    showPoint(chosen(), state.budget);
    marti.address.write(address());
    for (const chart of live) {
      if (anew.has(chart)) await marti.charts.draw(chart.name);
      else await marti.charts.change(chart.name);
    }
  }

  // Changes come faster than charts are drawn: only the latest counts.
  let pending = false;
  let running = 0;
  let turn = Promise.resolve();  // what is changed by one update must not be changed by the next before it is drawn
  async function next() {
    pending = false;
    running += 1;
    try {
      await update();
    } finally {
      running -= 1;
    }
  }
  function request() {
    if (pending) return;
    pending = true;
    requestAnimationFrame(() => (turn = turn.then(next, next)));
  }

  // Whether the charts may not show yet what the controls say.
  const busy = () => pending || running > 0;

  function choose(p) {
    state.place = axes.map((_, a) => explorer.place[a][p]);
    if (state.axis !== null) controls.show(state);
    request();
  }

  // What the controls say.
  function moved(a, value) {
    state.place[a] = value;
    controls.show(state);
    request();
  }

  function turned(a) {
    state.axis = a;
    controls.show(state);
    request();
  }

  function coloured(a) {
    state.colour = a;
    request();
  }

  function figured(figure) {
    state.figure = figure;
    request();
  }

  function budgeted(price) {
    state.budget = price;
    request();
  }

  /** The choices that differ from those that the page begins with, by name. */
  function address() {
    const point = chosen();
    const named = { ...table.state };
    if (state.axis === null) return named;
    if (state.axis !== first.axis) named.along = axes[state.axis].name;
    if (state.colour !== first.colour) named.colour = state.colour === null ? "none" : axes[state.colour].name;
    if (state.figure !== first.figure) named.figure = state.figure;
    if (state.budget !== first.budget) named.budget = state.budget ?? "none";
    if (point !== undefined) {
      if (point !== explorer.start) named.point = explorer.ordinal[point];
      return named;
    }
    axes.forEach((axis, a) => (named[`axis.${axis.name}`] = axis.texts[state.place[a]]));
    return named;
  }

  /** The choices of an address; what it does not say, or says wrongly, is as the page begins. */
  function take(named) {
    const axisNamed = (name, other) => (axes.some((axis) => axis.name === name) ? axes.findIndex((axis) => axis.name === name) : other);
    const point = explorer.ordinal.indexOf(Number(named.point || NaN));
    table.set(named);
    if (state.axis === null) return;
    state.axis = axisNamed(named.along, first.axis);
    state.colour = named.colour === "none" ? null : axisNamed(named.colour, first.colour);
    state.figure = explorer.fields.some(({ name }) => name === named.figure) ? named.figure : first.figure;
    state.budget = named.budget === "none" ? null : marti.budgetOf(named.budget) ?? first.budget;
    state.place = axes.map((axis, a) => {
      const at = axis.texts.indexOf(named[`axis.${axis.name}`]);
      return at >= 0 ? at : explorer.place[a][point >= 0 ? point : explorer.start];
    });
    controls.show(state);
  }

  const table = marti.table(explorer, { choose, changed: request });
  const showPoint = marti.chosenPoint(explorer);
  const controls = state.axis === null ? null : marti.controls(explorer, { moved, turned, coloured, figured, budgeted });
  take(marti.address.read() ?? {});
  if (state.axis !== null) read();
  fill();
  showTitles();
  table.mark(chosen());
  showPoint(chosen(), state.budget);
  window.addEventListener("hashchange", () => {
    const named = marti.address.read();
    if (!named) return;
    take(named);
    request();
  });
  return { busy, chooseOrdinal: (ordinal) => choose(explorer.ordinal.indexOf(ordinal)) };
})();
