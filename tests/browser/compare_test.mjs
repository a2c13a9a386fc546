// The pages of `marti compare -o` in a browser: they draw what the comparison says in JSON, request nothing, fit a
// phone, and their tables can be sorted.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdirSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";
import { promisify } from "node:util";
import { openFile, resize, screen, startBrowser } from "./browser.mjs";
import { chartNames, markCount, overflow, rowsOf, unnamed } from "./inspect.mjs";

const work = join(process.env.MARTI_WORK, "comparisons");
const pictures = process.env.MARTI_PICTURES;
const marti = async (...args) => (await promisify(execFile)(process.env.MARTI_PROGRAM, args, { maxBuffer: 1 << 26 })).stdout;

const sweep = (clock) => `scene.source = "teapot:2"
image.width = 16
image.height = 12
node.clock = "${clock}"
[sweep.axes]
machine.nodes = [1, 2, 4, 8]
cache.size = ["512 B", "4 KiB", "16 KiB"]
`;

rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });
writeFileSync(join(work, "slow.toml"), sweep("33 MHz"));
writeFileSync(join(work, "fast.toml"), sweep("50 MHz"));
await marti("run", join(work, "slow.toml"), "--set", "machine.nodes=3", "-o", join(work, "run"));
await marti("run", join(work, "slow.toml"), "--set", "cache.size=1KiB", "-o", join(work, "other"));
for (const name of ["slow", "fast"]) await marti("sweep", join(work, `${name}.toml`), "--quiet", "-o", join(work, name));

const pairs = { pair: ["run", "other"], points: ["run", "slow"], sweeps: ["slow", "fast"] };
const said = {};
for (const [kind, names] of Object.entries(pairs)) {
  const page = join(work, `${kind}.html`);
  said[kind] = JSON.parse(await marti("compare", ...names.map((name) => join(work, name)), "-o", page, "--json"));
}

let browser;
const opened = {};
before(async () => {
  browser = await startBrowser();
  for (const kind of Object.keys(pairs)) opened[kind] = await openFile(browser, join(work, `${kind}.html`));
});
after(() => browser?.close());

/** The numbers of a column, by the heading. */
const column = (page, heading) =>
  page.$$eval(
    "table[data-sorted]",
    (tables, heading) => {
      for (const table of tables) {
        const at = [...table.tHead.rows[0].cells].findIndex((cell) => cell.textContent === heading);
        if (at >= 0) return [...table.tBodies[0].rows].map((row) => Number(row.cells[at].dataset.number));
      }
      return null;
    },
    heading,
  );

for (const kind of Object.keys(pairs)) {
  describe(`the page of a comparison: ${kind}`, () => {
    it("draws its charts, asks for nothing, fits a phone and names everything", async () => {
      const { page, faults } = opened[kind];
      const names = await chartNames(page);
      assert.deepEqual(names, kind === "pair" ? ["compare_times"] : ["compare_points", "compare_times"]);
      for (const name of names) assert.ok((await markCount(page, name)) > 0, name);
      assert.deepEqual(await unnamed(page), []);
      if (pictures) await page.screenshot({ path: join(pictures, `compare-${kind}.png`), fullPage: true });
      await resize(page, { width: 360, height: 740, mobile: true });
      assert.deepEqual(await overflow(page), { pixels: 0, elements: [] });
      await resize(page, screen);
      assert.deepEqual(await faults(), []);
    });

    it("says the verdict first", async () => {
      const sentences = await opened[kind].page.$$eval("section:first-of-type li", (items) => items.map((item) => item.textContent));
      assert.deepEqual(sentences.slice(0, said[kind].verdict.length), said[kind].verdict);
    });
  });
}

describe("figures of the pages", () => {
  it("are those of the JSON", async () => {
    const times = await rowsOf(opened.pair.page, "compare_times");
    const nodes = said.pair.numbers.find(({ name }) => name === "nodes");
    assert.equal(times.length, said.pair.times.length);
    times.forEach((row, i) => {
      const time = said.pair.times[i];
      assert.equal(`time_${row.activity}`, time.name);
      assert.ok(Math.abs(row.a_ps - time.a / nodes.a) <= 0.5 && Math.abs(row.b_ps - time.b / nodes.b) <= 0.5, row.activity);
      assert.ok(Math.abs(row.change_ms * 1e9 - time.change_a_node) < 1e-3, row.activity);
    });
    const points = await rowsOf(opened.sweeps.page, "compare_points");
    assert.deepEqual(
      points.map(({ point, a_ps, b_ps, ratio }) => [point, a_ps, b_ps, ratio]),
      said.sweeps.points.map(({ point_a, end_a, end_b, ratio }) => [point_a, end_a, end_b, ratio]),
    );
    const beside = await rowsOf(opened.points.page, "compare_points");
    assert.deepEqual(beside.map(({ ratio }) => ratio), said.points.points.map(({ ratio }) => ratio));
  });

  it("are sorted by a click on a heading, by their values and not their texts", async () => {
    const { page, faults } = opened.sweeps;
    const before = await column(page, "cache.size");
    assert.equal(before.length, 12);
    const heading = page.locator("table[data-sorted] th", { hasText: /^cache\.size$/ });
    await heading.getByRole("button").click();
    assert.deepEqual(await column(page, "cache.size"), [...before].sort((a, b) => a - b));
    assert.equal(await heading.getAttribute("aria-sort"), "ascending");
    await heading.getByRole("button").press("Enter");
    assert.deepEqual(await column(page, "cache.size"), [...before].sort((a, b) => b - a));
    assert.deepEqual(await faults(), []);
  });
});
