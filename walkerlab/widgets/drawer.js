// Run files to load, a run to export, and its code to copy.
let made = 0;

function render({ model, el }) {
  el.classList.add("wl-part", "wl-drawer");
  const id = `wl-drawer-${made++}`;
  const button = (words, title, onclick) => make("button", { type: "button", title, textContent: words, onclick });

  const path = make("input", { type: "text", id, placeholder: "a run file", ariaLabel: "a run file to load, or its folder", attributes: { list: `${id}-files` } });
  const files = make("datalist", { id: `${id}-files` });
  const load = () => path.value.trim() && model.send({ load: path.value.trim() });
  path.onkeydown = ({ key }) => { if (key === "Enter") load(); };
  const back = button("Take its settings", "move the form to the settings of the chosen run", () => model.send({ settings: true }));
  const out = button("Export", "write report, replay, curve, data and champion of the chosen run into its folder", () => model.send({ export: true }));
  const code = make("textarea", { readOnly: true, rows: 6, ariaLabel: "the Python that repeats this run", spellcheck: false });
  const copy = button("Copy as code", "copy the Python that does the same run", async () => {
    details.open = true;
    code.select();
    try { await navigator.clipboard.writeText(code.value); } catch { document.execCommand("copy"); } // where a page is not trusted with it
    said.textContent = "Copied: paste it into a cell, and it gives the same table.";
  });
  const details = make("details", {}, make("summary", { textContent: "This run as code" }), code);
  const said = make("p", { className: "words", attributes: { role: "status" } });
  el.append(make("div", { className: "row" }, out, copy, back, path, files, button("Load", "put this run into the list", load)), said, details);

  function update() {
    files.replaceChildren(...model.get("files").map((value) => make("option", { value })));
    out.disabled = back.disabled = !model.get("can_export");
    copy.disabled = !model.get("code");
    details.hidden = !model.get("code");
    if (code.value !== model.get("code")) code.value = model.get("code");
  }
  for (const name of ["files", "code", "can_export"]) model.on(`change:${name}`, update);
  model.on("change:words", () => { said.textContent = model.get("words"); });
  said.textContent = model.get("words");
  update();
  return own_keys(el);
}
export default { render };
