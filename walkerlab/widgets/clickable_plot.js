// A plot with points; a click, or Enter, plays the walk of the selected point.
function render({ model, el }) {
  const image = make("img", { alt: model.get("alt"), src: model.get("picture"), draggable: false });
  const ring = make("div", { className: "ring", ariaHidden: "true" });
  const field = make("div", { className: "field", tabIndex: 0, attributes: { role: "group",
    "aria-label": `${model.get("name")}. The arrow keys select a walk, and Enter plays it.` } }, image, ring);
  const label = make("output", { className: "label" });
  const play = (textContent, index) => make("button", { type: "button", textContent, onclick: () => start(index()) });
  const buttons = make("div", { className: "buttons" },
    play("Play the selected walk", () => model.get("selected")),
    ...model.get("buttons").map(([text, index]) => play(text, () => index)));
  buttons.firstChild.classList.add("main");
  el.classList.add("wl-component", "wl-clickable-plot");
  el.append(field, label, buttons);

  function start(index) {
    select(index);
    model.send({ walk: index });
  }

  function select(index) {
    model.set("selected", index);
    model.save_changes();
    update();
  }

  function update() {
    const index = model.get("selected");
    const [x, y] = model.get("points")[index];
    ring.style.left = `${100 * x}%`;
    ring.style.top = `${100 * y}%`;
    label.textContent = model.get("labels")[index];
  }

  function nearest({ clientX, clientY }) {
    const box = image.getBoundingClientRect();
    const distances = model.get("points").map(([x, y]) =>
      Math.hypot(box.left + x * box.width - clientX, box.top + y * box.height - clientY));
    return distances.indexOf(Math.min(...distances));
  }

  image.onclick = (event) => start(nearest(event));
  image.onmousemove = (event) => { label.textContent = model.get("labels")[nearest(event)]; };
  image.onmouseleave = update;
  field.onkeydown = (event) => {
    const rows = model.get("n_rows");
    const moves = { ArrowLeft: -rows, ArrowRight: rows, ArrowUp: 1, ArrowDown: -1 };
    const move = moves[event.key];
    if (event.key === "Enter") start(model.get("selected"));
    else if (move) select(Math.min(Math.max(model.get("first"), model.get("selected") + move), model.get("points").length - 1));
    else return;
    event.preventDefault();
  };
  model.on("change:selected", update);
  update();
  return captureKeys(el);
}
export default { render };
