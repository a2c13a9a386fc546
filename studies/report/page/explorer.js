// The what-if explorer: a control for each axis of the sweep, and the charts that follow them.
"use strict";

marti.explorer = (() => {
  const { data, charts } = marti.charts;
  const explorer = data.explorer;
  if (!explorer) return null;
  const state = {
    axis: explorer.axis,
    place: explorer.axes.map((_, a) => explorer.place[a][explorer.start]),
    x: null, // index of the sample that the curve is read at
  };
  const controls = document.getElementById("controls");
  const reading = document.getElementById("reading");
  const inputs = new Map();
  const digits = (value) => String(Number(Number(value).toPrecision(4)));

  const samples = () => explorer.models[state.axis]?.x ?? explorer.axes[state.axis].values;
  const valueAt = (axis) => explorer.axes[axis].texts[state.place[axis]];
  const withUnit = (axis, x) => {
    const at = axis.values.indexOf(x);
    return at >= 0 ? axis.texts[at] : `${digits(x)}${axis.unit && axis.unit !== "1" ? " " + axis.unit : ""}`;
  };

  /** The exact value nearest to a sample: what the other charts show. */
  function nearest(axis, x) {
    const distance = (value) => Math.abs(axis.logarithmic ? Math.log(value / x) : value - x);
    let best = 0;
    axis.values.forEach((value, i) => {
      if (distance(value) < distance(axis.values[best])) best = i;
    });
    return best;
  }

  function read() {
    const axis = explorer.axes[state.axis];
    const x = samples()[state.x];
    const at = axis.values.indexOf(x);
    const line = marti.rows.line(explorer, state.axis, state.place);
    const point = at < 0 ? undefined : line.find((p) => explorer.place[state.axis][p] === at);
    let text = `${axis.name} = ${withUnit(axis, x)}: `;
    let beyond = false;
    if (point !== undefined) {
      text += `exact, point ${explorer.ordinal[point]}: ${digits(explorer.columns.end[point])} ms a frame`;
      const speedUp = explorer.columns.speed_up && explorer.columns.speed_up[point];
      text += speedUp ? `, speed-up ${digits(speedUp)}.` : ".";
    } else {
      const row = marti.rows.samples(explorer, state.axis, state.place, state.x)[0];
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

  function fill() {
    for (const chart of charts.values()) {
      if (!chart.live) continue;
      const rows = marti.rows.of(explorer, chart.live, state.axis, state.place);
      if (chart.live.rows === "explorer") rows.push({ kind: "cursor", x: samples()[state.x] });
      chart.spec.data.values = rows;
    }
  }

  async function update() {
    read();
    fill();
    for (const [name, chart] of charts) {
      if (chart.live && chart.live.rows !== "all") await marti.charts.change(name, chart.spec.data.values);
    }
  }

  // Changes come faster than charts are drawn: only the latest counts.
  let pending = false;
  let running = 0;
  function request() {
    if (pending) return;
    pending = true;
    requestAnimationFrame(() => {
      pending = false;
      working(update);
    });
  }

  /** What takes time and changes what charts show. */
  async function working(work) {
    running += 1;
    try {
      await work();
    } finally {
      running -= 1;
    }
  }

  // Whether the charts may not show yet what the controls say.
  const busy = () => pending || running > 0;

  function showControl(a) {
    const axis = explorer.axes[a];
    const { input, output } = inputs.get(a);
    if (axis.numeric) {
      const own = a === state.axis;
      input.max = (own ? samples().length : axis.values.length) - 1;
      input.value = own ? state.x : state.place[a];
      const text = own ? withUnit(axis, samples()[state.x]) : valueAt(a);
      output.textContent = text + (own ? " (along the curve)" : "");
      input.setAttribute("aria-valuetext", text);
    } else {
      input.value = state.place[a];
    }
  }

  function toSample() {
    const axis = explorer.axes[state.axis];
    state.x = Math.max(0, samples().indexOf(axis.values[state.place[state.axis]]));
  }

  function addControl(a) {
    const axis = explorer.axes[a];
    const label = document.createElement("label");
    const input = document.createElement(axis.numeric ? "input" : "select");
    const output = document.createElement("output");
    label.append(`${[axis.name, ...axis.followers].join(", ")} `, output, input);
    input.dataset.axis = axis.name;
    input.id = `axis-${a}`;
    label.htmlFor = input.id;
    if (axis.numeric) {
      input.type = "range";
      input.min = 0;
      input.step = 1;
    } else {
      axis.texts.forEach((text, i) => input.append(new Option(text, i)));
    }
    input.addEventListener("input", () => {
      const value = Number(input.value);
      if (axis.numeric && a === state.axis) {
        state.x = value;
        state.place[a] = nearest(axis, samples()[value]);
      } else {
        state.place[a] = value;
      }
      showControl(a);
      request();
    });
    inputs.set(a, { input, output });
    controls.append(label);
  }

  /** Another axis for the two charts of the explorer: other scales, so they are drawn anew. */
  async function turn(a) {
    state.axis = a;
    toSample();
    for (const each of inputs.keys()) showControl(each);
    read();
    fill();
    for (const [name, chart] of charts) {
      if (!chart.live) continue;
      if (chart.live.rows === "explorer") {
        chart.spec.encoding.x = { field: "x", type: "quantitative", ...explorer.axes[a].x };
        chart.title = `${chart.live.title} over ${explorer.axes[a].name}`;
        chart.spec.title = chart.title;
        document.getElementById(`title-${name}`).textContent = chart.title;
        document.getElementById(`note-${name}`).textContent = explorer.models[a]?.note ?? explorer.no_model;
        await marti.charts.draw(name);
      } else {
        await marti.charts.change(name, chart.spec.data.values);
      }
    }
  }

  function addAxisChoice() {
    const label = document.createElement("label");
    const select = document.createElement("select");
    select.id = "along";
    label.htmlFor = select.id;
    label.append("Curve along ", select);
    explorer.axes.forEach((axis, a) => {
      if (axis.numeric) select.append(new Option(axis.name, a));
    });
    select.value = state.axis;
    select.addEventListener("change", () => working(() => turn(Number(select.value))));
    controls.append(label);
  }

  function addPoints() {
    const details = document.getElementById("points");
    const most = 1000;
    const fields = explorer.fields;
    const measure = ({ name, unit }) => (unit === "1" ? name : `${name}_${unit}`);
    const names = [...explorer.axes.map((axis) => axis.name), ...fields.map(measure)];
    const row = (i) => [
      ...explorer.axes.map((axis, a) => axis.texts[explorer.place[a][i]]),
      ...fields.map((field) => explorer.columns[field.name][i]),
    ];
    document.getElementById("save-points").addEventListener("click", (event) => {
      event.preventDefault();
      const named = (i) => Object.fromEntries(row(i).map((cell, c) => [names[c], cell]));
      const rows = explorer.ordinal.map((ordinal, i) => ({ ordinal, ...named(i) }));
      marti.charts.save("machines.csv", "text/csv", marti.charts.csv(rows));
    });
    details.addEventListener("toggle", () => {
      const place = document.getElementById("points-table");
      if (!details.open || place.childElementCount > 0) return;
      const table = document.createElement("table");
      const head = table.createTHead().insertRow();
      ["point", ...names].forEach((name) => {
        const cell = document.createElement("th");
        cell.scope = "col";
        cell.textContent = name.replaceAll("_", " ");
        head.append(cell);
      });
      const body = table.createTBody();
      explorer.ordinal.slice(0, most).forEach((ordinal, i) => {
        const line = body.insertRow();
        [ordinal, ...row(i)].forEach((value) => {
          const cell = line.insertCell();
          cell.textContent = typeof value === "number" && !Number.isInteger(value) ? digits(value) : (value ?? "");
          if (typeof value === "number") cell.className = "number";
        });
      });
      place.append(table);
    });
  }

  if (state.axis === null) {
    fill();
    return null;
  }
  explorer.axes.forEach((_, a) => addControl(a));
  addAxisChoice();
  toSample();
  for (const a of inputs.keys()) showControl(a);
  addPoints();
  read();
  fill();
  return { busy };
})();
