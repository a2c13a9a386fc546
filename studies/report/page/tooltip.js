// What a mark says when it is pointed at, beside the pointer.
"use strict";

marti.tooltip = (() => {
  const box = document.createElement("div");
  box.id = "tooltip";
  box.setAttribute("role", "tooltip");
  box.hidden = true;
  document.body.append(box);

  // A line is one mark of many rows, and would say the figures of its first: its points speak for it.
  const ofManyRows = new Set(["line", "area", "trail"]);

  function line(name, text) {
    const row = document.createElement("div");
    const what = document.createElement("span");
    what.textContent = name;
    row.append(what, String(text));
    return row;
  }

  function place({ clientX, clientY }) {
    const gap = 12;
    const { width, height } = box.getBoundingClientRect();
    const left = clientX + gap + width > window.innerWidth ? clientX - gap - width : clientX + gap;
    const top = clientY + gap + height > window.innerHeight ? clientY - gap - height : clientY + gap;
    box.style.left = `${Math.max(0, left)}px`;
    box.style.top = `${Math.max(0, top)}px`;
  }

  /** A handler of Vega's. */
  return (_, event, item, value) => {
    box.hidden = value === null || value === undefined || value === "" || ofManyRows.has(item?.mark?.marktype);
    if (box.hidden) return;
    const entries = typeof value === "object" ? Object.entries(value) : [["", value]];
    box.replaceChildren(...entries.map(([name, text]) => line(name, text)));
    place(event);
  };
})();
