// The answer of a machine: one line, where the time goes, what would help.
"use strict";

explore.answer = (() => {
  const { element, of } = explore.controls;
  const most_steps = 6;
  const svg = "http://www.w3.org/2000/svg";
  const at = (id) => document.getElementById(id);
  let units = {};  // of the figures, by their names

  const percent = (share) => (share === undefined ? "" : `${(100 * share).toFixed(1)} %`);
  const time = (picoseconds) => {
    const [unit, size] = [["s", 1e12], ["ms", 1e9], ["us", 1e6], ["ns", 1e3]].find(([, size]) => picoseconds >= size) ?? ["ps", 1];
    return `${(picoseconds / size).toFixed(unit === "ps" ? 0 : 3)} ${unit}`;
  };
  const drawn = (name, attributes, text = "") => {
    const made = document.createElementNS(svg, name);
    for (const [attribute, value] of Object.entries(attributes)) made.setAttribute(attribute, value);
    made.textContent = text;
    return made;
  };

  /** A figure of the catalogue as people read it, by its unit. */
  function shown(name, value) {
    if (value === undefined || value === null) return "";
    if (units[name] === "ps") return time(value);
    if (units[name] === "fraction") return percent(value);
    return Number.isInteger(value) ? value.toLocaleString("en") : value.toPrecision(4);
  }

  /** Bars of the figures whose names begin with `prefix`; those of 0 are left out. */
  // The share "idle" has the time of all nodes that wait for the last one; this loss is another figure.
  const named = (name, prefix) => (name === "lost_idle" ? "no work at all" : name.slice(prefix.length).replaceAll("_", " "));

  function bars(id, figures, prefix, whole) {
    const rows = Object.entries(figures).filter(([name, value]) => name.startsWith(prefix) && Math.abs(value) > 1e-12);
    rows.sort(([, a], [, b]) => b - a);
    const height = 22;
    const chart = drawn("svg", { class: "bar", viewBox: `0 0 480 ${Math.max(1, rows.length) * height}`, role: "img" });
    chart.setAttribute("aria-label", rows.map(([name, value]) => `${name} ${shown(name, value)}`).join(", ") || "nothing");
    rows.forEach(([name, value], i) => {
      const width = Math.max(1, Math.min(1, Math.abs(value) / whole) * 240);
      chart.append(
        drawn("text", { x: 0, y: i * height + 15 }, named(name, prefix)),
        drawn("rect", { x: 150, y: i * height + 3, width, height: height - 6, "data-figure": name, "data-value": value }),
        drawn("text", { x: 156 + width, y: i * height + 15 }, shown(name, value)),
      );
    });
    at(id).replaceChildren(chart);
  }

  function line(figures, base) {
    const change = base ? figures.end / base.end - 1 : 0;
    const parts = [
      `frame ${time(figures.end)}`,
      Math.abs(change) > 1e-9 ? `(${change < 0 ? "" : "+"}${(100 * change).toFixed(1)} % against the configuration)` : "",
      `on ${figures.nodes} node${figures.nodes === 1 ? "" : "s"}:`,
      [
        figures.speed_up === undefined ? "" : `speed-up ${figures.speed_up.toFixed(2)}`,
        figures.efficiency === undefined ? "" : `efficiency ${percent(figures.efficiency)}`,
        figures.hit_ratio === undefined ? "" : `${percent(figures.hit_ratio)} of references hit`,
        figures.interconnect_utilisation === undefined ? "" : `interconnect ${percent(figures.interconnect_utilisation)} busy`,
      ].filter(Boolean).join(", "),
    ];
    return parts.filter(Boolean).join(" ");
  }

  function show_helps(helps) {
    at("helps").textContent = helps?.sentence ?? "";
    const worth = (helps?.resources ?? []).filter(({ step }) => step?.saved > 0).slice(0, most_steps);
    at("steps").replaceChildren(
      ...worth.map(({ step }) => {
        const written = (name, value) => explore.values.text_of_value(of(name).key, value);
        const keys = Object.entries(step.keys).map(([name, { from, to }]) => [name, written(name, from), written(name, to)]);
        const text = keys.map(([name, from, to]) => `${name} ${from} → ${to}`).join(", ");
        const button = element("button", { type: "button", textContent: "Try" });
        button.setAttribute("aria-label", `Try ${text}`);
        button.addEventListener("click", () => explore.state.set(Object.fromEntries(keys.map(([name, , to]) => [name, to]))));
        return element("li", {}, `${text}: frame ${percent(step.saved)} shorter `, button);
      }),
    );
  }

  return {
    drawn,
    shown,
    show_helps,
    make: (keys) => (units = keys.units),
    /** `base`: figures of the configuration itself. */
    show(answer, base) {
      for (const id of ["answer", "shares", "lost"]) at(id).classList.toggle("old", "error" in answer);
      if ("error" in answer) {
        at("state").textContent = `This machine cannot be: ${answer.error}`;
        return;
      }
      at("answer").textContent = line(answer.figures, base);
      const lost = Object.entries(answer.figures).filter(([name]) => name.startsWith("lost_"));
      bars("shares", answer.figures, "share_", 1);
      bars("lost", answer.figures, "lost_", Math.max(1e-9, ...lost.map(([, value]) => Math.abs(value))));
    },
    /** A frame time by the model, shown until the exact answer is there; what else is shown is of the machine before. */
    modelled({ end, end_of_one, packets, of_packets }) {
      at("answer").textContent = `frame about ${time(end)}, speed-up about ${(end_of_one / end).toPrecision(2)}: modelled, from ${packets} of ${of_packets} packets`;
      for (const id of ["answer", "shares", "lost"]) at(id).classList.add("old");
      show_helps(null);
    },
    waiting: (text) => (at("state").textContent = text),
  };
})();
