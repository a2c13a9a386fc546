// node bundle.mjs NODE_MODULES DIRECTORY: writes into DIRECTORY the scripts that a page of marti report loads,
// each with the licences of what it holds before it, and vega_bundle.cpp, which puts them into the program
// (studies/report/plots/vega_bundle.h). The same packages give the same bytes.
import { createHash } from "node:crypto";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const [modules, directory] = process.argv.slice(2);

/** A package's folder; npm puts one below the other when two versions are wanted. */
function folderOf(name, user) {
  for (const folder of user ? [join(user, "node_modules", name), join(modules, name)] : [join(modules, name)]) {
    try {
      return { folder, description: JSON.parse(readFileSync(join(folder, "package.json"), "utf8")) };
    } catch (error) {
      if (error.code !== "ENOENT") throw error;
    }
  }
  throw new Error(`${name} is not below ${modules}`);
}

/** Maps the text of a licence to the packages that have it: of `name` and of all that it is built from. */
function licences(name, user, found = new Map()) {
  const { folder, description } = folderOf(name, user);
  const label = `${name} ${description.version}`;
  const files = readdirSync(folder).filter((file) => /^licen[cs]e/i.test(file));
  if (files.length === 0) throw new Error(`${label} comes without its licence`);
  for (const file of files) {
    const text = readFileSync(join(folder, file), "utf8").replaceAll("\r", "").trim();
    const holders = found.get(text) ?? [];
    if (holders.includes(label)) return found;
    found.set(text, [...holders, label]);
  }
  for (const needed of Object.keys(description.dependencies ?? {}).sort()) {
    // vega-typings holds types alone, and yargs is for vega-lite's command line: neither is in a script.
    if (needed !== "vega-typings" && needed !== "yargs") licences(needed, folder, found);
  }
  return found;
}

function notice(name) {
  const parts = [];
  for (const [text, holders] of licences(name)) {
    parts.push(`${holders.join(", ")}:\n\n${text}`);
  }
  const all = parts.join("\n\n----\n\n");
  if (/\*\/|<\/?script|<!--/i.test(all)) throw new Error(`a licence of ${name} cannot stand in a comment`);
  return `/*! ${all}\n*/\n`;
}

/** The interpreter is published as a module only: its imports are there in Vega, and there it is put. */
function asScript(text) {
  const script = text
    .replace(/^import \{ ([\w, ]+) \} from 'vega-util';$/m, "const { $1 } = vega;")
    .replace(/^export \{ expression as expressionInterpreter \};$/m, "vega.expressionInterpreter = expression;");
  if (/^(import|export)\b/m.test(script) || !script.includes("vega.expressionInterpreter")) {
    throw new Error("this version of vega-interpreter imports or exports something else");
  }
  return `(function () {\n${script}})();\n`;
}

const scripts = [
  { name: "vega", file: "build/vega.min.js", change: (text) => text },
  { name: "vega-lite", file: "build/vega-lite.min.js", change: (text) => text },
  { name: "vega-interpreter", file: "build/vega-interpreter.js", change: asScript },
].map(({ name, file, change }) => {
  const { folder } = folderOf(name);
  const text = readFileSync(join(folder, file), "utf8").replace(/^\/\/# sourceMappingURL=.*\n?/m, "");
  if (/<\/?script|<!--/i.test(text)) throw new Error(`${name} cannot stand in a page`);
  const path = join(directory, `${name}.js`);
  const script = notice(name) + change(text).trimEnd() + "\n";
  writeFileSync(path, script);
  return { path, hash: createHash("sha256").update(script).digest("base64") };
});

// The assembler takes the files in; a compiler would need seconds for literals of this size.
const blocks = scripts.flatMap(({ path }, i) =>
  [`marti_script_${i}:`, `  .incbin ${JSON.stringify(path)}`, `marti_script_${i}_end:`].map(
    (line) => `    ${JSON.stringify(line + "\n")}`,
  ),
);
const names = scripts.map((_, i) => `extern const char marti_script_${i}[];\nextern const char marti_script_${i}_end[];`);
const entries = scripts.map(
  ({ hash }, i) => `      Script{{marti_script_${i}, marti_script_${i}_end}, "${hash}"},`,
);
writeFileSync(
  join(directory, "vega_bundle.cpp"),
  `// Made by cmake/npm/bundle.mjs.
#include "studies/report/plots/vega_bundle.h"

#include <array>

asm("  .pushsection .rodata\\n"
${blocks.join("\n")}
    "  .popsection\\n");

extern "C" {
${names.join("\n")}
}

namespace marti::studies::report {

std::span<const Script> vega_scripts() {
  static const std::array<Script, ${scripts.length}> scripts{
${entries.join("\n")}
  };
  return scripts;
}

bool have_vega_scripts() { return true; }

}  // namespace marti::studies::report
`,
);
