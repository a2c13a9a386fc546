// Results to look at, made by the program itself: a run, a sweep and a study, each small, and their reports.
import { execFile } from "node:child_process";
import { readFileSync, rmSync, mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { promisify } from "node:util";

const program = process.env.MARTI_PROGRAM;
const configs = join(process.env.MARTI_SOURCE, "configs");
// The page shows paths: this one has a word that is wider than a phone.
const work = join(process.env.MARTI_WORK, "results-of-a-directory-with-a-very-long-name-without-a-space");

const marti = (...args) => promisify(execFile)(program, args);

const set = (settings) => settings.flatMap((setting) => ["--set", setting]);

const commands = {
  run: [
    ...["run", join(configs, "marti.toml")],
    ...set(["scene.source=teapot:4", "image.width=96", "image.height=72", "energy.preset=45nm", "record.interval=200us"]),
  ],
  sweep: ["sweep", join(configs, "sweep-small.toml")],
  study: [
    ...["study", "frames", join(configs, "animation.toml")],
    ...set(["image.width=16", "image.height=12", "frames.count=2", "frames.rate=2"]),
  ],
};

/** Maps "run", "sweep" and "study" to the directory of the results, the page and the directory of the plots. */
export async function makeReports() {
  rmSync(work, { recursive: true, force: true });
  mkdirSync(work, { recursive: true });
  const made = Object.entries(commands).map(async ([kind, command]) => {
    const directory = join(work, kind);
    const plots = join(work, `${kind}-plots`);
    await marti(...command, "-o", directory);
    await marti("report", directory, "--plots", plots);
    return [kind, { directory, page: join(directory, "report.html"), plots }];
  });
  return Object.fromEntries(await Promise.all(made));
}

/** A sweep of a configuration's text, and its page, made with these further arguments. */
export async function makeSweep(name, config, ...args) {
  const directory = join(process.env.MARTI_WORK, name);
  rmSync(directory, { recursive: true, force: true });
  mkdirSync(directory, { recursive: true });
  const file = join(directory, "sweep.toml");
  writeFileSync(file, config);
  const results = join(directory, "results");
  await marti("sweep", file, "-o", results, "--quiet");
  await marti("report", results, ...args);
  return { directory: results, page: join(results, "report.html") };
}

/** A CSV text (RFC 4180) as objects by column; numbers are numbers, nothing and an empty text are null. */
export function parseCsv(text) {
  const rows = [[]];
  for (const [, quoted, plain, end] of text.matchAll(/(?:"((?:[^"]|"")*)"|([^",\r\n]*))(,|\r?\n|$)/g)) {
    if (quoted === undefined && plain === "" && end === "" && rows.at(-1).length === 0) break;
    rows.at(-1).push(quoted ? quoted.replaceAll('""', '"') : cell(plain ?? ""));
    if (end === "") break;
    if (end !== ",") rows.push([]);
  }
  if (rows.at(-1).length === 0) rows.pop();
  const [header, ...body] = rows;
  return body.map((row) => Object.fromEntries(header.map((name, i) => [name, row[i]])));
}

function cell(text) {
  if (text === "") return null;
  return Number.isNaN(Number(text)) ? text : Number(text);
}

export const readCsv = (path) => parseCsv(readFileSync(path, "utf8"));
export const readJson = (path) => JSON.parse(readFileSync(path, "utf8"));
