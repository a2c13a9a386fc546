// A slider beside each number: its positions, and the value at each.
"use strict";

explore.sliders = (() => {
  const { number_of } = explore.values;
  const in_a_doubling = 4;
  const most_positions = 400;
  const narrow = 64;  // a range is linear up to this many times its lower end

  /** What a position says: three digits where the number is not whole. */
  const text_of = (key, number) => explore.values.text_of(key, number, 3);

  /** All numbers that the slider can have, ascending: powers of two for sizes, by the setting's range for others. */
  function numbers_of(key) {
    const own = key.value;
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
