// A slider beside each number: its positions, and the value at each as a configuration has it.
"use strict";

explore.sliders = (() => {
  const units = {
    size: { B: 1, KiB: 2 ** 10, MiB: 2 ** 20, GiB: 2 ** 30, TiB: 2 ** 40 },
    frequency: { Hz: 1, kHz: 1e3, MHz: 1e6, GHz: 1e9 },
    duration: { ps: 1, ns: 1e3, us: 1e6, ms: 1e9, s: 1e12 },
    percentage: { "%": 0.01 },
  };
  const in_a_doubling = 4;
  const most_positions = 400;
  const narrow = 64;  // a range is linear up to this many times its lower end

  /** The number that a value's text says, in bytes, Hz, ps or as it is; NaN when it is none. */
  function number_of(key, text) {
    const parts = /^\s*([-+]?[\d.]+(?:e[-+]?\d+)?)\s*(\S*)\s*$/i.exec(text);
    if (!parts) return NaN;
    const [, digits, unit] = parts;
    const factor = unit ? units[key.type]?.[unit] : 1;
    return Number(digits) * (factor ?? NaN);
  }

  /** The number as a configuration has it, with three digits where it is not whole. */
  function text_of(key, number) {
    const table = units[key.type];
    if (!table) return String(key.type === "integer" ? Math.round(number) : Number(number.toPrecision(3)));
    const names = Object.keys(table);
    if (key.type === "size") {
      const bytes = Math.round(number);
      const largest = names.findLast((name) => bytes >= table[name] && bytes % table[name] === 0) ?? "B";
      return `${bytes / table[largest]} ${largest}`;
    }
    const largest = names.findLast((name) => number >= table[name]) ?? names[0];
    return `${Number((number / table[largest]).toPrecision(3))} ${largest}`;
  }

  /** All numbers that the slider can have, ascending: powers of two for sizes, by the setting's range for others. */
  function numbers_of(key) {
    const own = number_of(key, key.plain);
    const low = key.minimum ?? 0;
    const high = Math.min(key.maximum ?? Infinity, Math.max(own, low, 1) * 4096);
    if (!(high > low) || Number.isNaN(own)) return [];
    const whole = ["integer", "size", "duration"].includes(key.type);
    const steps = [];
    const first = low > 0 ? low : Math.min(high, whole ? 1 : own > 0 ? own / 64 : high / 64);
    if (low <= 0) steps.push(low, 0);
    if (key.type === "size") {
      for (let bytes = 2 ** Math.ceil(Math.log2(first)); bytes <= high; bytes *= 2) steps.push(bytes);
    } else if (key.type === "percentage" || high / first <= narrow) {
      const step = whole ? Math.max(1, Math.ceil((high - low) / most_positions)) : (high - low) / 100;
      for (let i = 0; low + i * step <= high * (1 + 1e-9); ++i) steps.push(low + i * step);
    } else {
      for (let i = 0; i <= most_positions && first * 2 ** (i / in_a_doubling) <= high; ++i) {
        const exact = first * 2 ** (i / in_a_doubling);
        steps.push(whole ? Math.round(exact) : exact);
      }
    }
    return [...new Set(steps)].sort((a, b) => a - b);
  }

  /** Calls `task` once for all calls of a frame of the screen, with the last argument. */
  function each_frame(task) {
    let waiting = false;
    let last;
    return (argument) => {
      last = argument;
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        task(last);
      });
    };
  }

  return {
    number_of,
    numbers_of,
    text_of,
    /** A slider for the key that calls `move(text)` while it moves, and `show(text)` for a value from elsewhere; null
     * for a key that has no range. */
    make(key, move) {
      const numbers = numbers_of(key);
      if (numbers.length < 2) return null;
      const input = Object.assign(document.createElement("input"), { type: "range", min: 0, max: numbers.length - 1, step: 1 });
      input.setAttribute("aria-label", `slide ${key.name}`);
      const moved = each_frame((position) => move(text_of(key, numbers[position])));
      const say = () => input.setAttribute("aria-valuetext", text_of(key, numbers[input.value]));
      input.addEventListener("input", () => {
        say();
        moved(Number(input.value));
      });
      return {
        input,
        show(text) {
          const number = number_of(key, text);
          if (Number.isNaN(number) || document.activeElement === input && text === text_of(key, numbers[input.value])) return;
          let nearest = 0;
          numbers.forEach((each, i) => {
            if (Math.abs(each - number) < Math.abs(numbers[nearest] - number)) nearest = i;
          });
          input.value = nearest;
          say();
        },
      };
    },
  };
})();
