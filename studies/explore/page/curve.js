// A curve of one figure along one setting, each point simulated, and the table of pinned machines.
"use strict";

explore.curve = (() => {
  const { element, of, scaled } = explore.controls;
  const { drawn, shown } = explore.answer;
  const at = (id) => document.getElementById(id);
  const figures = ["end", "speed_up", "efficiency", "hit_ratio", "interconnect_utilisation", "bank_utilisation"];
  const columns = ["end", "speed_up", "efficiency", "hit_ratio", "interconnect_utilisation"];
  const most_values = 64;

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

  /** Round numbers from 0 to at most `most`, about four steps: 1, 2 or 5 times a power of ten apart. */
  function ticks(most) {
    const exact = most / 4;
    const power = 10 ** Math.floor(Math.log10(exact));
    const step = [1, 2, 5, 10].find((times) => times * power >= exact * (1 - 1e-9)) * power;
    return Array.from({ length: Math.floor(most / step + 1e-9) + 1 }, (_, i) => i * step);
  }

  function draw(state) {
    const axis = axis_of(state);
    const figure = state.figure || "end";
    const values = values_of(state);
    const answers = values.map((value) => explore.server.known(point(state, value)));
    const known = answers.map((answer) => answer?.figures?.[figure]);
    const most = Math.max(1e-300, ...known.filter((value) => value !== undefined));
    const [width, height, left, bottom] = [640, 240, 80, 40];
    const x = (i) => left + (values.length < 2 ? 0 : (i * (width - left - 20)) / (values.length - 1));
    const y = (value) => height - bottom - (value / most) * (height - bottom - 20);
    const chart = drawn("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${figure} along ${axis}` });
    chart.append(
      ...ticks(most).flatMap((value) => [
        drawn("line", { x1: left - 5, y1: y(value), x2: width, y2: y(value) }),
        drawn("text", { x: left - 8, y: y(value) + 4, "text-anchor": "end", class: "tick" }, value ? shown(figure, value) : "0"),
      ]),
      drawn("path", { d: known.map((value, i) => (value === undefined ? "" : `${i && known[i - 1] !== undefined ? "L" : "M"}${x(i)} ${y(value)}`)).join(" ") }),
    );
    values.forEach((value, i) => {
      chart.append(drawn("text", { x: x(i), y: height - 18, "text-anchor": "middle" }, value));
      if (known[i] === undefined) return;
      const here = value === value_of(state.settings, axis);
      const mark = drawn("circle", { cx: x(i), cy: y(known[i]), r: here ? 7 : 5, class: here ? "here" : "", "data-at": value, "data-value": known[i] });
      mark.append(drawn("title", {}, `${axis} ${value}: ${figure} ${shown(figure, known[i])}`));
      mark.addEventListener("click", () => explore.state.set({ [axis]: value === of(axis).own ? null : value }));
      chart.append(mark);
    });
    at("curve").replaceChildren(chart);
    const refused = answers.map((answer, i) => answer && "error" in answer && `${values[i]}: ${answer.error}`).filter(Boolean);
    const missing = answers.filter((answer) => !answer).length;
    at("curve-state").textContent = missing ? `${missing} of ${values.length} machines are still to be simulated` : refused.join("; ");
  }

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
      draw(state);
      pins(state);
    },
    /** The machines that are shown and may still be to be simulated. */
    wanted: (state) => [{}, ...state.pins, ...values_of(state).map((value) => point(state, value))],
  };
})();
