// Controls that load run files, export a run, and copy its code.
let n_views = 0;

function render({ model, el }) {
  el.classList.add("wl-component", "wl-drawer");
  const id = `wl-drawer-${n_views++}`;
  const button = (words, title, onclick) => make("button", { type: "button", title, textContent: words, onclick });

  const path = make("input", { type: "text", id, placeholder: "run file", ariaLabel: "run file to load, or its folder", attributes: { list: `${id}-files` } });
  const files = make("datalist", { id: `${id}-files` });
  const load = () => path.value.trim() && model.send({ load: path.value.trim() });
  path.onkeydown = ({ key }) => { if (key === "Enter") load(); };
  const use = button("Use its settings", "copy the settings of the selected run to the form", () => model.send({ settings: true }));
  const out = button("Export", "write report, replay, curve, data and champion of the selected run into its folder", () => model.send({ export: true }));
  const code = make("textarea", { readOnly: true, rows: 6, ariaLabel: "Python code that repeats this run", spellcheck: false });
  const copy = button("Copy as code", "copy Python code that repeats the selected run", async () => {
    details.open = true;
    code.select();
    try { await navigator.clipboard.writeText(code.value); } catch { document.execCommand("copy"); } // if the browser denies access to the clipboard
    message.textContent = "Copied. In a notebook cell, the code repeats the run and gives the same table.";
  });
  const details = make("details", {}, make("summary", { textContent: "Code of this run" }), code);
  const message = make("p", { className: "words", attributes: { role: "status" } });
  const loader = make("span", { className: "loader" }, path, files, button("Load", "add this run to the list", load));
  el.append(make("div", { className: "row" }, out, copy, use, loader), message, details);

  function update() {
    files.replaceChildren(...model.get("files").map((value) => make("option", { value })));
    out.disabled = use.disabled = !model.get("can_export");
    copy.disabled = !model.get("code");
    details.hidden = !model.get("code");
    if (code.value !== model.get("code")) code.value = model.get("code");
  }
  for (const name of ["files", "code", "can_export"]) model.on(`change:${name}`, update);
  model.on("change:words", () => { message.textContent = model.get("words"); });
  message.textContent = model.get("words");
  update();
  return captureKeys(el);
}
export default { render };
