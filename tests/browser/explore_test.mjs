// The page of `marti explore` in a browser: it shows the figures of `marti run`, its address brings it back, and no
// other page can read or steer it.
import assert from "node:assert/strict";
import { execFile, spawn } from "node:child_process";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";
import { promisify } from "node:util";
import { startBrowser } from "./browser.mjs";
import { chartNames, download, onPaper, overflow, rowsOf, unnamed } from "./inspect.mjs";

const program = process.env.MARTI_PROGRAM;
const work = join(process.env.MARTI_WORK, "explored");
rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });
const config = join(work, "explored.toml");
writeFileSync(config, '[scene]\nsource = "tetra:4"\n[image]\nwidth = 48\nheight = 40\n[machine]\nnodes = 4\n[cache]\nsize = "1 KiB"\n');

const run = async (file, settings, helps = "--no-what-helps") => {
  const set = Object.entries(settings).flatMap(([key, value]) => ["--set", `${key}=${value}`]);
  const { stdout } = await promisify(execFile)(program, ["run", file, ...set, "--json", helps], { maxBuffer: 1 << 28 });
  return JSON.parse(stdout);
};

/** The program serving the page, and its address. */
async function explore() {
  const child = spawn(program, ["explore", config, "--no-browser", "--for", "300"]);
  const address = await new Promise((found) => child.stdout.once("data", (text) => found(String(text).trim())));
  return { child, address, ended: new Promise((done) => child.once("exit", done)) };
}

let browser, served, shared;
before(async () => {
  [browser, served] = await Promise.all([startBrowser(), explore()]);
  shared = await open();
  await answer_of(shared.page, {});
});
after(async () => {
  served?.child.kill();
  await browser?.close();
});

const screen = { width: 1400, height: 900 };

/** The page with its answer; its faults are collected. */
async function open(hash = "", address = served.address) {
  const context = await browser.newContext({ viewport: screen });
  const page = await context.newPage();
  const faults = [];
  page.on("pageerror", (error) => faults.push(error.stack));
  page.on("console", (message) => {
    if (message.type() === "error") faults.push(message.text());
  });
  page.on("request", (request) => {
    if (!request.url().startsWith(address) && !/^(data|blob):/.test(request.url())) faults.push(request.url());
  });
  await page.goto(address + hash);
  return { page, faults, close: () => context.close() };
}

/** Waits for the answer of exactly these settings. */
const answer_of = async (page, settings) => {
  const text = JSON.stringify(Object.entries(settings).sort());
  await page.waitForFunction(
    (text) => globalThis.explore?.answered && JSON.stringify(Object.entries(explore.answered.settings).sort()) === text,
    text,
  );
  return page.evaluate(() => explore.answered.answer);
};
/** Hands a page of its own to `use`, and wants it to have done nothing wrong by then. */
const withOwnPage = async (hash, use) => {
  const opened = await open(hash);
  try {
    await use(opened.page);
    assert.deepEqual(opened.faults, []);
  } finally {
    await opened.close();
  }
};
/** The same with a page that tests share, since opening takes long; it has the settings of the configuration. */
const withPage = async (use) => {
  const { page, faults } = shared;
  await page.getByRole("button", { name: "All settings as" }).click();
  await answer_of(page, {});
  await use(page);
  assert.deepEqual(faults, []);
};
const control = (page, key) => page.locator(`[id="control-${key}"]`);

describe("the page of marti explore", () => {
  it("has the figures of marti run for every move", () =>
    withPage(async (page) => {
      let settings = {};
      const same = async () => {
        const shown = await answer_of(page, settings);
        const result = await run(config, settings);
        assert.deepEqual(shown.figures, result.figures.machine);
        await page.waitForFunction((end) => {
          const shown = marti.views.run_cycles?.data("rows").find(({ activity }) => activity === "idle");
          return explore.answered.answer.figures.end === end && shown?.ps === explore.answered.answer.figures.time_idle;
        }, result.figures.machine.end);
        const bars = await rowsOf(page, "run_cycles");
        assert.ok(bars.length > 3);
        for (const { activity, ps } of bars) assert.equal(ps, result.figures.machine[`time_${activity}`], activity);
        assert.match(await page.locator("#sentences").textContent(), new RegExp(`^A frame takes .* on ${result.figures.machine.nodes} node`));
        assert.equal(await page.locator("#machine-tables td").filter({ hasText: /^end$/ }).count(), 1);
      };
      await same();
      await page.getByRole("button", { name: "double machine.nodes" }).click();
      settings = { "machine.nodes": "8" };
      await same();
      await control(page, "interconnect.kind").selectOption("crossbar");
      settings = { ...settings, "interconnect.kind": "crossbar" };
      await same();
      await control(page, "cache.size").fill("1 B");
      settings = { ...settings, "cache.size": "1 B" };
      assert.equal((await answer_of(page, settings)).key, "cache.size");
      await page.getByRole("button", { name: "halve machine.nodes" }).click();
      await control(page, "cache.size").fill("4 KiB");
      settings = { "interconnect.kind": "crossbar", "cache.size": "4 KiB" };
      await same();
      await page.getByRole("button", { name: "All settings as" }).click();
      settings = {};
      await same();
    }));

  it("says beside the control what is wrong with it", () =>
    withPage(async (page) => {
      await control(page, "machine.nodes").fill("0");
      const refused = await answer_of(page, { "machine.nodes": "0" });
      const said = page.locator(".control", { has: control(page, "machine.nodes") }).getByRole("alert");
      assert.equal(await said.textContent(), refused.error);
      assert.equal(await page.locator("#save[href], #save-sweep[href]").count(), 0, "a machine that cannot be is saved");
      await assert.rejects(run(config, { "machine.nodes": "0" }), (error) => error.stderr.trim() === `marti: ${refused.error}`);
      await control(page, "machine.nodes").fill("2");
      await answer_of(page, { "machine.nodes": "2" });
      assert.equal(await said.count(), 0);
    }));

  it("fills in the curve exactly and says what would help", () =>
    withOwnPage("#axis=machine.nodes&values=1,2,5&figure=speed_up", async (page) => {
      const whole = () => marti.views.explored_curve?.data("rows").filter(({ height }) => height !== null).length === 3;
      await page.waitForFunction(whole);
      for (const { value, height } of await rowsOf(page, "explored_curve")) {
        assert.equal(height, (await run(config, { "machine.nodes": value })).figures.machine.speed_up);
      }
      const { machine } = await run(config, {}, "--what-helps");
      await page.waitForFunction((text) => document.getElementById("sentences").textContent.includes(text), machine.what_helps.sentence);
      const best = machine.what_helps.resources.find(({ step }) => step?.saved > 0);
      await page.locator("#steps button").first().click();
      await page.waitForFunction((end) => explore.answered.answer.figures.end === end, best.step.frame_time_ps);
      // The settings of that step, and nothing else, typed as the result has them.
      const typed = await page.evaluate(() => Object.entries(explore.answered.settings).map(([name, text]) => {
        const { key } = explore.controls.of(name);
        return [name, explore.values.is_number(key) ? explore.values.number_of(key, text) : text];
      }));
      assert.deepEqual(Object.fromEntries(typed), Object.fromEntries(Object.entries(best.step.keys).map(([key, { to }]) => [key, to])));
    }));

  it("is the same again by its address", () =>
    withOwnPage("", async (page) => {
      await answer_of(page, {});
      await page.getByRole("button", { name: "double machine.nodes" }).click();
      await answer_of(page, { "machine.nodes": "8" });
      await page.getByRole("button", { name: "Pin this machine" }).click();
      await control(page, "cache.size").fill("2 KiB");
      const settings = { "machine.nodes": "8", "cache.size": "2 KiB" };
      await answer_of(page, settings);
      const rows = () => page.waitForFunction(() => {
        const rows = [...document.querySelectorAll("#pins tbody tr")].map((row) => row.innerText);
        return rows.length === 3 && rows.every((row) => / [mun]?s\b/.test(row)) && rows.join("\n");
      }).then((found) => found.jsonValue());
      const before = await rows();
      await page.reload();
      await answer_of(page, settings);
      assert.equal(await control(page, "cache.size").inputValue(), "2 KiB");
      assert.equal(await rows(), before);
      await page.evaluate(() => (location.hash = "#machine.nodes=2"));
      await answer_of(page, { "machine.nodes": "2" });
    }));

  it("goes back a move, and forth", () =>
    withOwnPage("#cache.size=2 KiB", async (page) => {
      const set = { "cache.size": "2 KiB" };
      await answer_of(page, set);
      await page.getByRole("button", { name: "double machine.nodes" }).click();
      await answer_of(page, { ...set, "machine.nodes": "8" });
      await control(page, "interconnect.kind").selectOption("crossbar");
      await answer_of(page, { ...set, "machine.nodes": "8", "interconnect.kind": "crossbar" });
      // A slide is one move, however many positions it passes.
      await page.evaluate(() => [9, 10, 12].forEach((nodes) => explore.state.set({ "machine.nodes": String(nodes) })));
      await answer_of(page, { ...set, "machine.nodes": "12", "interconnect.kind": "crossbar" });
      for (const settings of [{ "machine.nodes": "8", "interconnect.kind": "crossbar" }, { "machine.nodes": "8" }, {}]) {
        await page.evaluate(() => history.back());
        await answer_of(page, { ...set, ...settings });
        assert.equal(await control(page, "machine.nodes").inputValue(), settings["machine.nodes"] ?? "4");
        assert.equal(await control(page, "interconnect.kind").inputValue(), settings["interconnect.kind"] ?? "bus");
      }
      await page.evaluate(() => history.forward());
      await answer_of(page, { ...set, "machine.nodes": "8" });
    }));

  it("finds settings by what they are called and mean", () =>
    withPage(async (page) => {
      const search = page.getByRole("searchbox", { name: "Search the settings" });
      const state = () => page.$$eval("#settings details", (all) => all.map((one) => [one.id, one.open, one.hidden]));
      const before = await state();
      const found = async (text) => {
        await search.fill(text);
        return page.$$eval(".control", (all) => all.filter((one) => one.checkVisibility()).map((one) => one.querySelector("input, select").id.slice("control-".length)));
      };
      assert.deepEqual(await found("l2.si"), ["l2.size"]);
      assert.ok((await found("CROSSBAR kind")).includes("interconnect.kind"), "choices too");
      assert.match(await page.locator("#found").textContent(), /^\d+ of \d+ settings$/);
      assert.deepEqual(await found("no such setting"), []);
      await search.fill("");
      assert.deepEqual(await state(), before);
      assert.equal(await page.locator("#found").textContent(), "");
    }));

  it("goes where a point of the curve is clicked", () =>
    withOwnPage("#axis=machine.nodes&values=1,2,5&figure=end", async (page) => {
      const marks = page.locator("#chart-explored_curve .mark-symbol.role-mark path");
      await page.waitForFunction(() => document.querySelectorAll("#chart-explored_curve .mark-symbol.role-mark path").length === 3);
      await marks.nth(2).click();
      const { figures } = await answer_of(page, { "machine.nodes": "5" });
      const [row] = (await rowsOf(page, "explored_curve")).filter(({ value }) => value === "5");
      assert.ok(Math.abs(row.height - figures.end * 1e-9) <= 1e-12 * row.height);
    }));

  it("has the charts and tables of the machine's report, sorted and saved as there", () =>
    withOwnPage("#machine.nodes=3", async (page) => {
      await answer_of(page, { "machine.nodes": "3" });
      await page.waitForFunction(() => marti.views.run_cycles && marti.views.run_nodes);
      const names = await chartNames(page);
      for (const name of ["explored_curve", "run_cycles", "run_loss", "run_nodes"]) assert.ok(names.includes(name), name);
      const csv = await download(page, page.locator("a[data-save=csv][data-chart=run_nodes]"));
      assert.equal(new Set(csv.text.trim().split("\r\n").slice(1).map((line) => line.split(",")[0])).size, 3);
      const figures = page.locator("#machine-tables details").filter({ hasText: "Figures of the run" });
      await figures.evaluate((details) => (details.open = true));
      await figures.getByRole("button", { name: "figure" }).click();
      const first = () => figures.locator("tbody td").first().textContent();
      const before = await first();
      await figures.getByRole("button", { name: "figure" }).click();
      assert.notEqual(await first(), before);
      // What is open stays open with the next machine, whose charts have its rows.
      await page.getByRole("button", { name: "double machine.nodes" }).click();
      await answer_of(page, { "machine.nodes": "6" });
      await page.waitForFunction(() => new Set(marti.views.run_nodes.data("rows").map(({ node }) => node)).size === 6);
      assert.equal(await page.locator("#machine-tables details[open]").filter({ hasText: "Figures of the run" }).count(), 1);
      // A link to a part leaves the settings in the address.
      await page.getByRole("link", { name: "Tables", exact: true }).click();
      await page.waitForTimeout(300);
      assert.match(page.url(), /machine\.nodes=6/);
    }));

  it("saves what marti runs and sweeps", () =>
    withOwnPage("#machine.nodes=6&axis=cache.size&values=512 B,2 KiB", async (page) => {
      const { figures } = await answer_of(page, { "machine.nodes": "6" });
      const saved = await download(page, page.getByRole("link", { name: "Save as configuration" }));
      writeFileSync(join(work, saved.name), saved.text);
      assert.deepEqual((await run(join(work, saved.name), {})).figures.machine, figures);
      const sweep = await download(page, page.getByRole("link", { name: "Save the curve" }));
      writeFileSync(join(work, sweep.name), sweep.text);
      await promisify(execFile)(program, ["sweep", join(work, sweep.name), "-o", join(work, "sweep"), "--quiet"]);
      const rows = readFileSync(join(work, "sweep", "points.csv"), "utf8").trim().split("\n");
      assert.equal(rows.length, 3);
    }));

  it("simulates while a slider moves", () =>
    withPage(async (page) => {
      const slide = async (key, steps) => {
        await page.getByRole("slider", { name: `slide ${key}`, exact: true }).focus();
        for (let i = 0; i < Math.abs(steps); ++i) await page.keyboard.press(steps < 0 ? "ArrowLeft" : "ArrowRight");
      };
      await slide("machine.nodes", 1);
      const five = await answer_of(page, { "machine.nodes": "5" });
      assert.deepEqual(five.figures, (await run(config, { "machine.nodes": "5" })).figures.machine);
      await slide("cache.size", 2);
      await answer_of(page, { "machine.nodes": "5", "cache.size": "4 KiB" });
      assert.equal(await control(page, "cache.size").inputValue(), "4 KiB");
      // Back where the configuration is, nothing is set.
      await slide("machine.nodes", -1);
      await answer_of(page, { "cache.size": "4 KiB" });
      // Every position of every slider is a value in the range of its setting.
      const wrong = await page.evaluate(async () => {
        const keys = await explore.server.keys();
        const wrong = [];
        const tried = new Set();
        for (const key of keys.controls.filter(explore.values.is_number)) {
          const numbers = explore.sliders.numbers_of(key);
          if (numbers.some((number, i) => i > 0 && number <= numbers[i - 1])) wrong.push(`${key.name}: not ascending`);
          if (key.minimum !== null && numbers.some((number) => number < key.minimum)) wrong.push(`${key.name}: too low`);
          if (key.maximum !== null && numbers.some((number) => number > key.maximum * (1 + 1e-9))) wrong.push(`${key.name}: too high`);
          if (key.type === "size" && numbers.some((number) => number > 0 && number !== key.minimum && !Number.isInteger(Math.log2(number)))) wrong.push(`${key.name}: no power of two`);
          const own = explore.values.text_of_value(key, key.value);
          if (explore.values.number_of(key, own) !== key.value) wrong.push(`${key.name}: ${key.value} becomes ${own}`);
          for (const number of numbers) {
            const exact = explore.values.text_of(key, number);
            if (explore.values.number_of(key, exact) !== (key.type === "real" || key.type === "percentage" || key.type === "frequency" ? number : Math.round(number))) wrong.push(`${key.name}: ${number} becomes ${exact}`);
            const read = explore.values.number_of(key, explore.sliders.text_of(key, number));
            if (!(Math.abs(read - number) <= 0.005 * Math.abs(number))) wrong.push(`${key.name}: ${number} becomes ${read}`);
          }
          if (numbers.length && !tried.has(key.type)) {
            tried.add(key.type);
            const answer = await explore.server.time({ [key.name]: explore.sliders.text_of(key, numbers.at(-1)) });
            if (answer.error?.includes(": must be ")) wrong.push(answer.error);
          }
        }
        if (tried.size < 4) wrong.push(`sliders of ${[...tried]} only`);
        return wrong;
      });
      assert.deepEqual(wrong, []);
    }));

  it("says how far a slow machine is", () =>
    withOwnPage("", async (page) => {
      await answer_of(page, {});
      // Of a machine of the curve, or of none.
      assert.deepEqual(Object.keys(await page.evaluate(() => explore.server.progress())), ["part", "unit", "done", "of"]);
      await page.evaluate(() => {
        const { time } = explore.server;
        explore.server.progress = async () => ({ part: "timing", unit: "packets", done: 3, of: 9 });
        explore.server.time = async (...asked) => {
          await new Promise((done) => setTimeout(done, 2000));
          return time(...asked);
        };
        explore.state.set({ "machine.nodes": "3" });
      });
      await page.waitForFunction(() => /^simulating for .* s: timing, 3 of 9 packets;/.test(document.getElementById("state").textContent));
      // Meanwhile there is a figure, and it says that it is modelled.
      await page.waitForFunction(() => /^A frame takes about .* modelled, from \d+ of \d+ packets\.$/.test(document.getElementById("sentences").textContent));
      const { end } = await page.evaluate(() => explore.server.model({ "machine.nodes": "3" }));
      const exact = await answer_of(page, { "machine.nodes": "3" });
      assert.ok(Math.abs(end / exact.figures.end - 1) < 0.25, `${end} and ${exact.figures.end}`);
      assert.match(await page.locator("#sentences").textContent(), /^A frame takes (?!about)/);
      assert.equal(await page.locator("html.old").count(), 0);
    }));

  it("saves a report of all machines", () =>
    withOwnPage("#machine.nodes=7", async (page) => {
      await answer_of(page, { "machine.nodes": "7" });
      const saved = await download(page, page.getByRole("button", { name: "Save as report" }));
      assert.equal(saved.name, "explored.html");
      assert.match(saved.text, /^<!DOCTYPE html>/);
      for (const said of ["machine.nodes = 7", "as the configuration", "All machines that were simulated"]) assert.ok(saved.text.includes(said), said);
    }));

  it("has a name for everything and fits a phone", () =>
    withPage(async (page) => {
      assert.deepEqual(await unnamed(page), []);
      await page.setViewportSize({ width: 360, height: 740 });
      assert.deepEqual(await overflow(page), { pixels: 0, elements: [] });
      await page.emulateMedia({ media: "print" });
      assert.deepEqual((await onPaper(page)).controls, []);
      await page.emulateMedia({ media: "screen" });
      if (process.env.MARTI_PICTURES) {
        await page.setViewportSize({ width: 1400, height: 1000 });
        await page.waitForTimeout(3000);
        await page.screenshot({ path: join(process.env.MARTI_PICTURES, "explore.png"), fullPage: true });
      }
      await page.setViewportSize(screen);
    }));

  it("can be neither read nor steered by a page of another origin", async () => {
    const hostile = createServer((_, response) => {
      response.setHeader("Content-Type", "text/html");
      response.end("<!DOCTYPE html><title>hostile</title><p>hostile");
    });
    await new Promise((ready) => hostile.listen(0, "127.0.0.1", ready));
    const context = await browser.newContext();
    const page = await context.newPage();
    await page.goto(`http://127.0.0.1:${hostile.address().port}/`);
    // It even knows the address.
    const outcome = await page.evaluate(async (address) => {
      const tried = {};
      const attempt = async (name, options, path = "time") => {
        try {
          const response = await fetch(address + path, options);
          tried[name] = response.type === "opaque" ? "nothing to read" : await response.text();
        } catch {
          tried[name] = "refused";
        }
      };
      const body = JSON.stringify({ settings: {} });
      await attempt("read", {}, "keys");
      await attempt("read blindly", { mode: "no-cors" }, "keys");
      await attempt("json", { method: "POST", headers: { "Content-Type": "application/json" }, body });
      await attempt("plain", { method: "POST", body });
      await attempt("end", { method: "POST", mode: "no-cors", body: "{}" }, "end");
      const loaded = (element, source) =>
        new Promise((done) => {
          const made = document.createElement(element);
          made.onload = () => done("loaded");
          made.onerror = () => done("refused");
          made.src = address + source;
          document.body.append(made);
        });
      tried.script = await loaded("script", "keys");
      const frame = document.createElement("iframe");
      frame.src = address;
      document.body.append(frame);
      await new Promise((done) => (frame.onload = done));
      try {
        tried.frame = frame.contentDocument === null ? "nothing to read" : frame.contentDocument.body.innerText;
      } catch {
        tried.frame = "refused";
      }
      const form = Object.assign(document.createElement("form"), { method: "post", action: `${address}end`, target: "sink", enctype: "text/plain" });
      document.body.append(Object.assign(document.createElement("iframe"), { name: "sink" }), form);
      form.submit();
      await new Promise((done) => setTimeout(done, 300));
      return tried;
    }, served.address);
    hostile.close();
    const { frame, ...others } = outcome;
    assert.ok(["refused", "nothing to read"].includes(frame), frame);
    for (const [name, got] of Object.entries(others)) assert.ok(["refused", "nothing to read"].includes(got), `${name}: ${got}`);
    await context.close();
    // The same, by a name that its name server leads to this computer.
    const rebound = await promisify(execFile)("node", ["-e", `
      require("node:http").get(${JSON.stringify(served.address)}, { headers: { Host: "evil.example" } }, (answer) => console.log(answer.statusCode));
    `]);
    assert.equal(rebound.stdout.trim(), "403");
    // It still serves its own page.
    await withOwnPage("", (own) => answer_of(own, {}));
  });

  it("ends when the page asks for it", async () => {
    const own = await explore();
    const { page, faults, close } = await open("", own.address);
    await answer_of(page, {});
    await page.getByRole("button", { name: "End marti explore" }).click();
    assert.equal(await own.ended, 0);
    await page.waitForFunction(() => document.getElementById("state").textContent.includes("has ended"));
    assert.deepEqual(faults, []);
    await close();
  });
});
