// Specifications of the charts that follow the explorer: what was declared for an axis of numbers, fitted to the axis
// and to the colours that are chosen. Numbers have lines; names, which have no order, have bars.
"use strict";

marti.specs = (() => {
  const palette = 8; // colours that are told apart by everybody

  /** The axis' values side by side; long names are turned, so that none is left out. */
  function sideBySide(axis) {
    const turned = !axis.numeric && axis.texts.join("").length > 56;
    const labels = axis.numeric ? { labelAngle: 0, labelOverlap: true } : { labelAngle: turned ? -35 : 0, labelLimit: 140 };
    // In this order as a domain: what sorts becomes an expression, and names of others have no place in one.
    return { field: "value", type: "ordinal", scale: { domain: axis.texts }, title: axis.name, axis: labels };
  }

  /** Names have colours of their own while there are enough; numbers and many names go from dark to light. */
  function colours(axis, texts) {
    const plain = texts.length <= (axis.numeric ? 4 : palette);
    const legend = { orient: "bottom", columns: 4, symbolLimit: 40, symbolOpacity: 1, symbolStrokeWidth: 0 };
    const scale = { domain: texts, ...(!plain && { scheme: "viridis" }) };
    return { field: "colour", type: plain ? "nominal" : "ordinal", title: axis.name, scale, legend };
  }

  const isLine = (mark) => (mark.type ?? mark) === "line";
  const bar = { type: "bar", cursor: "pointer" };

  /** A line of a declared chart as bars, those of several lines beside each other. */
  function barred({ encoding, ...view }) {
    const { shape, y, ...channels } = encoding;
    const { field, scale } = channels.color ?? {};
    channels.y = y.scale?.zero === false ? { ...y, scale: { ...y.scale, zero: true } } : y;
    const xOffset = field && { field, type: "nominal", ...(scale?.domain && { scale: { domain: scale.domain } }) };
    return { ...view, mark: bar, encoding: { ...channels, ...(xOffset && { xOffset }) } };
  }

  /** Figures along an axis, with a line at the chosen point. */
  function sliced(spec, axis) {
    const { mark, encoding, ...rest } = spec;
    const x = sideBySide(axis);
    const views = (spec.layer ?? [{ mark, encoding }]).map((view) => {
      if (!view.encoding.x) return view;
      const placed = { ...view, encoding: { ...view.encoding, x } };
      return isLine(view.mark) && !axis.numeric ? barred(placed) : placed;
    });
    const rule = { type: "rule", color: "#D55E00", strokeWidth: 1, tooltip: null };
    return { ...rest, layer: [...views, { transform: [{ filter: "datum.chosen" }], mark: rule, encoding: { x } }] };
  }

  /** Lines along an axis of numbers; if colours show another axis, one of each colour, without the bound. */
  function curved(spec, axis, colour) {
    const x = { field: "x", type: "quantitative", ...axis.x };
    const whole = { ...spec, encoding: { ...spec.encoding, x } };
    if (!colour) return whole;
    const exact = spec.layer.find(({ name }) => name === "exact");
    const others = spec.layer.filter(({ name }) => name !== "exact" && name !== "bound");
    const tooltip = [{ field: "colour", type: "nominal", title: colour.title }, ...exact.encoding.tooltip];
    const lines = { ...exact, encoding: { ...exact.encoding, color: colour, tooltip } };
    const grey = others.map((view) => {
      const { color, ...encoding } = view.encoding;
      return color ? { ...view, mark: { ...view.mark, color: "#777777" }, encoding } : view;
    });
    return { ...whole, layer: [...grey, lines] };
  }

  /** Frame time or speed-up of names: bars from 0, beside each other where colours show another axis. */
  function compared(spec, axis, colour) {
    const { layer, encoding, ...rest } = spec;
    const exact = layer.find(({ name }) => name === "exact");
    const { scale, ...y } = { ...encoding.y, ...exact.encoding.y };
    const [, ...figures] = exact.encoding.tooltip;
    const tooltip = [{ field: "value", type: "nominal", title: axis.name }, ...figures];
    const channels = { x: sideBySide(axis), y, tooltip, stroke: { value: "#777777" } };
    channels.strokeWidth = { condition: { test: "datum.chosen", value: 3 }, value: 0 };
    if (colour) {
      channels.color = colour;
      channels.xOffset = { field: "colour", type: "nominal", scale: { domain: colour.scale.domain } };
      tooltip.splice(1, 0, { field: "colour", type: "nominal", title: colour.title });
    }
    return { ...rest, transform: exact.transform, mark: bar, encoding: channels };
  }

  /** All points, in the colours of an axis. */
  function offered(spec, colour) {
    if (!colour) return spec;
    const layer = spec.layer.map((view) => {
      if (view.name !== "points" && view.name !== "front") return view;
      const { color, ...mark } = view.mark;
      return { ...view, mark, encoding: { ...view.encoding, color: colour } };
    });
    return { ...spec, layer };
  }

  /** The figure of the reader's choice, with its name and unit beside its axis. */
  function chosen({ encoding, ...spec }, { title, unit, percent }) {
    const shown = percent ? "%" : unit;
    const y = { ...encoding.y, title: !shown || shown === "1" ? title : `${title}, ${shown}` };
    return { ...spec, encoding: { ...encoding, y: percent ? { ...y, axis: { format: ".3~%" } } : y } };
  }

  /** The declared specification `spec` of the chart with this `live`, for a view (explorer_rows.js). */
  function of(explorer, spec, live, view) {
    const shown = live.rows === "explorer" && view.colour === view.axis ? null : view.colour;
    const coloured = shown === null ? null : explorer.axes[shown];
    if (live.rows === "slice") return sliced(spec, explorer.axes[live.axis ?? view.axis]);
    if (live.rows === "figure") return sliced(chosen(spec, marti.rows.fieldOf(explorer, view)), explorer.axes[view.axis]);
    if (live.rows === "all") return offered(spec, coloured && colours(coloured, coloured.texts));
    const axis = explorer.axes[view.axis];
    const texts = coloured && marti.rows.around(explorer, shown, view.place).map((i) => coloured.texts[i]);
    const colour = coloured && colours(coloured, texts);
    return axis.numeric ? curved(spec, axis, colour) : compared(spec, axis, colour);
  }

  /** The title says which axis the chart runs along, where the reader chooses it. */
  function titled(explorer, live, view, title) {
    if (!live.title || live.axis !== undefined) return title;
    const field = live.rows === "figure" && marti.rows.fieldOf(explorer, view).title;
    return `${field ? field[0].toUpperCase() + field.slice(1) : live.title} over ${explorer.axes[view.axis].name}`;
  }

  /** The machine of a chart along an axis: the values on the others; of a chart of all points the sweep. */
  function aboutOf(explorer, live, view, about) {
    if (live.rows === "all") return about;
    const shown = [live.axis ?? view.axis, ...(live.rows === "explorer" && view.colour !== null ? [view.colour] : [])];
    const others = explorer.axes.flatMap(({ name, texts }, a) => (shown.includes(a) ? [] : [`${name} = ${texts[view.place[a]]}`]));
    return others.join(", ");
  }

  /** A complete specification, with title, rows and marks. */
  function filled(explorer, spec, live, view, about) {
    const title = martiTitle(titled(explorer, live, view, spec.title), aboutOf(explorer, live, view, about));
    const made = { ...of(explorer, spec, live, view), title };
    made.data = { name: "rows", values: marti.rows.of(explorer, live, view) };
    if (live.rows === "all") made.datasets = { marks: marti.rows.marks(explorer, live, view) };
    return made;
  }

  return { filled };
})();
