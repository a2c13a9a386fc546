// Tables that a click on a heading sorts by that column; a second one turns the order round.
"use strict";

marti.sorting = (() => {
  /** Compares two keys: numbers before texts, what has neither (null) last, whichever the direction. */
  function compare(x, y, direction) {
    const kinds = [x, y].map((key) => (key === null ? 2 : typeof key === "number" ? 0 : 1));
    if (kinds[0] !== kinds[1]) return kinds[0] - kinds[1];
    return direction * (x < y ? -1 : x > y ? 1 : 0);
  }

  /** The items in the order of their keys; equal ones keep their order. */
  function sorted(items, keyOf, direction) {
    const keyed = items.map((item) => [keyOf(item), item]);
    return keyed.sort(([x], [y]) => compare(x, y, direction)).map(([, item]) => item);
  }

  /** Has a heading's click, or Enter, ask for its column's order. */
  function listen(heading, ask) {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...heading.childNodes);
    button.addEventListener("click", () => ask(heading.getAttribute("aria-sort") === "ascending" ? -1 : 1));
    heading.append(button);
  }

  /** Shows by which heading the table is sorted. */
  function mark(heading, direction) {
    for (const other of heading.parentElement.cells) other.removeAttribute("aria-sort");
    heading.setAttribute("aria-sort", direction > 0 ? "ascending" : "descending");
  }

  function keyOf(row, column) {
    const { dataset, textContent } = row.cells[column];
    const number = Number(dataset.number ?? NaN);
    return !Number.isNaN(number) ? number : textContent === "" ? null : textContent;
  }

  /** Has the headings of all tables below the element sort them. */
  function ready(element) {
    for (const heading of element.querySelectorAll("table[data-sorted] th")) {
      listen(heading, (direction) => {
        const body = heading.closest("table").tBodies[0];
        body.append(...sorted([...body.rows], (row) => keyOf(row, heading.cellIndex), direction));
        mark(heading, direction);
      });
    }
  }
  ready(document);
  return { sorted, listen, mark, ready };
})();
