// The filter above the table of points: conditions with commas between them, all of which a point must meet.
// "machine.nodes >= 16, cache.size = 16 KiB, price < 30" compare columns; another text must be in one of the point's values.
// A text in quotation marks may hold commas and signs: point = "small, cheap". A quotation mark in it is doubled.
"use strict";

marti.filter = (() => {
  const plain = (text) => String(text).replaceAll(/\s/g, "").toLowerCase();
  const compare = {
    "=": (a, b) => a === b,
    "<": (a, b) => a < b,
    ">": (a, b) => a > b,
    "<=": (a, b) => a <= b,
    ">=": (a, b) => a >= b,
  };
  const units = { b: 1, kib: 2 ** 10, mib: 2 ** 20, gib: 2 ** 30, hz: 1, khz: 1e3, mhz: 1e6, ghz: 1e9, "%": 0.01 };

  /** A number, with the column's unit or none, or with one of those above. NaN for any other text. */
  function numberOf(text, column) {
    const parts = /^([-+]?[0-9.]+(?:e[-+]?[0-9]+)?)([a-z%]*)$/.exec(plain(text));
    if (!parts) return NaN;
    const own = parts[2] === "" || parts[2] === plain(column.unit ?? "");
    return Number(parts[1]) * (own ? 1 : units[parts[2]] ?? NaN);
  }

  /** A column's condition: by its numbers, or for equality by its texts. */
  function comparison(column, sign, wanted) {
    const text = plain(wanted);
    if (sign === "=" && column.texts) {
      const same = column.texts.map((each) => plain(each) === text);
      if (same.some((each) => each)) return (i) => same[column.place[i]];
    }
    const known = column.texts ? column.texts.findIndex((each) => plain(each) === text) : -1;
    const number = known >= 0 && column.values.length > 0 ? column.values[known] : numberOf(wanted, column);
    if (!column.number || Number.isNaN(number)) throw new Error(`${wanted.trim()} is no value of ${column.name}`);
    return (i) => column.number(i) !== null && compare[sign](column.number(i), number);
  }

  /** The parts between commas that are not in quotation marks. */
  function parted(text) {
    const parts = text.match(/(?:[^,"]|"(?:[^"]|"")*")+|"/g) ?? [];
    if (parts.includes('"')) throw new Error("a quotation mark is not closed");
    return parts.filter((part) => part.trim() !== "");
  }

  /** Without its quotation marks, where the text has them at both ends. */
  const unquoted = (text) => /^\s*"((?:[^"]|"")*)"\s*$/.exec(text)?.[1].replaceAll('""', '"') ?? text;

  function condition(text, columns) {
    const parts = /^([^<>="]+)(<=|>=|=|<|>)(.+)$/.exec(text);
    if (parts) {
      const name = plain(parts[1]);
      const column = columns.find((each) => plain(each.name) === name) ?? columns.find((each) => plain(each.title) === name);
      if (!column) throw new Error(`there is no column ${parts[1].trim()}`);
      return comparison(column, parts[2], unquoted(parts[3]));
    }
    const word = plain(unquoted(text));
    const axes = columns.filter(({ texts }) => texts);
    const holding = axes.map(({ texts }) => texts.map((each) => plain(each).includes(word)));
    return (i) => axes.some(({ place }, a) => holding[a][place[i]]);
  }

  /** A function that says of a point whether it is let through. Throws an Error that says what is wrong. */
  return (text, columns) => {
    const all = parted(text).map((each) => condition(each, columns));
    return (i) => all.every((each) => each(i));
  };
})();
