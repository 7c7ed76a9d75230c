// The roulette wheel of selection: a menu of operators, a slider for the parameter of the operator, and a button that spins.
function render({ model, el }) {
  const menu = make("select", { onchange: () => send("selection", menu.value) },
    ...model.get("options").map(({ name, about }) => make("option", { value: name, textContent: name, title: about ?? "" })));
  const slider = make("input", { type: "range", oninput: change });
  const value = make("output", { className: "value" });
  const name = make("span", { className: "name" });
  const label = make("label", { className: "pressure" }, name, slider, value);
  const spin = make("button", { type: "button", className: "main", textContent: "Spin", onclick: () => model.send("spin"),
    title: "select as many parents as there are individuals" });
  const words = make("p", { className: "quiet", attributes: { role: "status" } });
  const picture = make("div", { className: "picture" });
  el.classList.add("wl-component", "wl-selection-wheel");
  el.append(make("div", { className: "row" }, make("label", {}, "selection ", menu), label, spin), words, picture);
  let drawing = false; // whether Python is drawing a change; until it has finished, the next change waits
  let waiting = false; // whether the slider has moved during the drawing

  function send(trait, value) {
    model.set(trait, value);
    model.save_changes();
  }
  function change() {
    value.textContent = slider.value;
    waiting = drawing;
    if (drawing) return;
    drawing = true;
    send("parameters", { ...model.get("parameters"), [model.get("selection")]: Number(slider.value) });
  }
  function update() {
    const selected = model.get("selection");
    const parameter = model.get("options").find(({ name }) => name === selected)?.parameter;
    menu.value = selected;
    label.hidden = !parameter;
    if (parameter && !waiting) {
      Object.assign(slider, { min: parameter.low, max: parameter.high, step: parameter.step });
      slider.value = model.get("parameters")[selected];
      name.textContent = parameter.label;
      value.textContent = slider.value;
    }
    words.textContent = model.get("words");
  }
  function show() {
    picture.replaceChildren(parseSvg(model.get("picture")));
    drawing = false;
    if (waiting) change();
  }
  for (const trait of ["selection", "parameters", "words"]) model.on(`change:${trait}`, update);
  model.on("change:picture", show);
  update();
  show();
  return captureKeys(el);
}
export default { render };
