// A slider over the completed generations; at its right end it follows the latest one.
const LATEST = -1;
let n_sliders = 0;

function render({ model, el }) {
  el.classList.add("wl-component", "wl-generation");
  const id = `wl-generation-${n_sliders++}`;
  const send = (selected) => {
    model.set("selected", selected);
    model.save_changes();
  };
  const slider = make("input", { type: "range", id, min: 0, step: 1,
    oninput: () => send(Number(slider.value) === Number(slider.max) ? LATEST : Number(slider.value)) });
  const words = make("output", { className: "quiet", attributes: { for: id } });
  el.append(make("label", { htmlFor: id, textContent: "show generation", title: "the robots of this generation are shown below; generation 0 is random" }), slider, words);
  function update() {
    const last = model.get("n_generations") - 1, selected = model.get("selected");
    slider.max = Math.max(1, last);
    slider.disabled = last < 1;
    slider.value = selected === LATEST ? slider.max : selected;
    words.textContent = last < 0 ? "" : selected === LATEST ? `${last}, the latest` : `${selected} (of 0 to ${last})`;
    slider.setAttribute("aria-valuetext", `generation ${words.textContent}`);
  }
  for (const name of ["n_generations", "selected"]) model.on(`change:${name}`, update);
  update();
  return captureKeys(el);
}
export default { render };
