// The drawing of a world, and a button that puts another robot into it.
function render({ model, el }) {
  const picture = make("div", { className: "picture" });
  const another = make("button", { type: "button", textContent: "Another robot", onclick: () => model.send("another"),
    title: "put another robot, drawn by chance, at the start" });
  el.classList.add("wl-part", "wl-world");
  el.append(picture, another);

  const update = () => {
    picture.replaceChildren(drawn(model.get("picture")));
    another.hidden = !model.get("by_chance");
  };
  for (const name of ["picture", "by_chance"]) model.on(`change:${name}`, update);
  update();
  return own_keys(el);
}
export default { render };
