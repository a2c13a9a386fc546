// A curve of one figure along one setting, each point simulated, and the table of pinned machines.
"use strict";

explore.curve = (() => {
  const { element, of, scaled } = explore.controls;
  const { shown } = explore.answer;
  const at = (id) => document.getElementById(id);
  const figures = ["end", "speed_up", "efficiency", "hit_ratio", "interconnect_utilisation", "bank_utilisation"];
  const columns = ["end", "speed_up", "efficiency", "hit_ratio", "interconnect_utilisation"];
  const most_values = 64;
  const chart = marti.charts.charts.get("explored_curve");
  let units = {};  // of the figures, by their names

  const value_of = (settings, name) => settings[name] ?? of(name).own;

  /** Values around the one that is set. */
  function usual(key, now) {
    if (key.type === "choice") return key.choices;
    if (key.type === "boolean") return ["false", "true"];
    const at_least = (value) => (key.type === "integer" ? Math.max(1, Number(value)) : value);
    const list = [String(at_least(now))];
    for (let i = 0; i < 4; ++i) list.unshift(scaled(key, list[0], 0.5));
    for (let i = 0; i < 4; ++i) list.push(scaled(key, list.at(-1), 2));
    return [...new Set(list)].filter((value) => !(key.type === "integer" && Number(value) < 1));
  }

  const axis_of = (state) => (of(state.axis) ? state.axis : "machine.nodes");
  const values_of = (state) => {
    const given = state.values.split(",").map((value) => value.trim()).filter(Boolean);
    const key = of(axis_of(state)).key;
    return given.length ? given.slice(0, most_values) : usual(key, value_of(state.settings, key.name));
  };
  const point = (state, value) => {
    const settings = { ...state.settings, [axis_of(state)]: value };
    if (value === of(axis_of(state)).own) delete settings[axis_of(state)];
    return settings;
  };

  /** The chart's rows, in the units of its axis. */
  function draw(state) {
    const axis = axis_of(state);
    const figure = state.figure || "end";
    const values = values_of(state);
    const answers = values.map((value) => explore.server.known(point(state, value)));
    const figure_of = (answer) => answer?.figures?.[figure] ?? null;
    const time = units[figure] === "ps";
    const { encoding, data } = chart.spec;
    Object.assign(encoding.x, { title: axis, scale: { domain: values } });
    encoding.y.title = figure.replaceAll("_", " ") + (time ? ", ms" : "");
    encoding.y.axis = units[figure] === "fraction" ? { format: ".3~%" } : {};
    data.values = values.map((value, ordinal) => {
      const found = figure_of(answers[ordinal]);
      const height = found !== null && time ? found * 1e-9 : found;
      return { ordinal, value, height, figure: shown(figure, found), here: value === value_of(state.settings, axis) };
    });
    marti.charts.update(chart.name);
    const refused = answers.map((answer, i) => answer && "error" in answer && `${values[i]}: ${answer.error}`).filter(Boolean);
    const missing = answers.filter((answer) => !answer).length;
    at("curve-state").textContent = missing ? `${missing} of ${values.length} machines are still to be simulated` : refused.join("; ");
  }

  /** A click on a point goes to its machine. */
  marti.explorer = {
    chooseOrdinal(ordinal) {
      const axis = axis_of(explore.state.now);
      const value = values_of(explore.state.now)[ordinal];
      explore.state.set({ [axis]: value === of(axis).own ? null : value });
    },
  };

  function pins(state) {
    const rows = [["as it is set", state.settings], ["configuration", {}], ...state.pins.map((pin, i) => [`pinned ${i + 1}`, pin])];
    const head = element("tr", {}, element("th", { textContent: "machine" }), element("th", { textContent: "settings" }),
      ...columns.map((name) => element("th", { className: "number", textContent: name.replaceAll("_", " ") })), element("th"));
    const made = rows.map(([name, settings], i) => {
      const answer = explore.server.known(settings);
      const cells = columns.map((figure) => element("td", { className: "number", textContent: shown(figure, answer?.figures?.[figure]) }));
      const buttons = element("td");
      if (i > 1) {
        for (const [text, act] of [
          ["Show", () => explore.state.change({ settings: { ...settings } })],
          ["Remove", () => explore.state.change({ pins: state.pins.filter((_, at) => at !== i - 2) })],
        ]) {
          const button = element("button", { type: "button", textContent: text });
          button.setAttribute("aria-label", `${text} ${name}`);
          button.addEventListener("click", act);
          buttons.append(button);
        }
      }
      const said = Object.entries(settings).sort().map(([key, value]) => `${key} = ${value}`).join(", ");
      return element("tr", {}, element("td", { textContent: name }), element("td", { textContent: answer?.error ?? said }), ...cells, buttons);
    });
    at("pins").replaceChildren(element("thead", {}, head), element("tbody", {}, ...made));
  }

  return {
    axis_of,
    values_of,
    make(keys) {
      units = keys.units;
      for (const key of keys.controls) {
        if (!key.list && key.type !== "text") {
          at("axis").append(element("option", { value: key.name, textContent: key.name }));
        }
      }
      for (const figure of figures) at("figure").append(element("option", { value: figure, textContent: figure.replaceAll("_", " ") }));
      at("axis").addEventListener("change", () => explore.state.change({ axis: at("axis").value, values: "" }));
      at("figure").addEventListener("change", () => explore.state.change({ figure: at("figure").value }));
      at("values").addEventListener("change", () => explore.state.change({ values: at("values").value }));
    },
    /** Shows what is known of the curve and of the pinned machines. */
    show(state) {
      at("axis").value = axis_of(state);
      at("figure").value = state.figure || "end";
      if (document.activeElement !== at("values")) at("values").value = values_of(state).join(", ");
      if (chart) draw(state);
      pins(state);
    },
    /** The machines that are shown and may still be to be simulated. */
    wanted: (state) => [{}, ...state.pins, ...values_of(state).map((value) => point(state, value))],
  };
})();
