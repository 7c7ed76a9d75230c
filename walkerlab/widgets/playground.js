// A picture of a robot; a click opens the page on which it walks live. The text of its genome is synchronised with Python.
const POLL_TIME = 100; // ms between two checks whether the page has started
const MAX_OPEN_PAGES = 4; // of replays and playgrounds together; browsers allow about 16 WebGL contexts
const openPages = (globalThis.walkerlabOpenPages ??= []);

function render({ model, el }) {
  const picture = make("img", { src: model.get("preview"), alt: model.get("alt") });
  const sign = make("span");
  const cover = make("button", { type: "button", className: "cover", title: "Walk live" }, sign, picture);
  const undo = make("button", { type: "button", className: "undo", textContent: "Undo your changes", onclick: () => {
    model.set("gene_text", model.get("original"));
    model.save_changes();
  } });
  const box = make("div", {}, cover, undo);
  let frame = null, timer = 0, isLoading = false, isRemoved = false; // a removed widget has no connection to Python
  el.classList.add("wl-component", "wl-playground");
  el.append(box);

  const offer = () => { // the robot walks with the changes that were made before the page was closed
    undo.hidden = model.get("gene_text") === model.get("original");
    sign.textContent = undo.hidden ? "Walk live" : "Walk live, with your changes";
  };
  const live = () => frame?.contentWindow?.walkerlab;

  function setIsOpen(isOpen) { if (isRemoved) return; model.set("is_open", isOpen); model.save_changes(); }

  function close() {
    clearInterval(timer);
    isLoading = false;
    offer();
    if (!frame) return;
    live()?.close();
    frame = null;
    box.replaceChildren(cover, undo);
    openPages.splice(openPages.findIndex((page) => page.close === close), 1);
    setIsOpen(false);
  }

  function pause() { live()?.pause(); }

  function show(page) {
    if (frame) return;
    frame = make("iframe", { srcdoc: page, title: model.get("alt"), allow: "clipboard-write" });
    box.replaceChildren(frame, make("button", { type: "button", className: "close", textContent: "Close", onclick: close }));
    openPages.forEach((other) => other.pause()); // only one page plays at a time, for slow computers
    openPages.push({ close, pause });
    while (openPages.length > MAX_OPEN_PAGES) openPages[0].close();
    box.scrollIntoView({ block: "nearest", behavior: "smooth" }); // otherwise its buttons can be below the screen's edge
    timer = setInterval(() => {
      if (!live()) return;
      clearInterval(timer);
      if (live().genome !== model.get("gene_text")) live().setGenome(model.get("gene_text"));
      live().onGenome((text) => { model.set("gene_text", text); model.save_changes(); });
      setIsOpen(true);
    }, POLL_TIME);
  }

  cover.onclick = () => {
    isLoading = true;
    sign.textContent = "Loading …";
    model.send("page");
  };
  model.on("change:gene_text", () => { if (!isLoading) offer(); if (live() && live().genome !== model.get("gene_text")) live().setGenome(model.get("gene_text")); });
  model.on("msg:custom", (message, buffers) => {
    if (message === "page" && isLoading) show(new TextDecoder().decode(buffers[0]));
    isLoading = false;
  });
  const observer = new IntersectionObserver(([{ isIntersecting }]) => isIntersecting || pause()); // pause when scrolled away
  observer.observe(box);
  const release = captureKeys(el);
  offer();
  if (model.get("opens_at_once")) cover.onclick();
  return () => { isRemoved = true; observer.disconnect(); release(); close(); };
}
export default { render };
