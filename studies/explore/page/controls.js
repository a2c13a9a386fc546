// A control for each setting, by section.
"use strict";

explore.controls = (() => {
  const byKey = new Map();
  const numbers = ["integer", "real", "size", "frequency", "duration", "percentage"];
  const sizes = { B: 1, KiB: 2 ** 10, MiB: 2 ** 20, GiB: 2 ** 30, TiB: 2 ** 40 };

  const element = (name, properties = {}, ...children) => {
    const made = Object.assign(document.createElement(name), properties);
    made.append(...children);
    return made;
  };

  const is_number = (key) => numbers.includes(key.type) && !key.list;

  /** A value of a configuration without its quotation marks. */
  const plain = (value) => (value.startsWith('"') ? JSON.parse(value) : value);

  /** The number with its unit, twice as large or half; the same when it is no number. */
  function scaled(key, value, factor) {
    const parts = /^\s*([-+]?[\d.]+(?:e[-+]?\d+)?)\s*(.*?)\s*$/i.exec(value);
    if (!parts) return value;
    const [, digits, unit] = parts;
    const number = Number(digits) * factor;
    if (key.type === "size") {
      const bytes = Math.max(1, Math.round(number * (sizes[unit || "B"] ?? 1)));
      const largest = Object.keys(sizes).findLast((name) => bytes % sizes[name] === 0);
      return `${bytes / sizes[largest]} ${largest}`;
    }
    if (key.type === "integer") return String(factor < 1 ? Math.floor(number) : Math.max(1, number));
    return unit ? `${number} ${unit}` : String(number);
  }

  function input_of(key, change) {
    if (key.list || !["choice", "boolean"].includes(key.type)) {
      const input = element("input", { type: "text", spellcheck: false, autocomplete: "off" });
      let waiting = 0;
      input.addEventListener("input", () => {
        clearTimeout(waiting);
        waiting = setTimeout(change, 200);
      });
      input.addEventListener("change", () => {
        clearTimeout(waiting);
        change();
      });
      return input;
    }
    const input =
      key.type === "boolean"
        ? element("input", { type: "checkbox" })
        : element("select", {}, ...key.choices.map((choice) => element("option", { value: choice, textContent: choice })));
    input.addEventListener("change", change);
    return input;
  }

  function make(key) {
    const own = plain(key.value);
    const control = { key, own };
    const read = () => (control.input.type === "checkbox" ? String(control.input.checked) : control.input.value.trim());
    const move = (value) => explore.state.set({ [key.name]: value === own ? null : value });
    const slider = is_number(key) ? explore.sliders.make({ ...key, plain: own }, move) : null;
    control.input = input_of(key, () => move(read()));
    control.input.id = `control-${key.name}`;
    control.show = (value) => {
      if (control.input.type === "checkbox") control.input.checked = value === "true";
      else if (control.input.value.trim() !== value) control.input.value = value;
      slider?.show(value);
    };
    control.error = element("p", { className: "error", hidden: true });
    control.error.setAttribute("role", "alert");
    const step = (text, name, factor) => {
      const button = element("button", { type: "button", textContent: text, title: `${name} ${key.name}` });
      button.setAttribute("aria-label", `${name} ${key.name}`);
      button.addEventListener("click", () => move(scaled(key, read(), factor)));
      return button;
    };
    const steps = is_number(key) ? [step("÷2", "halve", 0.5), step("×2", "double", 2)] : [];
    const range = [key.unit, key.range].filter(Boolean).join("; ");
    control.box = element(
      "div",
      { className: "control" },
      element("label", { htmlFor: control.input.id, textContent: key.name.slice(key.section.length + 1) }),
      control.input,
      ...steps,
      ...(slider ? [slider.input] : []),
      control.error,
      element("p", { className: "note", textContent: key.meaning + (range ? ` (${range})` : "") }),
    );
    byKey.set(key.name, control);
    return control;
  }

  function section(name, meaning, controls) {
    const details = element(
      "details",
      { id: `section-${name}` },
      element("summary", { textContent: name }),
      element("p", { className: "note", textContent: meaning ?? "" }),
      ...controls.map(({ box }) => box),
    );
    details.open = ["machine", "cache", "interconnect"].includes(name);
    return details;
  }

  return {
    element,
    numbers,
    plain,
    scaled,
    of: (name) => byKey.get(name),
    make(keys) {
      const sections = Map.groupBy
        ? Map.groupBy(keys.controls, (key) => key.section)
        : keys.controls.reduce((map, key) => map.set(key.section, [...(map.get(key.section) ?? []), key]), new Map());
      for (const [name, of_section] of sections) {
        document.getElementById("settings").append(section(name, keys.sections[name], of_section.map(make)));
      }
    },
    show({ settings }) {
      for (const control of byKey.values()) {
        const set = settings[control.key.name];
        control.show(set ?? control.own);
        control.box.classList.toggle("set", set !== undefined);
        if (set !== undefined) control.box.closest("details").open = true;
      }
    },
    /** Says which settings the machine has no use for, and what is wrong with one. */
    judge(answer) {
      for (const control of byKey.values()) {
        const wrong = "error" in answer && answer.key === control.key.name;
        control.error.hidden = !wrong;
        control.error.textContent = wrong ? answer.error : "";
        if (wrong) control.box.closest("details").open = true;
        if (!("error" in answer)) {
          const idle = !(control.key.name in answer.keys);
          control.box.classList.toggle("idle", idle);
          control.box.title = idle ? "has no effect on this machine" : "";
        }
      }
    },
  };
})();
