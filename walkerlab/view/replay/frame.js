// Shows the preview image of a replay. A click opens the page with WebGL; closing or replacing the page brings the image back.
const MAX_OPEN_PAGES = 4; // maximum number for all replays in a notebook; browsers allow about 16 WebGL contexts
const TRIANGLE = '<svg viewBox="0 0 20 20" width="14" height="14" aria-hidden="true"><path d="M4 2 L18 10 L4 18 Z" fill="white"/></svg>';
const PLAY = "Play in 3D", LOADING = "Loading …";
const openPages = (globalThis.walkerlabOpenPages ??= []);

function render({ model, el }) {
  const picture = Object.assign(document.createElement("img"), { src: model.get("preview"), alt: model.get("alt") });
  const sign = document.createElement("span");
  const setSign = (text) => { sign.innerHTML = `${TRIANGLE}${text}`; };
  const cover = Object.assign(document.createElement("button"), { type: "button", title: "Play" });
  cover.dataset.lmSuppressShortcuts = ""; // otherwise typed letters are shortcuts of the notebook: x cuts the cell
  const box = document.createElement("div");
  box.style.cssText = "position: relative; max-width: 960px; background: white; border-radius: 6px; overflow: hidden";
  cover.style.cssText = "display: block; width: 100%; padding: 0; border: 0; background: none; cursor: pointer";
  picture.style.cssText = "display: block; width: 100%; max-width: 720px; margin: auto";
  sign.style.cssText = `width: max-content; margin: 6px 8px 4px auto; padding: 7px 14px 7px 12px; border-radius: 20px; font: 600 14px system-ui;
    color: white; background: #0072b2; display: flex; gap: 7px; align-items: center`;
  cover.append(sign, picture);
  box.append(cover);
  el.append(box);
  let frame = null;
  let isLoading = false;

  function setIsOpen(isOpen) { model.set("is_open", isOpen); model.save_changes(); }

  function close() {
    isLoading = false;
    setSign(PLAY);
    if (!frame) return;
    frame.contentWindow?.walkerlab?.close();
    box.replaceChildren(cover);
    frame = null;
    setIsOpen(false);
    openPages.splice(openPages.findIndex((page) => page.close === close), 1);
  }

  function pause() { frame?.contentWindow?.walkerlab?.pause(); }

  function show(page) {
    if (frame) return;
    frame = Object.assign(document.createElement("iframe"), { srcdoc: page, title: model.get("alt") });
    frame.style.cssText = "display: block; width: 100%; height: 460px; border: 0";
    const closeButton = Object.assign(document.createElement("button"), { type: "button", textContent: "✕",
      title: "Close the replay", ariaLabel: "Close the replay", onclick: close });
    closeButton.style.cssText = `position: absolute; right: 6px; top: 2px; width: 26px; height: 26px; border: 0; border-radius: 50%;
      background: #ffffffd0; color: #222; cursor: pointer`;
    box.replaceChildren(frame, closeButton);
    setIsOpen(true);
    openPages.forEach((page) => page.pause()); // only one plays at a time, for slow computers
    openPages.push({ close, pause });
    while (openPages.length > MAX_OPEN_PAGES) openPages[0].close();
  }

  function open() {
    const page = new TextDecoder().decode(model.get("page"));
    if (page) { show(page); return; }
    isLoading = true;
    setSign(LOADING);
    model.send({ request: "page" });
  }

  function showPreview() { // an open page, if any, belongs to the previous replay
    close();
    Object.assign(picture, { src: model.get("preview"), alt: model.get("alt") });
    box.hidden = !model.get("preview");
  }

  model.on("change:page", () => {
    if (!isLoading || !model.get("page").byteLength) return;
    isLoading = false;
    setSign(PLAY);
    open();
  });
  model.on("change:preview", showPreview);
  model.on("msg:custom", (message) => { if (message.play) { close(); open(); } });
  const observer = new IntersectionObserver(([{ isIntersecting }]) => isIntersecting || pause()); // pause when scrolled away
  observer.observe(box);
  cover.onclick = open;
  showPreview();
  return () => { observer.disconnect(); close(); };
}
export default { render };
