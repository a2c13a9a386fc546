// Ties the parts together: a change of the state asks for the answer, and when that is there for the rest.
"use strict";

(async () => {
  const { server, state, background, controls, answer, curve, save } = explore;
  const keys = await server.keys();
  const patience = 150;  // ms
  const model_after = 80;  // ms, so that there is a figure within the patience
  const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));
  let asked = 0;
  let ended = false;
  let running = null;  // the answer that is waited for: since when, and its end

  /** What follows the answer: what helps, then machines that are shown and not known yet. */
  function more(now) {
    const helps = async () => {
      const found = await server.helps(now.settings);
      const still = state.text(now.settings) === state.text(state.now.settings);
      if (found?.page && still) answer.show(found, server.known({})?.figures);
      return found;
    };
    const one = (settings) => async () => {
      if (server.known(settings)) return true;
      const found = await server.time(settings, true);
      if (found) curve.show(state.now);
      return found;
    };
    background.run([helps, ...curve.wanted(now).map(one)]);
  }

  /** Of an answer that takes long: shows what the model says meanwhile, and how far marti is; returns what ends that. */
  function wait_aloud(settings) {
    const begun = performance.now();
    let waiting = true;
    async function say() {
      const { part, unit, done, of } = await server.progress().catch(() => ({}));
      if (!waiting) return;
      const what = part ? `: ${part}${of ? `, ${Math.min(done, of)} of ${of} ${unit}` : ""}` : "";
      answer.waiting(`simulating for ${((performance.now() - begun) / 1000).toFixed(1)} s${what}; a move takes its place`);
    }
    const model = setTimeout(async () => {
      const found = await server.model(settings).catch(() => null);
      if (waiting && found?.end) answer.modelled(found);
    }, model_after);
    const saying = setInterval(say, 250);
    return () => {
      waiting = false;
      clearTimeout(model);
      clearInterval(saying);
    };
  }

  async function update(now) {
    if (ended) return;
    const mine = ++asked;
    background.stop();
    controls.show(now);
    // A move leaves the answer before it some time, so that answers are shown while a control moves.
    if (running) await Promise.race([running.done, pause(running.begun + patience - performance.now())]);
    if (mine !== asked) return;
    const begun = performance.now();
    let finished;
    const run = (running = { begun, done: new Promise((done) => (finished = done)) });
    const stop_waiting = wait_aloud(now.settings);
    const before = server.known(now.settings) !== undefined;
    let found = null;
    try {
      while (found === null && mine === asked) found = await server.time(now.settings);
    } catch (error) {
      if (mine === asked) answer.waiting(`no answer: ${error.message}; is marti explore still running?`);
    }
    stop_waiting();
    if (running === run) running = null;
    finished();
    if (!found) return;
    const took = performance.now() - begun;
    answer.waiting(before ? "exact; simulated before" : `exact; answered in ${Math.round(took)} ms`);
    if ("error" in found) {
      answer.refuse(found.error);
      save.nothing();
    } else answer.show(found, server.known({})?.figures);
    controls.judge(found);
    explore.answered = { settings: now.settings, took, answer: found };  // read by tests
    if (mine === asked && !("error" in found)) {
      save.show(keys, found, now);
      curve.show(now);
      more(now);
    }
  }

  answer.make(keys);
  controls.make(keys);
  curve.make(keys);
  state.follow(update);
  document.getElementById("pin").addEventListener("click", () => {
    const { pins, settings } = state.now;
    if (!server.known(settings)?.figures) return;  // there is no such machine, or none yet
    if (!pins.some((pin) => state.text(pin) === state.text(settings))) state.change({ pins: [...pins, settings] });
  });
  document.getElementById("reset").addEventListener("click", () => state.change({ settings: {} }));
  document.getElementById("save-report").addEventListener("click", async () => {
    const { settings } = state.now;
    answer.waiting("making the report");
    try {
      let page = null;
      while (page === null) page = await server.report(settings);
      save.report(page);
      answer.waiting("the report has all machines that were simulated");
    } catch (error) {
      answer.waiting(`no report: ${error.message}`);
    }
  });
  document.getElementById("end").addEventListener("click", async () => {
    ended = true;
    background.stop();
    await server.end();
    for (const control of document.querySelectorAll("#settings :is(button, input, select), #axes :is(input, select), #steps button")) control.disabled = true;
    answer.waiting("marti explore has ended; this page shows its last answer");
  });
  controls.show(state.now);
  const told = wait_aloud({});
  await server.time({}).catch(() => null);  // update() says what is wrong
  told();
  update(state.now);
})();
