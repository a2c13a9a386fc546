// The explorer's controls: a slider or a list for each axis, the axis that charts run along, what colours show, the
// figure of one chart, and the budget.
"use strict";

/** A price that a machine may have; null for a text that is none. */
marti.budgetOf = (text) => (text && Number(text) >= 0 && Number.isFinite(Number(text)) ? Number(text) : null);

marti.controls = (explorer, { moved, turned, coloured, figured, budgeted }) => {
  const { axes } = explorer;
  const place = document.getElementById("controls");

  function labelled(input, id, ...texts) {
    const label = document.createElement("label");
    input.id = id;
    label.htmlFor = id;
    label.append(...texts, input);
    place.append(label);
    return input;
  }

  const controls = axes.map((axis, a) => {
    const input = document.createElement(axis.numeric ? "input" : "select");
    const output = document.createElement("output");
    input.dataset.axis = axis.name;
    labelled(input, `axis-${a}`, `${[axis.name, ...axis.followers].join(", ")} `, output);
    if (axis.numeric) Object.assign(input, { type: "range", min: 0, max: axis.values.length - 1, step: 1 });
    else input.append(...axis.texts.map((text, i) => new Option(text, i)));
    input.addEventListener("input", () => moved(a, Number(input.value)));
    return { input, output };
  });

  const names = () => axes.map((axis, a) => new Option(axis.name, a));
  const along = labelled(document.createElement("select"), "along", "Charts along ");
  along.append(...names());
  along.addEventListener("change", () => turned(Number(along.value)));
  const colour = labelled(document.createElement("select"), "colour", "Colours show ");
  colour.append(new Option("nothing", ""), ...names());
  colour.addEventListener("change", () => coloured(colour.value === "" ? null : Number(colour.value)));
  const figure = labelled(document.createElement("select"), "figure", "Chart of ");
  figure.append(...explorer.fields.map(({ name, title }) => new Option(title, name)));
  figure.addEventListener("change", () => figured(figure.value));
  const budget = labelled(document.createElement("input"), "budget", `Budget (${explorer.price}) `);
  Object.assign(budget, { type: "number", min: 0, step: "any" });
  budget.addEventListener("input", () => budgeted(marti.budgetOf(budget.value)));

  /** Shows the choices. */
  function show(state) {
    controls.forEach(({ input, output }, a) => {
      const text = axes[a].texts[state.place[a]];
      if (axes[a].numeric) {
        output.textContent = text + (a === state.axis ? " (along the charts)" : "");
        input.setAttribute("aria-valuetext", text);
      }
      input.value = state.place[a];
    });
    along.value = state.axis;
    colour.value = state.colour ?? "";
    figure.value = state.figure;
    if (Number(budget.value) !== state.budget) budget.value = state.budget ?? "";
  }

  return { show };
};
