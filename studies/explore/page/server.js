// Asks marti: for the keys, for the answer of a machine, and in the background for more.
"use strict";

explore.server = (() => {
  const kept = new Map();  // answers by kind and settings
  const most_kept = 2000;
  const most_pages = 64;  // that are kept with all that the page shows of a machine

  async function answer_to(path, content) {
    const response = await fetch(path, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(content),
    });
    if (response.status === 204) return null;
    if (!response.ok && response.status !== 500) throw new Error(`marti answered ${response.status}`);
    return response;
  }
  const post = async (path, content) => (await answer_to(path, content))?.json() ?? null;

  /** What the page uses of an answer. */
  const part_of = ({ result, page, ...refused }) =>
    result ? { figures: result.figures.machine, keys: result.config.keys, helps: result.machine.what_helps, page } : refused;

  function keep(name, answer) {
    if (kept.size >= most_kept) kept.delete(kept.keys().next().value);
    kept.delete(name);
    kept.set(name, answer);
    const pages = [...kept.values()].filter(({ page }) => page);
    if (pages.length > most_pages) pages[0].page = null;
  }

  /** The answer for these settings; null when a newer request has taken its place. */
  async function ask(path, settings, background) {
    const name = `${path}?${explore.state.text(settings)}`;
    if (!kept.has(name) || (!background && kept.get(name).page === null)) {
      const result = await post(path, { settings, background });
      if (result === null) return null;
      keep(name, part_of(result));
    }
    return kept.get(name);
  }

  return {
    keys: async () => (await fetch("keys")).json(),
    time: (settings, background = false) => ask("time", settings, background),
    helps: (settings) => ask("helps", settings, true),
    /** The frame time by a model, while the exact one is simulated; null where there is no model. */
    model: (settings) => post("model", { settings }),
    known: (settings) => kept.get(`time?${explore.state.text(settings)}`),
    /** How far the simulation is that is under way. */
    progress: async () => (await fetch("progress")).json(),
    /** The page of a report as text; null when a newer request has taken its place. */
    async report(settings) {
      const response = await answer_to("report", { settings });
      if (!response) return null;
      if (response.headers.get("Content-Type").startsWith("text/html")) return response.text();
      throw new Error((await response.json()).error);
    },
    end: () => post("end", {}),
  };
})();

/** Work for when nobody waits for an answer. */
explore.background = (() => {
  let generation = 0;
  const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

  return {
    stop: () => void ++generation,
    /** Runs each task, which gives null when it is to be tried again, until stop() or the next call. */
    async run(tasks) {
      const mine = ++generation;
      await pause(60);
      for (const task of tasks) {
        while (mine === generation && (await task()) === null) await pause(200);
        if (mine !== generation) return;
      }
    },
  };
})();
