// The explorer of a sweep: a control for each axis, the charts that follow them, the table of all points and the chosen
// point. What is chosen is in the page's address.
"use strict";

marti.explorer = (() => {
  const { data, charts } = marti.charts;
  const explorer = data.explorer;
  if (!explorer) return null;
  const { axes } = explorer;
  const first = marti.rows.firstView(explorer);
  const state = { ...first, place: [...first.place], x: null }; // x: index of the sample that the curve is read at
  const live = [...charts.values()].filter((chart) => chart.live);
  const declared = new Map(live.map((chart) => [chart.name, chart.spec]));
  const reading = document.getElementById("reading");
  const points = new Map(explorer.ordinal.map((_, p) => [axes.map((_, a) => explorer.place[a][p]).join(), p]));
  const digits = (value) => marti.number(value);

  /** Places along an axis at which the curve can be read; a name is only itself. */
  const samples = (a = state.axis) => (axes[a].numeric ? explorer.models[a]?.x ?? axes[a].values : axes[a].texts.map((_, i) => i));
  const placeOf = (axis, x) => (axis.numeric ? axis.values.indexOf(x) : x);
  const withUnit = (axis, x) => {
    const at = placeOf(axis, x);
    return at >= 0 ? axis.texts[at] : marti.number(x, axis);
  };

  /** The point where the controls stand; undefined between points, and where none was timed. */
  function chosen() {
    const between = state.axis !== null && placeOf(axes[state.axis], samples()[state.x]) < 0;
    return between ? undefined : points.get(state.place.join());
  }

  const view = () => ({ ...state, chosen: chosen(), lets: table.lets });

  /** The exact value nearest to a sample: what the other charts show. */
  function nearest(axis, x) {
    if (!axis.numeric) return x;
    const distance = (value) => Math.abs(axis.logarithmic ? Math.log(value / x) : value - x);
    let best = 0;
    axis.values.forEach((value, i) => {
      if (distance(value) < distance(axis.values[best])) best = i;
    });
    return best;
  }

  function read() {
    const axis = axes[state.axis];
    const x = samples()[state.x];
    const point = chosen();
    let text = `${axis.name} = ${withUnit(axis, x)}: `;
    let beyond = false;
    if (point !== undefined) {
      text += `exact, point ${explorer.ordinal[point]}: ${digits(explorer.columns.end[point])} ms a frame`;
      const speedUp = explorer.columns.speed_up && explorer.columns.speed_up[point];
      text += speedUp ? `, speed-up ${digits(speedUp)}.` : ".";
    } else {
      const row = axis.numeric && marti.rows.samples(explorer, state.axis, state.place, state.x)[0];
      if (!row) {
        text += "this machine was not timed, and the model has no measured error here.";
      } else {
        beyond = row.zone !== "between";
        text += `modelled, ${digits(row.ms)} ms a frame (95 % band ${digits(row.ms_low)} to ${digits(row.ms_high)} ms)`;
        if (row.speed_up) {
          text += `, speed-up ${digits(row.speed_up)} (${digits(row.speed_up_low)} to ${digits(row.speed_up_high)})`;
        }
        text += beyond ? ". Extrapolated: beyond all exact points." : ".";
      }
    }
    reading.textContent = text;
    reading.classList.toggle("extrapolated", beyond);
  }

  /** What of the choices shapes a chart: where it differs, the chart is drawn anew. */
  function shape({ axis, rows }) {
    if (rows === "all") return String(state.colour);
    if (rows === "slice") return String(axis ?? state.axis);
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
        spec.data.values.push({ kind: "cursor", x: samples()[state.x] });
      }
      Object.assign(chart, { spec, form, filter, title: spec.title.text ?? spec.title, changed: all ? ["rows", "marks"] : ["rows"] });
      return another;
    });
  }

  function showTitles() {
    for (const chart of live) {
      document.getElementById(`title-${chart.name}`).textContent = chart.title;
      if (chart.live.rows !== "explorer") continue;
      const note = axes[state.axis].numeric ? explorer.models[state.axis]?.note ?? explorer.no_model : explorer.no_curve;
      document.getElementById(`note-${chart.name}`).textContent = note;
    }
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

  function showControls() {
    controls.show(state, { at: state.x, last: samples().length - 1, text: withUnit(axes[state.axis], samples()[state.x]) });
  }

  /** The curve is read where the machine stands. */
  function toSample() {
    const axis = axes[state.axis];
    const at = state.place[state.axis];
    state.x = Math.max(0, samples().indexOf(axis.numeric ? axis.values[at] : at));
  }

  function choose(p) {
    state.place = axes.map((_, a) => explorer.place[a][p]);
    if (state.axis !== null) {
      toSample();
      showControls();
    }
    request();
  }

  // What the controls say.
  function moved(a, value) {
    const own = a === state.axis;
    if (own) state.x = value;
    state.place[a] = own ? nearest(axes[a], samples()[value]) : value;
    showControls();
    request();
  }

  function turned(a) {
    state.axis = a;
    toSample();
    showControls();
    request();
  }

  function coloured(a) {
    state.colour = a;
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
    if (state.budget !== first.budget) named.budget = state.budget ?? "none";
    if (point !== undefined) {
      if (point !== explorer.start) named.point = explorer.ordinal[point];
      return named;
    }
    axes.forEach((axis, a) => (named[`axis.${axis.name}`] = axis.texts[state.place[a]]));
    if (axes[state.axis].numeric) named.at = samples()[state.x];
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
    state.budget = named.budget === "none" ? null : marti.budgetOf(named.budget) ?? first.budget;
    state.place = axes.map((axis, a) => {
      const at = axis.texts.indexOf(named[`axis.${axis.name}`]);
      return at >= 0 ? at : explorer.place[a][point >= 0 ? point : explorer.start];
    });
    toSample();
    const sample = samples().indexOf(Number(named.at || NaN));
    if (sample >= 0 && axes[state.axis].numeric) {
      state.x = sample;
      state.place[state.axis] = nearest(axes[state.axis], samples()[sample]);
    }
    showControls();
  }

  const table = marti.table(explorer, { choose, changed: request });
  const showPoint = marti.chosenPoint(explorer);
  const controls = state.axis === null ? null : marti.controls(explorer, { moved, turned, coloured, budgeted });
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
