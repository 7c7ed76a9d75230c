// The caption of the walking robot, and the button that stops its motion.
function render({ model, el }) {
  el.classList.add("wl-component", "wl-walker-caption");
  const words = make("span", { className: "words", attributes: { role: "status" } });
  const motion = make("button", { type: "button", className: "small", onclick: () => {
    model.set("moves", !model.get("moves"));
    model.save_changes();
  } });
  el.append(words, motion);
  const update = () => {
    words.textContent = model.get("words");
    motion.textContent = model.get("moves") ? "Stop motion" : "Start motion";
    motion.title = model.get("moves") ? "stop the motion of the picture" : "let the robot in the picture walk";
  };
  for (const name of ["words", "moves"]) model.on(`change:${name}`, update);
  update();
  return captureKeys(el);
}
export default { render };
