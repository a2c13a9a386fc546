// A click on a heading, or Enter, sorts a table's rows by that column; a second one turns the order round. Rows that
// are equal in it keep their order.
"use strict";

marti.sort = (() => {
  const cell = (row, column) => row.cells[column];
  const number = (row, column) => ("number" in cell(row, column).dataset ? Number(cell(row, column).dataset.number) : NaN);

  /** Numbers by value before texts; what has neither last, whichever the direction. */
  function compare(a, b, column, direction) {
    const [x, y] = [number(a, column), number(b, column)];
    if (!Number.isNaN(x) && !Number.isNaN(y)) return direction * (x - y);
    if (Number.isNaN(x) !== Number.isNaN(y)) return Number.isNaN(x) ? 1 : -1;
    const [s, t] = [cell(a, column).textContent, cell(b, column).textContent];
    return direction * (s < t ? -1 : s > t ? 1 : 0);
  }

  function sort(heading) {
    const table = heading.closest("table");
    const direction = heading.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    for (const other of heading.parentElement.cells) other.removeAttribute("aria-sort");
    heading.setAttribute("aria-sort", direction > 0 ? "ascending" : "descending");
    const rows = [...table.tBodies[0].rows];
    rows.sort((a, b) => compare(a, b, heading.cellIndex, direction));
    table.tBodies[0].append(...rows);
  }

  for (const heading of document.querySelectorAll("table[data-sorted] th")) {
    heading.tabIndex = 0;
    heading.addEventListener("click", () => sort(heading));
    heading.addEventListener("keydown", (event) => {
      if (event.key === "Enter") sort(heading);
    });
  }
  return sort;
})();
