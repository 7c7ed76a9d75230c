// A picture first; the page with its WebGL when it is clicked; a picture again when it is closed, or another walk comes.
const MOST = 4; // pages at once, of all replays of a notebook: browsers keep some 16 WebGL contexts
const TRIANGLE = '<svg viewBox="0 0 20 20" width="14" height="14" aria-hidden="true"><path d="M4 2 L18 10 L4 18 Z" fill="white"/></svg>';
const live = (globalThis.walkerlabLive ??= []);

function render({ model, el }) {
  const picture = Object.assign(document.createElement("img"), { src: model.get("poster"), alt: model.get("alt") });
  const sign = document.createElement("span");
  const say = (words) => { sign.innerHTML = `${TRIANGLE}${words}`; };
  const cover = Object.assign(document.createElement("button"), { type: "button", title: "Play" });
  cover.dataset.lmSuppressShortcuts = ""; // or a letter typed on it would be the notebook's: x cuts the cell
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

  function tell(open) { model.set("is_open", open); model.save_changes(); }

  function close() {
    say("Play in 3D");
    if (!frame) return;
    frame.contentWindow?.walkerlab?.close();
    box.replaceChildren(cover);
    frame = null;
    tell(false);
    live.splice(live.findIndex((one) => one.close === close), 1);
  }

  function pause() { frame?.contentWindow?.walkerlab?.pause(); }

  function show(page) {
    if (frame) return;
    frame = Object.assign(document.createElement("iframe"), { srcdoc: page, title: model.get("alt") });
    frame.style.cssText = "display: block; width: 100%; height: 460px; border: 0";
    const stop = Object.assign(document.createElement("button"), { type: "button", textContent: "✕",
      title: "close the replay, back to its picture", ariaLabel: "close the replay", onclick: close });
    stop.style.cssText = `position: absolute; left: 8px; top: 8px; width: 26px; height: 26px; border: 0; border-radius: 50%;
      background: #ffffffd0; color: #222; cursor: pointer`;
    box.replaceChildren(frame, stop);
    tell(true);
    live.forEach((other) => other.pause()); // one at a time: a slow computer draws no more
    live.push({ close, pause });
    while (live.length > MOST) live[0].close();
  }

  function open() {
    const page = new TextDecoder().decode(model.get("page"));
    if (page) show(page);
    else { say("One moment …"); model.send({ want: "page" }); }
  }

  function renew() { // another walk: what is open is of the one before
    close();
    Object.assign(picture, { src: model.get("poster"), alt: model.get("alt") });
    box.hidden = !model.get("poster");
  }

  const asked = () => sign.textContent.startsWith("One moment");
  model.on("change:page", () => { if (asked() && model.get("page").byteLength) { say("Play in 3D"); open(); } });
  model.on("change:poster", renew);
  model.on("msg:custom", (message) => { if (message.play) { close(); open(); } });
  const watch = new IntersectionObserver(([{ isIntersecting }]) => isIntersecting || pause()); // scrolled away
  watch.observe(box);
  cover.onclick = open;
  renew();
  return () => { watch.disconnect(); close(); };
}
export default { render };
