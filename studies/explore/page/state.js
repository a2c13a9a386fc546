// What the page shows, kept in its address: settings under their keys, pinned machines, the curve.
"use strict";
globalThis.explore = {};

explore.state = (() => {
  const listeners = [];
  let now = parse(location.hash);

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

  function write() {
    const parameters = new URLSearchParams(text(now.settings));
    for (const pin of now.pins) parameters.append("pin", text(pin));
    for (const name of ["axis", "values", "figure"]) if (now[name]) parameters.set(name, now[name]);
    history.replaceState(null, "", `#${parameters}`);
  }

  const tell = (shared) => listeners.forEach((listener) => listener(now, shared));

  addEventListener("hashchange", () => {
    now = parse(location.hash);
    tell(true);
  });

  return {
    get now() {
      return now;
    },
    text,
    /** Replaces parts of the state; `changes` has some of its fields. */
    change(changes) {
      now = { ...now, ...changes };
      write();
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
