// The chosen point with its exact figures, at the foot of the window while the rest of the page moves.
"use strict";

marti.chosenPoint = (explorer) => {
  const box = document.createElement("details");
  const summary = document.createElement("summary");
  const list = document.createElement("dl");
  box.id = "chosen";
  box.append(summary, list);
  document.querySelector("main").append(box);

  // All digits that the page has; times 100 a share would get some of rounding.
  const shown = (field, i) => marti.number(explorer.columns[field.name][i], field, field.percent ? 12 : 17);

  function entry(name, text, meaning = "") {
    const what = document.createElement("dt");
    const value = document.createElement("dd");
    what.textContent = name;
    what.title = meaning;
    value.textContent = text;
    const pair = document.createElement("div");
    pair.append(what, value);
    return pair;
  }

  /** `i` is undefined where no point was timed: then there is nothing to show. */
  return (i, budget) => {
    box.hidden = i === undefined;
    if (box.hidden) return;
    const known = marti.rows.roles(explorer, budget).filter(([, p]) => p === i).map(([role]) => role);
    const fields = explorer.fields.filter(({ name }) => explorer.columns[name][i] !== null);
    const short = fields.filter(({ main }) => main).slice(0, 3).map((field) => `${field.title} ${marti.number(explorer.columns[field.name][i], field)}`);
    const called = [`Point ${explorer.ordinal[i]}`, ...known].join(", ");
    summary.textContent = [`${called}: ${marti.rows.machine(explorer, i)}`, ...short].join("; ");
    list.replaceChildren(
      ...explorer.axes.map((axis, a) => entry([axis.name, ...axis.followers].join(", "), axis.texts[explorer.place[a][i]])),
      ...fields.map((field) => entry(field.title, shown(field, i), field.meaning)),
    );
  };
};
