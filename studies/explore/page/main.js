// Ties the parts together: a change of the state asks for the answer, and when that is there for the rest.
"use strict";

(async () => {
  const { server, state, background, controls, answer, curve, save } = explore;
  const keys = await server.keys();
  document.getElementById("what").textContent = `${keys.file}, ${keys.scene}`;
  let asked = 0;

  /** What follows the answer: what helps, then machines that are shown and not known yet. */
  function more(now) {
    const helps = async () => {
      const found = await server.helps(now.settings);
      if (found && !("error" in found)) answer.show_helps(found.helps);
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

  async function update(now) {
    const mine = ++asked;
    background.stop();
    controls.show(now);
    const begun = performance.now();
    const seconds = () => ((performance.now() - begun) / 1000).toFixed(1);
    const progress = setInterval(() => answer.waiting(`simulating for ${seconds()} s; a move takes its place`), 250);
    const before = server.known(now.settings) !== undefined;
    let found = null;
    try {
      while (found === null && mine === asked) found = await server.time(now.settings);
    } catch (error) {
      if (mine === asked) answer.waiting(`no answer: ${error.message}; is marti explore still running?`);
    }
    clearInterval(progress);
    if (!found || mine !== asked) return;
    const took = performance.now() - begun;
    answer.waiting(before ? "exact; simulated before" : `exact; answered in ${Math.round(took)} ms`);
    answer.show(found, server.known({})?.figures);
    answer.show_helps(null);
    controls.judge(found);
    if (!("error" in found)) {
      save.show(keys, found, now);
      curve.show(now);
      more(now);
    }
    explore.answered = { settings: now.settings, took, answer: found };  // read by tests
  }

  controls.make(keys);
  curve.make(keys);
  state.follow(update);
  document.getElementById("pin").addEventListener("click", () => {
    const { pins, settings } = state.now;
    if (!pins.some((pin) => state.text(pin) === state.text(settings))) state.change({ pins: [...pins, settings] });
  });
  document.getElementById("reset").addEventListener("click", () => state.change({ settings: {} }));
  document.getElementById("end").addEventListener("click", async () => {
    background.stop();
    await server.end();
    answer.waiting("marti explore has ended; this page shows its last answer");
  });
  await server.time({});
  update(state.now);
})();
