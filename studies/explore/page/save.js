// The machine as a configuration, and the curve as a sweep: TOML, made here.
"use strict";

explore.save = (() => {
  const { of } = explore.controls;
  const { toml, text_of_value } = explore.values;

  function tables(values) {
    const sections = new Map();
    for (const [key, value] of values) {
      const end = key.lastIndexOf(".");
      const section = key.slice(0, end);
      sections.set(section, [...(sections.get(section) ?? []), `${key.slice(end + 1)} = ${value}`]);
    }
    return [...sections].map(([section, lines]) => `[${section}]\n${lines.join("\n")}\n`).join("\n");
  }

  /** Every key that is given: those of the frame as the configuration has them, those of the machine as it was timed. */
  const given = (keys, answer) => [
    ...Object.entries(keys.given).filter(([key]) => !of(key)),
    ...Object.entries(answer.keys).filter(([key, { given }]) => given && of(key)).map(([name, { value }]) => [name, toml(of(name).key, text_of_value(of(name).key, value))]),
  ];

  const configuration = (keys, answer) => `# From marti explore ${keys.file}\n\n${tables(given(keys, answer))}`;

  const sweep = (keys, answer, state) => {
    const { key } = of(explore.curve.axis_of(state));
    const values = explore.curve.values_of(state).map((value) => toml(key, value));
    return `${configuration(keys, answer)}\n[sweep.axes]\n"${key.name}" = [${values.join(", ")}]\n`;
  };

  const offer = (id, text) => {
    document.getElementById(id).href = `data:text/plain;charset=utf-8,${encodeURIComponent(text)}`;
  };

  return {
    report: (page) => marti.charts.save("explored.html", "text/html", page),
    /** There is no such machine. */
    nothing() {
      for (const id of ["save", "save-sweep"]) document.getElementById(id).removeAttribute("href");
    },
    show(keys, answer, state) {
      offer("save", configuration(keys, answer));
      offer("save-sweep", sweep(keys, answer, state));
    },
  };
})();
