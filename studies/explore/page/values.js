// The values of settings: typed as a result has them, and as the text that people write.
"use strict";

explore.values = (() => {
  const sizes = { B: 1, KiB: 2 ** 10, MiB: 2 ** 20, GiB: 2 ** 30, TiB: 2 ** 40 };
  // Powers of ten, applied to the digits as text, so that no rounding comes in.
  const tens = {
    frequency: { Hz: 0, kHz: 3, MHz: 6, GHz: 9 },
    duration: { ps: 0, ns: 3, us: 6, ms: 9, s: 12 },
    percentage: { "%": -2 },
  };
  const numbers = ["integer", "real", "size", "frequency", "duration", "percentage"];

  function times_ten_to(power, digits) {
    const [mantissa, exponent = "0"] = String(digits).toLowerCase().split("e");
    return Number(`${mantissa}e${Number(exponent) + power}`);
  }

  /** The number that a value's text says, in bytes, Hz, ps or as it is; NaN when it is none. */
  function number_of(key, text) {
    const parts = /^\s*([-+]?[\d.]+(?:e[-+]?\d+)?)\s*(\S*)\s*$/i.exec(text);
    if (!parts) return NaN;
    const [, digits, unit] = parts;
    if (key.type === "size") return Number(digits) * (sizes[unit || "B"] ?? NaN);
    return times_ten_to(unit ? tens[key.type]?.[unit] ?? NaN : 0, digits);
  }

  /** The number as a configuration has it, exactly or with so many digits. */
  function text_of(key, number, digits) {
    const short = (value) => String(digits ? Number(value.toPrecision(digits)) : value);
    if (key.type === "size") {
      const bytes = Math.round(number);
      const largest = Object.keys(sizes).findLast((name) => bytes >= sizes[name] && bytes % sizes[name] === 0) ?? "B";
      return `${bytes / sizes[largest]} ${largest}`;
    }
    const units = tens[key.type];
    if (!units) return key.type === "integer" ? String(Math.round(number)) : short(number);
    const names = Object.keys(units);
    const texts = names.map((name) => `${short(times_ten_to(-units[name], number))} ${name}`);
    const fits = (name, i) => number >= 10 ** units[name] && (digits || number_of(key, texts[i]) === number);
    return texts[Math.max(0, names.findLastIndex(fits))];
  }

  /** A text as a TOML file has it. */
  const toml = (key, text) => (key.list || ["boolean", "integer", "real"].includes(key.type) ? text : JSON.stringify(text));

  /** A typed value as people write it, a list as in a TOML file. */
  function text_of_value(key, value) {
    const one = { ...key, list: false };
    if (Array.isArray(value)) return `[${value.map((each) => toml(one, text_of_value(one, each))).join(", ")}]`;
    return typeof value === "number" ? text_of(key, value) : String(value);
  }

  return { is_number: (key) => numbers.includes(key.type) && !key.list, number_of, text_of, toml, text_of_value };
})();
