// Draws the charts, and saves them and their rows as files. A view is at marti.views[NAME].
"use strict";

marti.charts = (() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const charts = new Map(data.charts.map((chart) => [chart.name, chart]));
  const shapes = new Map();  // of the specifications that are drawn, by name

  /** Vega without eval: expressions are interpreted, as the page's policy wants it. */
  function makeView(spec, config, options) {
    const compiled = vegaLite.compile(spec, { config, logger: vega.logger(vega.Error) });
    const runtime = vega.parse(compiled.spec, null, { ast: true });
    return new vega.View(runtime, { expr: vega.expressionInterpreter, logLevel: vega.Error, ...options });
  }

  const isPlain = (spec) => !["facet", "concat", "hconcat", "vconcat", "repeat"].some((part) => part in spec);

  /** As wide as there is room. The page has the title already, but not the machine of a chart that follows the reader. */
  function fitted({ spec, live }, room) {
    const { title, ...copy } = spec;
    if (live && live.rows !== "all" && title.subtitle) {
      copy.title = { text: title.subtitle, fontSize: 10, fontWeight: "normal" };
    }
    if (isPlain(copy)) {
      copy.width = Math.max(200, Math.min(room, 900));
      copy.autosize = { type: "fit-x", contains: "padding" };
    }
    return copy;
  }

  /** What the reader has chosen in a chart's lists is chosen in another view of it, too. */
  function choose(chart, view) {
    const other = marti.views[chart.name];
    for (const { name, bind } of (other && chart.spec.params) || []) {
      const chosen = other.signal(name);
      if (bind?.options?.includes(chosen) ?? true) view.signal(name, chosen);
    }
  }

  /** What of a chart wants it drawn anew when it changes. */
  const shapeOf = (spec) => JSON.stringify({ ...spec, data: null });

  async function draw(name) {
    const chart = charts.get(name);
    const place = document.getElementById(`chart-${name}`);
    const spec = fitted(chart, place.clientWidth || 560);
    const view = makeView(spec, marti.theme.inPage, { renderer: "svg", hover: true });
    choose(chart, view);
    marti.views[name]?.finalize();
    view.initialize(place);
    view.description(chart.title);
    view.tooltip(marti.tooltip);
    view.addEventListener("click", (_, item) => {
      const ordinal = item?.datum?.ordinal;
      if (ordinal !== undefined) marti.explorer?.chooseOrdinal(ordinal);
    });
    marti.views[name] = view;
    shapes.set(name, shapeOf(chart.spec));
    await view.runAsync();
  }

  /** Shows what the chart's specification has now in the data sets that have changed; it stays otherwise as it is. */
  async function change(name) {
    const { spec, changed } = charts.get(name);
    const view = marti.views[name];
    if (!view) return;
    const sets = { rows: spec.data.values, ...spec.datasets };
    for (const set of changed) view.data(set, sets[set].map((row) => vega.ingest({ ...row })));
    await view.runAsync();
  }

  /** Shows the chart's specification as it is now, drawn anew only where more than its rows has changed. */
  async function update(name) {
    const chart = charts.get(name);
    chart.changed = ["rows"];
    await (marti.views[name] && shapes.get(name) === shapeOf(chart.spec) ? change(name) : draw(name));
  }

  const shown = new Map();  // the names of the charts that are in a place now

  /** Puts these charts into `place`, those in sight first; `html` has places for them. A newer call ends an older one. */
  async function show(place, list, html) {
    const names = list.map(({ name }) => name);
    const before = shown.get(place) ?? [];
    shown.set(place, names);
    if (names.join() !== before.join()) {
      for (const name of before) {
        marti.views[name]?.finalize();
        delete marti.views[name];
        charts.delete(name);
      }
      place.innerHTML = html;
    }
    for (const chart of list) charts.set(chart.name, chart);
    const inSight = (name) => {
      const { top, bottom } = document.getElementById(`chart-${name}`).getBoundingClientRect();
      return bottom > 0 && top < innerHeight;
    };
    const first = names.filter(inSight);
    for (const name of [...first, ...names.filter((name) => !first.includes(name))]) {
      if (shown.get(place) !== names) return;
      await tried(name, update);
    }
  }

  function save(name, type, text) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  function csvCell(value) {
    if (value === null || value === undefined) return "";
    const text = String(value);
    return text === "" || /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  }

  /** RFC 4180: the names of all rows, then the rows. */
  function csv(rows) {
    const names = [...new Set(rows.flatMap((row) => Object.keys(row)))];
    const lines = [names, ...rows.map((row) => names.map((name) => row[name]))];
    return lines.map((line) => line.map(csvCell).join(",") + "\r\n").join("");
  }

  async function saveSvg(chart) {
    // A file of its own says what it is about.
    const title = chart.live ? chart.spec.title : martiTitle(chart.spec.title, data.about);
    const view = makeView({ ...chart.spec, title }, marti.theme.inFile, { renderer: "none" });
    choose(chart, view);
    const svg = await view.toSVG();
    view.finalize();
    save(`${chart.name}.svg`, "image/svg+xml", svg);
  }

  document.addEventListener("click", (event) => {
    const link = event.target.closest("a[data-save]");
    if (!link) return;
    event.preventDefault();
    const chart = charts.get(link.dataset.chart);
    // What marks the slider's position and the chosen point is no figure.
    const figures = () =>
      chart.spec.data.values.filter(({ kind }) => kind !== "cursor").map(({ chosen, filtered, ...row }) => row);
    if (link.dataset.save === "csv") save(`${chart.name}.csv`, "text/csv", csv(figures()));
    else saveSvg(chart);
  });

  /** Does it with the chart, and lets the reader do something. */
  async function tried(name, what) {
    try {
      await what(name);
    } catch (error) {
      document.getElementById(`chart-${name}`).textContent = `This chart could not be drawn: ${error.message}`;
      console.error(name, error);
    }
    await new Promise((resolve) => setTimeout(resolve, 0));
  }

  /** One after the other, so that the first is there soon. */
  async function drawAll() {
    for (const name of charts.keys()) await tried(name, draw);
  }

  let busy = Promise.resolve();
  const redraw = () => (busy = busy.then(drawAll));
  let width = window.innerWidth;
  let timer = 0;
  window.addEventListener("resize", () => {
    clearTimeout(timer);
    timer = setTimeout(() => {
      if (window.innerWidth !== width) {
        width = window.innerWidth;
        redraw();
      }
    }, 200);
  });
  return { data, charts, draw, change, update, show, redraw, csv, save };
})();
