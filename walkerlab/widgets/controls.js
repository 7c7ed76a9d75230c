// The kinds of controls. Each function takes a control of controls.py and a function `send` that receives a new value;
// it returns the elements of the control's row and a function that shows a value. component.js precedes this file,
// form.js follows it.

const newId = () => `wl-${Math.random().toString(36).slice(2)}`;
const focused = (element) => element.getRootNode().activeElement === element;
const asList = (value) => (Array.isArray(value) ? value : [value]);
const optionLabel = (name) => (name.startsWith("ƒ") ? name : name.replaceAll("_", " ")); // functions keep their names
const format = (number) => String(Number(Number(number).toPrecision(6)));

/** A slider with one or two thumbs, and number fields for its values. */
function sliderWithNumbers({ stops, unit, low, high }, names, send) {
  const nearest = (value) =>
    stops.reduce((best, stop, place) => (Math.abs(stop - value) < Math.abs(stops[best] - value) ? place : best), 0);
  const inUnit = !unit ? "value" : unit.startsWith("per") ? unit : `in ${unit}`;
  const isRange = names.length > 1;
  let values = names.map(() => low);
  let overlap; // value of both thumbs, if they were grabbed where they overlap: the direction decides which one moves
  const setAll = (numbers) => {
    values = numbers;
    send(isRange ? values : values[0]);
  };
  const set = (which, value) => setAll(values.map((old, index) => (index === which ? value : old)));
  const slide = (which, place) => {
    const stop = stops[Math.min(Math.max(place, 0), stops.length - 1)];
    set(which, isRange ? (which ? Math.max(stop, values[0]) : Math.min(stop, values[1])) : stop); // thumbs do not cross
  };
  const thumbs = names.map((name, which) =>
    make("input", {
      type: "range", min: 0, max: stops.length - 1, step: 1, ariaLabel: name,
      oninput: ({ target }) => {
        const stop = stops[target.value];
        if (overlap === undefined) slide(which, Number(target.value));
        else setAll([Math.min(stop, overlap), Math.max(stop, overlap)]);
      },
      onpointerdown: () => { overlap = isRange && values[0] === values[1] ? values[0] : undefined; },
      onpointerup: () => { overlap = undefined; },
    }));
  const numbers = names.map((name, which) =>
    make("input", {
      type: "number", min: low, max: high, step: "any", ariaLabel: `${name}, ${inUnit}`,
      oninput: ({ target }) => target.value && set(which, target.valueAsNumber),
      onchange: () => show(isRange ? values : values[0], true),
      onkeydown: (event) => {
        const step = { ArrowUp: 1, ArrowDown: -1 }[event.key];
        if (!step) return;
        event.preventDefault();
        slide(which, nearest(values[which]) + step);
        event.target.value = format(values[which]);
      },
    }));
  const rail = make("span", { className: isRange ? "rail two" : "rail" }, ...thumbs);
  rail.addEventListener("pointerdown", (event) => { // a click on the rail of a range moves the nearer thumb
    if (event.target !== rail) return;
    const { left, width } = rail.getBoundingClientRect();
    const place = Math.round(((event.clientX - left) / width) * (stops.length - 1));
    const [lower, upper] = values.map(nearest);
    const which = Math.abs(place - lower) < Math.abs(place - upper) || place < lower ? 0 : 1;
    slide(which, place);
    thumbs[which].focus();
    event.preventDefault();
  });
  function show(value, evenFocused) { // a number field that has the focus is being typed in
    values = asList(value);
    const places = values.map(nearest);
    thumbs.forEach((thumb, which) => {
      thumb.value = places[which];
      thumb.setAttribute("aria-valuetext", `${format(values[which])} ${unit}`.trim());
    });
    numbers.forEach((number, which) => { if (evenFocused || !focused(number)) number.value = format(values[which]); });
    const ends = isRange ? places : [nearest(Math.max(low, 0)), places[0]];
    rail.style.setProperty("--from", Math.min(...ends) / (stops.length - 1));
    rail.style.setProperty("--to", Math.max(...ends) / (stops.length - 1));
  }
  const unitLabel = make("span", { className: "unit" }, unit);
  rail.dataset.low = format(low); // the ends of the scale, shown below the rail
  rail.dataset.high = format(high);
  return { rail, numbers, elements: isRange ? [numbers[0], rail, numbers[1], unitLabel] : [rail, numbers[0], unitLabel], show };
}

const slider = (control, send) => sliderWithNumbers(control, [control.label], send);
const range = (control, send) =>
  sliderWithNumbers(control, [`minimum ${control.label}`, `maximum ${control.label}`], send);

/** A slider for each component of a vector, and buttons for its presets. */
function vector(control, send) {
  let values = [];
  const sliders = control.directions.map((direction, which) => {
    const set = (value) => send(values.map((old, index) => (index === which ? value : old)));
    return sliderWithNumbers(control, [`${control.label} ${direction}`], set);
  });
  const names = control.presets.map(({ name, value }) => make("button", { type: "button", className: "chip",
    ariaLabel: `${control.label}: ${name}`, onclick: () => send(value) }, name));
  const columns = sliders.map((one, which) => make("div", { className: "component" },
    make("span", { className: "direction quiet" }, control.directions[which]), one.numbers[0], one.rail));
  const unit = make("span", { className: "unit" }, control.unit);
  const above = names.length ? [make("div", { className: "chips" }, ...names)] : [];
  return {
    elements: [make("div", { className: "wide" }, ...above, make("div", { className: "components" }, ...columns, unit))],
    show(value) {
      values = asList(value);
      sliders.forEach((one, which) => one.show(values[which]));
      names.forEach((button, which) =>
        button.setAttribute("aria-pressed", JSON.stringify(control.presets[which].value) === JSON.stringify(values)));
    },
  };
}

/** A number field for an arbitrary whole number, with a button for a random one. */
function number({ label, low, high }, send) {
  const box = make("input", {
    type: "number", min: low, max: high, step: 1, ariaLabel: label,
    oninput: () => box.value && send(box.valueAsNumber),
  });
  const random = make("button", { type: "button", ariaLabel: `random ${label}`,
    onclick: () => send(Math.floor(Math.random() * 10000)) }, "random");
  return {
    elements: [make("span", { className: "wide inline" }, box, random)],
    show: (value) => { if (!focused(box)) box.value = value; },
  };
}

/** The description of the selected option. */
function description(options) {
  const sentences = options.map(({ about }) => make("span", {}, about));
  return {
    element: make("div", { className: "description quiet" }, ...sentences),
    show: (value) => sentences.forEach((one, index) => one.classList.toggle("selected", options[index].name === value)),
  };
}

function menu({ options }, name, send) {
  const box = make("select", { ariaLabel: name, onchange: () => send(box.value) },
    ...options.map((option) => make("option", { value: option.name }, optionLabel(option.name))));
  return { box, show: (value) => { box.value = value; } };
}

/** One of several options: buttons, or a menu if there are many. */
function choice(control, send) {
  const group = newId();
  const about = description(control.options);
  if (!control.as_buttons) {
    const { box, show } = menu(control, control.label, send);
    return {
      elements: [make("div", { className: "wide" }, box, about.element)],
      show: (value) => { show(value); about.show(value); },
    };
  }
  const radios = control.options.map(({ name }) =>
    make("input", { type: "radio", name: group, value: name, ariaLabel: optionLabel(name), onchange: () => send(name) }));
  const chips = radios.map((radio) => make("label", { className: "chip" }, radio, radio.ariaLabel));
  return {
    elements: [make("div", { className: "wide" }, make("div", { className: "chips" }, ...chips), about.element)],
    show(value) {
      radios.forEach((radio) => { radio.checked = radio.value === value; });
      about.show(value);
    },
  };
}

/** A sequence of options, applied one after the other. */
function sequence(control, send) {
  const lines = [];
  const box = make("div", { className: "wide" });
  const add = make("button", { type: "button", className: "small", ariaLabel: `${control.label}: add a step`,
    onclick: () => { set([...values, values.at(-1)]); lines.at(-1).select.box.focus(); } }, "+ add a step");
  let values = [];
  const set = (several) => send(several.length === 1 ? several[0] : several);
  function line(index) {
    const select = menu(control, index ? `${control.label}, step ${index + 1}` : control.label,
      (value) => set(values.map((old, other) => (other === index ? value : old))));
    const remove = make("button", { type: "button", className: "small",
      ariaLabel: `${control.label}: remove step ${index + 1}`,
      onclick: () => set(values.filter((_, other) => other !== index)) }, "✕");
    const about = description(control.options);
    return { select, remove, about, element: make("div", { className: "step" }, select.box, remove, about.element) };
  }
  return {
    elements: [box],
    show(value) {
      values = asList(value);
      while (lines.length > values.length) lines.pop().element.remove();
      while (lines.length < values.length) {
        lines.push(line(lines.length));
        box.append(lines.at(-1).element);
      }
      lines.at(-1).remove.after(add);
      lines.forEach(({ select, remove, about }, index) => {
        select.show(values[index]);
        about.show(values[index]);
        remove.hidden = values.length === 1;
      });
    },
  };
}

/** Any number of options. */
function flags({ label, options }, send) {
  const boxes = options.map(({ name }) =>
    make("input", { type: "checkbox", value: name, ariaLabel: optionLabel(name), onchange: update }));
  function update() {
    const checked = boxes.filter((box) => box.checked).map((box) => box.value);
    send(checked.length ? checked : "none");
  }
  const lines = boxes.map((box, index) => make("label", { className: "flag" }, box,
    make("span", {}, `${box.ariaLabel} `, make("span", { className: "quiet" }, options[index].about))));
  const summary = make("summary", { ariaLabel: `${label}: choose` });
  return {
    elements: [make("details", { className: "wide" }, summary, ...lines)],
    show(value) {
      boxes.forEach((box) => { box.checked = asList(value).includes(box.value); });
      const checked = boxes.filter((box) => box.checked).map((box) => box.ariaLabel);
      summary.textContent = checked.join(", ") || "none";
    },
  };
}

const KINDS = { slider, range, vector, number, choice, sequence, flags };
