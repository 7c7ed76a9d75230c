// Shows the preview image of a replay. A click opens the page with WebGL; closing or replacing the page brings the image back.
const MAX_OPEN_PAGES = 4; // maximum number for all replays in a notebook; browsers allow about 16 WebGL contexts
const TRIANGLE = '<svg viewBox="0 0 20 20" width="14" height="14" aria-hidden="true"><path d="M4 2 L18 10 L4 18 Z" fill="white"/></svg>';
const PLAY = "Play in 3D", LOADING = "Loading …";
const SVG_URL = "data:image/svg+xml;base64,";
const RATES = { hardware: { idle: 25, busy: 25 }, software: { idle: 10, busy: 2 } }; // pictures of an animated preview per second
const openPages = (globalThis.walkerlabOpenPages ??= []);

// Returns how the browser draws pages: without a graphics card, each change of a picture takes some 25 ms of a core.
function renderer() {
  if (!globalThis.walkerlabRenderer) {
    const context = document.createElement("canvas").getContext("webgl");
    const name = context?.getParameter(context.getExtension("WEBGL_debug_renderer_info")?.UNMASKED_RENDERER_WEBGL ?? context.RENDERER);
    context?.getExtension("WEBGL_lose_context")?.loseContext();
    globalThis.walkerlabRenderer = !name || /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name) ? "software" : "hardware";
  }
  return globalThis.walkerlabRenderer;
}

// Plays an animated SVG at a limited rate; as an image, it would be drawn 60 times per second. Returns null for other images.
// A rate of 0 shows the picture at rest.
function playSvg(url) {
  const text = url.startsWith(SVG_URL) ? new TextDecoder().decode(Uint8Array.from(atob(url.slice(SVG_URL.length)), (letter) => letter.charCodeAt(0))) : "";
  if (!text.includes("<animate") || matchMedia("(prefers-reduced-motion: reduce)").matches) return null;
  const host = document.createElement("div");
  const svg = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
  svg.style.cssText = "display: block; width: 100%; height: auto; border-radius: 6px";
  host.style.cssText = "display: block; width: 100%; margin: 0; padding: 0";
  host.attachShadow({ mode: "open" }).append(svg); // the IDs in the picture are those of other pictures, too
  svg.pauseAnimations();
  let timer = 0;
  const setRate = (rate) => {
    clearInterval(timer);
    timer = rate > 0 ? setInterval(() => { if (!document.hidden) svg.setCurrentTime(svg.getCurrentTime() + 1 / rate); }, 1000 / rate) : 0;
  };
  return { host, setRate };
}

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
  let moving = null; // the animated picture, if there is one
  let isVisible = false;
  let wasPlaying = false; // whether the replay was playing when it was scrolled away

  const updateRate = () => moving?.setRate(isVisible && !frame ? RATES[renderer()][model.get("is_busy") ? "busy" : "idle"] : 0);

  function setIsOpen(isOpen) { model.set("is_open", isOpen); model.save_changes(); }

  function close() {
    isLoading = false;
    setSign(PLAY);
    if (!frame) return;
    frame.contentWindow?.walkerlab?.close();
    box.replaceChildren(cover);
    frame = null;
    updateRate();
    setIsOpen(false);
    openPages.splice(openPages.findIndex((page) => page.close === close), 1);
  }

  const player = () => frame?.contentWindow?.walkerlab;

  function pause() { player()?.pause(); }

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
    openPages.push({ close, pause: () => { wasPlaying = false; pause(); } });
    updateRate();
    while (openPages.length > MAX_OPEN_PAGES) openPages[0].close();
  }

  function open() {
    const page = new TextDecoder().decode(model.get("page"));
    if (page) { show(page); return; }
    isLoading = true;
    setSign(LOADING);
    model.send({ request: "page", number: model.get("number") });
  }

  function showPreview() { // an open page, if any, belongs to the previous replay
    close();
    moving?.setRate(0);
    moving = playSvg(model.get("preview"));
    Object.assign(picture, { src: model.get("preview"), alt: model.get("alt") });
    if (moving) cover.ariaLabel = model.get("alt"); else cover.removeAttribute("aria-label");
    cover.replaceChildren(sign, moving?.host ?? picture);
    box.hidden = !model.get("preview");
    updateRate();
  }

  model.on("change:page", () => {
    if (!isLoading || !model.get("page").byteLength) return;
    isLoading = false;
    setSign(PLAY);
    open();
  });
  model.on("change:preview", showPreview);
  model.on("msg:custom", ({ play, stop, reveal }) => {
    if (play || stop) close();
    if (play) open();
    if (reveal) box.scrollIntoView({ block: "nearest", behavior: "smooth" });
  });
  const observer = new IntersectionObserver((entries) => { // pause while scrolled away
    isVisible = entries.at(-1).isIntersecting;
    updateRate();
    if (isVisible && wasPlaying) player()?.play();
    if (!isVisible) { wasPlaying = Boolean(player()?.state.playing); pause(); }
  });
  model.on("change:is_busy", updateRate);
  observer.observe(box);
  cover.onclick = open;
  showPreview();
  return () => { observer.disconnect(); moving?.setRate(0); close(); };
}
export default { render };
