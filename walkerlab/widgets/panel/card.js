// The description of a robot. Parts that the user opened stay open when the description changes.
function render({ model, el }) {
  el.classList.add("wl-component", "wl-card");
  const parts = () => [...el.querySelectorAll("details")];
  const heading = (part) => part.querySelector("summary").textContent;
  const opened = new Set(); // headings, also of parts that the current robot lacks
  function update() {
    for (const part of parts()) opened[part.open ? "add" : "delete"](heading(part));
    el.innerHTML = model.get("value");
    for (const part of parts()) part.open = opened.has(heading(part));
  }
  model.on("change:value", update);
  update();
}
export default { render };
