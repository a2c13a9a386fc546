// The answer of a machine: the sentences, charts and tables that its report has, and what would help.
"use strict";

explore.answer = (() => {
  const { element, of } = explore.controls;
  const most_steps = 6;
  const at = (id) => document.getElementById(id);
  let units = {};  // of the figures, by their names

  const percent = (share) => (share === undefined ? "" : `${(100 * share).toFixed(1)} %`);
  const time = (picoseconds) => {
    const [unit, size] = [["s", 1e12], ["ms", 1e9], ["us", 1e6], ["ns", 1e3]].find(([, size]) => picoseconds >= size) ?? ["ps", 1];
    return `${(picoseconds / size).toFixed(unit === "ps" ? 0 : 3)} ${unit}`;
  };

  /** A figure of the catalogue as people read it, by its unit. */
  function shown(name, value) {
    if (value === undefined || value === null) return "";
    if (units[name] === "ps") return time(value);
    if (units[name] === "fraction") return percent(value);
    return Number.isInteger(value) ? value.toLocaleString("en") : value.toPrecision(4);
  }

  function say(sentences, old) {
    at("sentences").replaceChildren(...sentences.map((textContent) => element("li", { textContent })));
    document.documentElement.classList.toggle("old", old);
  }

  /** How the frame time differs from that of the configuration. */
  function change(figures, base) {
    const gain = base?.end ? figures.end / base.end - 1 : 0;
    return Math.abs(gain) > 1e-9 ? [`That is ${percent(Math.abs(gain))} ${gain < 0 ? "less" : "more"} than with the configuration as it is.`] : [];
  }

  function show_helps(helps) {
    const worth = (helps?.resources ?? []).filter(({ step }) => step?.saved > 0).slice(0, most_steps);
    at("steps").replaceChildren(
      ...worth.map(({ step }) => {
        const written = (name, value) => explore.values.text_of_value(of(name).key, value);
        const keys = Object.entries(step.keys).map(([name, { from, to }]) => [name, written(name, from), written(name, to)]);
        const text = keys.map(([name, from, to]) => `${name} ${from} → ${to}`).join(", ");
        const button = element("button", { type: "button", textContent: "Try" });
        button.setAttribute("aria-label", `Try ${text}`);
        button.addEventListener("click", () => explore.state.set(Object.fromEntries(keys.map(([name, , to]) => [name, to]))));
        const noise = step.within_noise ? ", no more than another order of packets may save" : "";
        return element("li", {}, `${text}: frame ${percent(step.saved)} shorter${noise} `, button);
      }),
    );
  }

  /** A part of the page that has other content now; what was open in it stays open. */
  function replace(id, html) {
    const part = at(id);
    const title = (details) => details.querySelector("summary").textContent.split(" (")[0];
    const open = [...part.querySelectorAll("details[open]")].map(title);
    part.innerHTML = html;
    for (const details of part.querySelectorAll("details")) details.open ||= open.includes(title(details));
    marti.sorting.ready(part);
  }

  return {
    shown,
    make: (keys) => (units = keys.units),
    /** `base`: figures of the configuration itself. */
    show({ figures, helps, page }, base) {
      const [first, ...others] = page.answer;
      say([first, ...change(figures, base), ...others], false);
      show_helps(helps);
      document.querySelector(".about").textContent = page.about;
      marti.charts.data.about = page.about;
      replace("machine-tables", page.sections.tables);
      replace("machine-source", page.sections.provenance);
      if (page.charts.length) marti.charts.show(at("machine-charts"), page.charts, page.sections.charts);
    },
    /** Says why there is no such machine; the page keeps showing the one before. */
    refuse(error) {
      at("state").textContent = `This machine cannot be: ${error}`;
      if (!at("sentences").children.length) {
        // The page began with it.
        document.querySelector(".about").textContent = "there is no machine with the settings of this address";
      }
      show_helps(null);
      document.documentElement.classList.add("old");
    },
    /** A frame time by the model, shown until the exact answer is there; what else is shown is of the machine before. */
    modelled({ end, end_of_one, packets, of_packets }) {
      say([`A frame takes about ${time(end)}, speed-up about ${(end_of_one / end).toPrecision(2)}: modelled, from ${packets} of ${of_packets} packets.`], true);
      show_helps(null);
    },
    waiting: (text) => (at("state").textContent = text),
  };
})();
