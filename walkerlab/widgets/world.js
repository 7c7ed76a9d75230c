// The drawing of a world, and a button for another random robot.
function render({ model, el }) {
  const picture = make("div", { className: "picture" });
  const another = make("button", { type: "button", textContent: "Another robot", onclick: () => model.send("another"),
    title: "show another random robot at the start" });
  el.classList.add("wl-component", "wl-world");
  const note = make("span", { className: "note", textContent: "drawing …", attributes: { role: "status" } });
  const legend = make("span", { className: "legend" });
  el.append(picture, legend, note, another);

  const update = () => {
    picture.replaceChildren(parseSvg(model.get("picture")));
    legend.textContent = model.get("legend");
    another.hidden = legend.hidden = !model.get("by_chance");
  };
  const mark = () => el.classList.toggle("outdated", model.get("is_outdated"));
  model.on("change:is_outdated", mark);
  for (const name of ["picture", "legend", "by_chance"]) model.on(`change:${name}`, update);
  update();
  return captureKeys(el);
}
export default { render };
