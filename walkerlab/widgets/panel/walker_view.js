// The caption of the walking robot, and the button that stops its motion.
function render({ model, el }) {
  el.classList.add("wl-component", "wl-walker-caption");
  const play = make("button", { type: "button", className: "small", textContent: "Play this one",
    title: "play the robot that was found while the replay was open", onclick: () => model.send("play") });
  const words = make("span", { className: "words", attributes: { role: "status" } });
  const motion = make("button", { type: "button", className: "small", onclick: () => {
    model.set("moves", !model.get("moves"));
    model.save_changes();
  } });
  el.append(words, play, motion);
  const update = () => {
    const news = model.get("news");
    el.classList.toggle("has-news", news !== "");
    words.textContent = news || model.get("words");
    play.hidden = news === "";
    motion.hidden = news !== "";
    motion.textContent = model.get("moves") ? "Stop motion" : "Start motion";
    motion.title = model.get("moves") ? "stop the motion of the picture" : "let the robot in the picture walk";
  };
  for (const name of ["words", "moves", "news"]) model.on(`change:${name}`, update);
  update();
  return captureKeys(el);
}
export default { render };
