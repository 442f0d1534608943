// Opens 3-D scenes on demand, and the folded sheets to which links lead.
(() => {
  const open = (button) => {
    const place = document.getElementById(button.getAttribute("aria-controls"));
    const chosen = button.getAttribute("aria-pressed") !== "true";
    button.parentElement.querySelectorAll("button[data-scene]").forEach(
      b => b.setAttribute("aria-pressed", b === button && chosen));
    place.replaceChildren();
    place.hidden = !chosen;
    if (chosen) showScene(place, document.getElementById(button.dataset.scene).textContent);
  };
  document.querySelectorAll("button[data-scene]").forEach(
    button => button.addEventListener("click", () => open(button)));

  // A link to a comparison opens the folded sheet that contains it, and all sheets around that.
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
