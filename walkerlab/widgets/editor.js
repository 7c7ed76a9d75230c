// A text editor for a genome. Behind the text area is a transparent copy of its text, in which the error is marked.
const PAUSE = 150; // ms without a key press until the text is sent

let n_views = 0;

function render({ model, el }) {
  const id = `wl-editor-${n_views++}`;
  const area = make("textarea", { id, spellcheck: false, autocapitalize: "off", autocomplete: "off", rows: 11,
    attributes: { "aria-describedby": `${id}-fault` } });
  const behind = make("div", { className: "behind", ariaHidden: "true" });
  const label = make("label", { htmlFor: id, textContent: "Genome" });
  const fault = make("span", { id: `${id}-fault` });
  const show = make("button", { type: "button", textContent: "Show the error", onclick: () => {
    area.focus();
    area.setSelectionRange(...model.get("fault_range"));
    area.scrollTop = behind.querySelector("mark").offsetTop - area.clientHeight / 2;
  } });
  const notes = make("ul", { className: "notes" });
  const messages = make("div", { className: "messages", attributes: { role: "status" } },
    make("p", { className: "fault" }, fault, show), notes);
  const picture = make("div", { className: "picture" });
  const walk = make("button", { type: "button", className: "main", textContent: "Play its walk", onclick: () => press("walk") });
  const insert = make("button", { type: "button", textContent: "Insert into the next generation", onclick: () => press("insert") });
  el.classList.add("wl-component", "wl-editor");
  el.append(
    make("div", { className: "gene" }, label, make("div", { className: "sheet" }, behind, area), messages),
    make("div", { className: "robot" }, picture, make("div", { className: "buttons" }, walk, insert)));

  let timer = 0;

  function send() {
    clearTimeout(timer);
    timer = 0;
    model.set("text", area.value);
    model.save_changes();
  }

  function press(button) {
    if (timer) send(); // so that the button acts on the current text
    model.send({ press: button });
  }

  function mark() {
    const [start, end] = timer ? [] : model.get("fault_range"); // unknown until the text is sent
    const text = area.value;
    const word = make("mark", { textContent: text.slice(start, end) || " " });
    behind.replaceChildren(...(start === undefined ? [text] : [text.slice(0, start), word, text.slice(end)]), "\n");
    behind.scrollTop = area.scrollTop;
  }

  function write() {
    if (timer || area.value === model.get("text")) return;
    area.value = model.get("text");
    mark();
  }

  function update() {
    const wrong = Boolean(model.get("fault"));
    fault.textContent = wrong ? `⚠ ${model.get("fault")}` : "";
    show.hidden = !model.get("fault_range").length;
    area.setAttribute("aria-invalid", wrong);
    notes.replaceChildren(...model.get("notes").map((textContent) => make("li", { textContent })));
    walk.hidden = !model.get("buttons").includes("walk");
    insert.hidden = !model.get("buttons").includes("insert");
    walk.disabled = wrong;
    insert.disabled = wrong || !model.get("can_insert");
    picture.classList.toggle("outdated", wrong);
    mark();
  }

  const draw = () => picture.replaceChildren(parseSvg(model.get("picture")));

  area.oninput = () => {
    clearTimeout(timer);
    timer = setTimeout(send, PAUSE);
    mark();
  };
  area.onscroll = () => { behind.scrollTop = area.scrollTop; };
  model.on("change:text", write);
  for (const name of ["fault", "fault_range", "notes", "can_insert", "buttons"]) model.on(`change:${name}`, update);
  model.on("change:picture", draw);
  write();
  update();
  if (model.get("picture")) draw();
  const releaseKeys = captureKeys(el);
  return () => { releaseKeys(); if (timer) send(); };
}
export default { render };
