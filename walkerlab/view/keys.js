// Passes Shift Enter on to the notebook that shows this page, because a notebook does not receive the keys of a page in it.
addEventListener("keydown", ({ key, code, keyCode, shiftKey }) => {
  const cell = window.frameElement?.ownerDocument.querySelector(".jp-Cell.jp-mod-active");
  if (key !== "Enter" || !shiftKey || !cell) return;
  cell.focus({ preventScroll: true });
  cell.dispatchEvent(new KeyboardEvent("keydown", { key, code, keyCode, shiftKey, bubbles: true, cancelable: true }));
}, true);
