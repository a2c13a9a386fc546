// The table of all points of a sweep: sorted by a click on a heading, filtered, a page at a time.
"use strict";

marti.table = (explorer, { choose, changed }) => {
  const onAPage = 25;
  const element = (id) => document.getElementById(id);
  const table = element("points-table");
  const filter = element("filter");
  const state = { sort: "", filter: "" }; // sort: a column's name, after "-" from the largest
  const lets = explorer.ordinal.map(() => true); // what the filter lets through
  let order = explorer.ordinal.map((_, i) => i);
  let page = 0;
  let chosen;

  function axisColumn(axis, a) {
    const place = explorer.place[a];
    const key = axis.numeric ? (i) => axis.values[place[i]] : (i) => place[i];
    const title = [axis.name, ...axis.followers].join(", ");
    const number = axis.numeric ? key : null;
    return { name: axis.name, title, texts: axis.texts, values: axis.values, place, key, number, text: (i) => axis.texts[place[i]] };
  }

  function figureColumn({ name, title, unit, meaning, percent }) {
    const values = explorer.columns[name];
    const number = (i) => (values[i] === null ? null : percent ? Number((values[i] * 100).toPrecision(15)) : values[i]);
    const shown = percent ? "%" : unit;
    const text = (i) => (values[i] === null ? "" : marti.number(number(i), {}, 6));
    return { name, title, meaning, unit: shown === "1" ? "" : shown, number, key: number, text };
  }

  const ordinal = (i) => explorer.ordinal[i];
  const columns = [
    { name: "ordinal", title: "ordinal", meaning: "its number in the sweep", number: ordinal, key: ordinal, text: (i) => String(ordinal(i)) },
    ...explorer.axes.map(axisColumn),
    ...explorer.fields.filter(({ main }) => main).map(figureColumn),
  ];

  const sortedBy = () => columns.find(({ name }) => name === state.sort.replace(/^-/, "")) ?? columns[0];
  const direction = () => (state.sort.startsWith("-") ? -1 : 1);

  const pages = () => Math.max(1, Math.ceil(order.length / onAPage));

  function turnTo(p) {
    page = Math.min(Math.max(p, 0), pages() - 1);
    showRows();
  }

  function heading({ name, title, meaning, unit, number }) {
    const cell = document.createElement("th");
    cell.scope = "col";
    if (number) cell.className = "number";
    cell.textContent = unit ? `${title}, ${unit}` : title;
    if (meaning) cell.title = meaning;
    marti.sorting.listen(cell, (wanted) => {
      set({ ...state, sort: wanted < 0 ? `-${name}` : name });
      changed();
    });
    cell.dataset.column = name;
    return cell;
  }

  function row(i) {
    const line = document.createElement("tr");
    line.dataset.point = explorer.ordinal[i];
    if (i === chosen) line.setAttribute("aria-current", "true");
    columns.forEach((column, c) => {
      const cell = line.insertCell();
      if (column.number) cell.className = "number";
      if (c > 0) return cell.append(column.text(i));
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = column.text(i);
      button.setAttribute("aria-label", `Choose point ${column.text(i)}`);
      return cell.append(button);
    });
    line.addEventListener("click", () => choose(i));
    return line;
  }

  function showRows() {
    const from = page * onAPage;
    const shown = order.slice(from, from + onAPage);
    table.tBodies[0].replaceChildren(...shown.map(row));
    const all = explorer.ordinal.length;
    const few = order.length < all ? ` of ${order.length} that the filter lets through` : "";
    element("points-shown").textContent =
      order.length === 0 ? `none of ${all} points` : `${from + 1} to ${from + shown.length}${few} of ${all} points`;
    element("points-before").disabled = page === 0;
    element("points-after").disabled = page === pages() - 1;
  }

  function arrange() {
    const fault = element("filter-fault");
    fault.textContent = "";
    let test = () => true;
    try {
      test = marti.filter(state.filter, columns);
    } catch (error) {
      fault.textContent = `${error.message}; all points are shown`;
    }
    explorer.ordinal.forEach((_, i) => (lets[i] = test(i)));
    const points = explorer.ordinal.map((_, i) => i).filter((i) => lets[i]);
    order = marti.sorting.sorted(points, sortedBy().key, direction());
    marti.sorting.mark(table.tHead.rows[0].cells[columns.indexOf(sortedBy())], direction());
  }

  /** Another order or filter: from the first page on. */
  function set({ sort = "", filter: text = "" }) {
    state.sort = columns.some(({ name }) => name === sort.replace(/^-/, "")) && sort !== "ordinal" ? sort : "";
    state.filter = text;
    if (filter.value !== text) filter.value = text;
    arrange();
    turnTo(0);
  }

  /** Shows which point is chosen, on the page that has it. */
  function mark(i) {
    if (i === chosen) return;
    chosen = i;
    const at = order.indexOf(i);
    turnTo(at < 0 ? page : Math.floor(at / onAPage));
  }

  /** All axes and figures of the points, in the table's order. */
  function rows() {
    const measure = ({ name, unit }) => (unit === "1" ? name : `${name}_${unit}`);
    return order.map((i) => ({
      ordinal: explorer.ordinal[i],
      ...Object.fromEntries(explorer.axes.map((axis, a) => [axis.name, axis.texts[explorer.place[a][i]]])),
      ...Object.fromEntries(explorer.fields.map((field) => [measure(field), explorer.columns[field.name][i]])),
    }));
  }

  table.createTHead().insertRow().append(...columns.map(heading));
  table.createTBody();
  filter.addEventListener("input", () => {
    set({ ...state, filter: filter.value });
    changed();
  });
  element("points-before").addEventListener("click", () => turnTo(page - 1));
  element("points-after").addEventListener("click", () => turnTo(page + 1));
  element("save-points").addEventListener("click", (event) => {
    event.preventDefault();
    marti.charts.save("machines.csv", "text/csv", marti.charts.csv(rows()));
  });
  set(state);
  return { state, lets, set, mark };
};
