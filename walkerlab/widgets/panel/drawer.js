// Controls that continue the selected run, load run files, export a run, and copy its code.
const OTHER = "other file"; // value of the option that shows the field for a path
let n_views = 0;

/** URL of a file next to the notebook, in JupyterLab and Notebook 7; "" elsewhere. */
function fileUrl(path) {
  const config = document.getElementById("jupyter-config-data");
  const notebook = location.pathname.match(/\/(?:tree|notebooks)\/(.*\.ipynb)$/);
  if (!config || !notebook || path.startsWith("/") || path.startsWith("..")) return "";
  const folder = notebook[1].split("/").slice(0, -1).map((part) => `${part}/`).join("");
  const parts = path.split(/[\\/]/).map(encodeURIComponent).join("/");
  return `${JSON.parse(config.textContent).baseUrl}files/${folder}${parts}`;
}

function link(path) {
  const name = path.split(/[\\/]/).at(-1), href = fileUrl(path);
  return href ? make("a", { href, target: "_blank", rel: "noopener", textContent: name }) : make("span", { textContent: name });
}

function render({ model, el }) {
  el.classList.add("wl-component", "wl-drawer");
  const id = `wl-drawer-${n_views++}`;
  const button = (words, title, onclick) => make("button", { type: "button", title, textContent: words, onclick });

  // continue
  const more = make("input", { type: "number", min: 1, max: 10000, step: 1, ariaLabel: "number of further generations" });
  const source = make("select", { ariaLabel: "settings of the further generations" },
    make("option", { value: "run", textContent: "its own settings" }),
    make("option", { value: "form", textContent: "the settings of the form" }));
  const further = button("Continue this run", "evolve further generations of the selected run, in the same file",
    () => model.send({ further: Math.max(1, Math.round(more.valueAsNumber) || 1), with_form: source.value === "form" }));
  const continuation = make("div", { className: "row" }, further, make("label", {}, "for ", more, " generations"), make("label", {}, "with ", source));

  // load
  const files = make("select", { id: `${id}-files`, ariaLabel: "run file to load" });
  const path = make("input", { type: "text", placeholder: "path of a run file", ariaLabel: "path of the run file", hidden: true });
  const chosen = () => (files.value === OTHER ? path.value.trim() : files.value);
  const load = () => {
    if (chosen()) model.send({ load: chosen() });
    else { say("⚠ Write the path of a run file into the field, such as lab/run/run.walk."); path.focus(); }
  };
  let isChosen = false; // whether the user has chosen a file; otherwise the newest is proposed
  files.onchange = () => { isChosen = true; showWords(); path.hidden = files.value !== OTHER; if (!path.hidden) path.focus(); };
  path.onkeydown = ({ key }) => { if (key === "Enter") load(); };
  const loader = make("span", { className: "loader" }, files, path, button("Load", "add this run to the list", load));

  const use = button("Use these settings", "copy the settings of the selected run to the form", () => model.send({ settings: true }));
  const out = button("Export", "write report, replay, curve, data and champion of the selected run into its folder", () => model.send({ export: true }));
  const handIn = button("Hand in", "hand in the best robot of the selected run to the class", () => model.send({ hand_in: true }));
  handIn.hidden = !model.get("can_hand_in");
  const code = make("textarea", { readOnly: true, rows: 6, ariaLabel: "Python code that repeats this run", spellcheck: false });
  const copy = button("Copy as code", "copy Python code that repeats the selected run", async () => {
    details.open = true;
    code.select();
    try { await navigator.clipboard.writeText(code.value); } catch { document.execCommand("copy"); } // if the browser denies access to the clipboard
    say(`Copied. ${model.get("about_code")}`);
  });
  const details = make("details", {}, make("summary", { textContent: "Code of this run" }), code);
  const message = make("p", { className: "words", attributes: { role: "status" } });
  const say = (words) => {
    message.textContent = words;
    message.classList.toggle("fault", words.startsWith("⚠"));
  };
  const links = make("p", { className: "links" });
  el.append(continuation, make("div", { className: "row" }, handIn, out, copy, use), make("div", { className: "row" }, loader), message, links, details);

  function update() {
    const names = model.get("files");
    const before = files.value;
    files.replaceChildren(
      ...names.map(({ path: value, name }) => make("option", { value, textContent: name })),
      make("option", { value: OTHER, textContent: names.length ? "other file …" : "no other run" }));
    if (isChosen && [...files.options].some(({ value }) => value === before)) files.value = before;
    path.hidden = files.value !== OTHER;
    out.disabled = use.disabled = handIn.disabled = !model.get("can_export");
    further.disabled = more.disabled = source.disabled = !model.get("n_further");
    copy.disabled = !model.get("code");
    details.hidden = !model.get("code");
    if (code.value !== model.get("code")) code.value = model.get("code");
  }
  function updateFurther() { // does not replace a number that the user is typing
    if (document.activeElement !== more) more.value = model.get("n_further") || 10;
    update();
  }
  function updateLinks() {
    links.hidden = !model.get("exported").length;
    links.replaceChildren(...model.get("exported").flatMap((file, i) => (i ? [", ", link(file)] : [link(file)])));
  }
  for (const name of ["files", "code", "can_export"]) model.on(`change:${name}`, update);
  model.on("change:n_further", updateFurther);
  model.on("change:exported", updateLinks);
  const showWords = () => say(model.get("words"));
  for (const name of ["words", "files"]) model.on(`change:${name}`, showWords);
  showWords();
  updateFurther();
  updateLinks();
  return captureKeys(el);
}
export default { render };
