// Opens 3-D scenes on demand: the viewer is unpacked once, each scene gets a frame of its own.
(() => {
  let viewer = null;
  const bytes = id => Uint8Array.from(
    atob(document.getElementById(id).textContent.trim()), c => c.charCodeAt(0));
  const unpack = async () => {
    const stream = new Blob([bytes("scene-viewer")]).stream()
      .pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).text();
  };
  const open = async (button) => {
    const place = document.getElementById(button.getAttribute("aria-controls"));
    const chosen = button.getAttribute("aria-pressed") !== "true";
    button.parentElement.querySelectorAll("button").forEach(
      b => b.setAttribute("aria-pressed", b === button && chosen));
    place.replaceChildren();
    place.hidden = !chosen;
    if (!chosen) return;
    viewer ??= unpack();
    const page = await viewer;
    const state = document.getElementById(button.dataset.scene).textContent.trim();
    const call = "function loadDataSet() { OfflineLocalView.load(document.body, { base64Str: \""
      + state + "\" }); }";
    const frame = document.createElement("iframe");
    frame.title = button.textContent + ", drag to turn";
    const end = page.lastIndexOf("</body>");
    frame.srcdoc = page.slice(0, end) + "<script>" + call + "</" + "script>" + page.slice(end);
    place.replaceChildren(frame);
  };
  document.querySelectorAll("button[data-scene]").forEach(
    button => button.addEventListener("click", () => open(button)));

  // A link to a comparison opens the sheet it stands on, and those around it.
  const reveal = () => {
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    for (let node = target; node; node = node.parentElement)
      if (node.tagName === "DETAILS") node.open = true;
    target?.scrollIntoView();
  };
  addEventListener("hashchange", reveal);
  const finish = () => {
    document.documentElement.classList.add("whole");
    if (location.hash) reveal();
  };
  addEventListener("load", () => (self.requestIdleCallback ?? setTimeout)(finish));
})();
