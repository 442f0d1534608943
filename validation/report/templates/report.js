// Opens 3-D scenes on demand: the viewer is unpacked once, each scene gets a frame of its own.
(() => {
  let viewer = null;
  const decoded = text => Uint8Array.from(atob(text.trim()), c => c.charCodeAt(0));
  const unpack = async () => {
    const packed = decoded(document.getElementById("scene-viewer").textContent);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).text();
  };
  const element = (name, properties) => Object.assign(document.createElement(name), properties);

  // The wheel scrolls the page until the scene is clicked, and again when the mouse has left it.
  const veiled = (place) => {
    const veil = element("button", {
      type: "button", className: "veil", textContent: "click to turn and zoom" });
    veil.addEventListener("click", () => { veil.hidden = true; });
    place.addEventListener("pointerleave", () => { veil.hidden = false; });
    return veil;
  };

  const PERIOD = 1600;  // ms
  const actorsOf = window => window.getRenderers().flatMap(renderer => renderer.getActors());
  const moving = (scene) => scene.motion?.parts.some(part => part) ?? false;

  // What is displaced swings about its place at rest (a mode), or leaves it and returns (a load).
  const animate = (frame, pause) => {
    const { scene, renderWindow } = frame.contentWindow.global;
    const actors = actorsOf(renderWindow);
    const parts = scene.motion.parts.flatMap((part, number) => {
      if (!part) return [];
      const data = actors[number].getMapper().getInputData();
      const drawn = Float32Array.from(data.getPoints().getData());
      const steps = new Int16Array(decoded(part.values).buffer);
      return [{ data, drawn, away: Float32Array.from(steps, value => value * part.step) }];
    });
    const swings = scene.motion.kind === "swing";
    let reached = 0, former = null;
    const step = (now) => {
      if (!frame.isConnected) return;
      requestAnimationFrame(step);
      const { top, bottom } = frame.getBoundingClientRect();
      const shown = bottom > 0 && top < innerHeight && pause.ariaPressed !== "true";
      reached += shown && former !== null ? now - former : 0;
      former = now;
      if (!shown) return;
      const turn = Math.cos(2 * Math.PI * reached / PERIOD);
      const part = swings ? turn : (1 + turn) / 2;
      for (const { data, drawn, away } of parts) {
        data.getPoints().setData(drawn.map((place, i) => place + (part - 1) * away[i]), 3);
        data.getPoints().modified();
        data.modified();
      }
      renderWindow.render();
    };
    requestAnimationFrame(step);
  };
  const ready = (frame) => new Promise(resolve => {
    const look = () => {
      const { scene, renderWindow } = frame.contentWindow?.global ?? {};
      const actors = renderWindow ? actorsOf(renderWindow) : [];
      const complete = scene && actors.length > 0 && actors.every(
        actor => actor.getMapper()?.getInputData()?.getPoints()?.getNumberOfPoints() > 0);
      if (complete) resolve(scene);
      else if (frame.isConnected) setTimeout(look, 50);
    };
    look();
  });

  const open = async (button) => {
    const place = document.getElementById(button.getAttribute("aria-controls"));
    const chosen = button.getAttribute("aria-pressed") !== "true";
    button.parentElement.querySelectorAll("button[data-scene]").forEach(
      b => b.setAttribute("aria-pressed", b === button && chosen));
    place.replaceChildren();
    place.hidden = !chosen;
    if (!chosen) return;
    viewer ??= unpack();
    const page = await viewer;
    const state = document.getElementById(button.dataset.scene).textContent.trim();
    const call = "function loadDataSet() { OfflineLocalView.load(document.body, { base64Str: \""
      + state + "\" }); }";
    const end = page.lastIndexOf("</body>");
    const frame = element("iframe", {
      title: button.textContent + ", drag to turn",
      srcdoc: page.slice(0, end) + "<script>" + call + "</" + "script>" + page.slice(end) });
    place.replaceChildren(frame, veiled(place));
    if (!moving(await ready(frame))) return;
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const pause = element("button", {
      type: "button", className: "pause", textContent: "stand still", ariaPressed: String(still) });
    pause.addEventListener("click", () => {
      pause.ariaPressed = String(pause.ariaPressed !== "true");
    });
    place.append(pause);
    animate(frame, pause);
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
