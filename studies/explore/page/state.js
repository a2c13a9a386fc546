// What the page shows, kept in its address: settings under their keys, pinned machines, the curve. The browser's
// Back undoes a change.
"use strict";
globalThis.explore = {};

explore.state = (() => {
  const listeners = [];
  let now = parse(location.hash);
  const one_move = 400;  // ms: changes of the same thing within this time, such as a slider's, are undone together
  let written = { what: "", when: -Infinity };

  function parse(hash) {
    const state = { settings: {}, pins: [], axis: "", values: "", figure: "" };
    for (const [name, value] of new URLSearchParams(hash.replace(/^#/, ""))) {
      if (name.includes(".")) state.settings[name] = value;
      else if (name === "pin") state.pins.push(Object.fromEntries(new URLSearchParams(value)));
      else if (["axis", "values", "figure"].includes(name)) state[name] = value;
    }
    return state;
  }

  /** One text for equal settings. */
  const text = (settings) => new URLSearchParams(Object.entries(settings).sort(([a], [b]) => (a < b ? -1 : 1))).toString();

  /** What differs: names of settings and of other parts. */
  const changed = (a, b) =>
    [
      ...Object.keys({ ...a.settings, ...b.settings }).filter((key) => a.settings[key] !== b.settings[key]),
      ...Object.keys(b).filter((part) => part !== "settings" && a[part] !== b[part]),
    ].join();

  function write(before) {
    const parameters = new URLSearchParams(text(now.settings));
    for (const pin of now.pins) parameters.append("pin", text(pin));
    for (const name of ["axis", "values", "figure"]) if (now[name]) parameters.set(name, now[name]);
    const address = `#${parameters}`;
    if (address === (location.hash || "#")) return;
    const what = changed(before, now);
    const when = performance.now();
    const goes_on = what === "" || (what === written.what && when - written.when < one_move);
    history[goes_on ? "replaceState" : "pushState"](null, "", address);
    written = { what, when };
  }

  const tell = (shared) => listeners.forEach((listener) => listener(now, shared));

  addEventListener("hashchange", () => {
    if (location.hash && !location.hash.includes("=")) return; // a part of the page
    now = parse(location.hash);
    written = { what: "", when: -Infinity };
    tell(true);
  });

  return {
    get now() {
      return now;
    },
    text,
    /** Replaces parts of the state; `changes` has some of its fields. */
    change(changes) {
      const before = now;
      now = { ...now, ...changes };
      write(before);
      tell(false);
    },
    /** The settings with these ones changed; null takes one back. */
    set(settings) {
      const all = { ...now.settings, ...settings };
      for (const key of Object.keys(all)) if (all[key] === null) delete all[key];
      this.change({ settings: all });
    },
    /** `listener(state, whole)`; whole: another address, not a change by this page. */
    follow: (listener) => listeners.push(listener),
  };
})();
