// Has the page looked at and used as by a reader: what is told of it.
// Events go to whatever lies uppermost at the middle of the scene, as those of a mouse do.
const find = selector => document.querySelector(selector);
const scenes = document.querySelectorAll("button[data-scene]");
const wait = time => new Promise(done => setTimeout(done, time));
const until = async (condition) => {
  for (let k = 0; k < 200 && !condition(); k++) await wait(50);
  if (!condition()) throw Error(`never: ${condition}`);
};
// Browsers capture pointers of real mice alone.
HTMLElement.prototype.setPointerCapture = () => {};
const middle = () => {
  const canvas = find(".scene canvas");
  canvas.scrollIntoView({ block: "center", behavior: "instant" });
  const { x, y, width, height } = canvas.getBoundingClientRect();
  return { clientX: x + width / 2, clientY: y + height / 2 };
};
const send = (kind, name, right = 0, deltaY = 0) => {
  const at = middle(), top = document.elementFromPoint(at.clientX, at.clientY);
  return top.dispatchEvent(new kind(name, {
    ...at, deltaY, clientX: at.clientX + right, bubbles: true, cancelable: true, pointerId: 1 }));
};
const drag = (right) => {
  send(PointerEvent, "pointerdown");
  for (const share of [0.25, 0.5, 0.75, 1]) send(PointerEvent, "pointermove", share * right);
  send(PointerEvent, "pointerup", right);
};
// Where the box is drawn: its red is far above the other colours, whatever the light.
const red = () => {
  const canvas = find(".scene canvas"), width = 200, height = 150;
  const copy = Object.assign(document.createElement("canvas"), { width, height });
  const plane = copy.getContext("2d");
  plane.drawImage(canvas, 0, 0, width, height);
  const { data } = plane.getImageData(0, 0, width, height);
  return Array.from({ length: width * height }, (_, k) =>
    data[4 * k] > Math.max(data[4 * k + 1], data[4 * k + 2]) + 60);
};
const share = pixels => pixels.filter(Boolean).length / pixels.length;
const changed = (one, other) => share(one.map((pixel, k) => pixel !== other[k]));
const told = { widths: {} };

await until(() => document.readyState === "complete");
told.images = [...document.images].map(image => image.complete && image.naturalWidth > 0);
const html = document.documentElement.outerHTML;
for (const width of [1280, 390]) {
  const frame = Object.assign(document.createElement("iframe"), { width, srcdoc: html });
  const loaded = new Promise(done => { frame.onload = done; });
  document.body.append(frame);
  await loaded;
  const page = frame.contentDocument, matrix = page.querySelector("table.adequacy");
  // More quantities than a page is wide: loads, responses, ten frequencies.
  const rows = width === 390 ? [] : [...matrix.rows];
  for (const row of rows)
    while (row.cells.length < 24) row.append(row.cells[row.cells.length - 1].cloneNode(true));
  if (rows.length) matrix.style.setProperty("--rows", 24);
  told.widths[width] = page.documentElement.scrollWidth;
  const boxes = [...matrix.querySelectorAll("th, td")].map(cell => cell.getBoundingClientRect());
  told.corners ??= {};
  told.corners[width] = ["right", "bottom"].map(side => Math.max(...boxes.map(box => box[side])));
  frame.remove();
}
find('main table a[href^="#legs"]').click();
await until(() => document.getElementById(location.hash.slice(1)).checkVisibility());

told.before = find(".scene canvas") === null;
scenes[0].click();
await until(() => find(".scene canvas") && share(red()) > 0);
told.pressed = scenes[0].ariaPressed;
let former = red();
told.drawn = share(former);
told.scrolls = send(WheelEvent, "wheel", 0, 200);
drag(120);
told.veiled = changed(former, red());
send(MouseEvent, "click");
drag(120);
told.turned = changed(former, red());
former = red();
told.scrollsBehind = send(WheelEvent, "wheel", 0, 200);
told.zoomed = changed(former, red());

scenes[1].click();
await until(() => find(".scene canvas")?.title.startsWith("(b)"));
scenes[1].click();
told.away = find(".scene canvas") === null;

scenes[2].click();
await until(() => find(".scene .pause") && share(red()) > 0);
middle();
former = red();
await until(() => changed(former, red()) > 0.02);
find(".scene .pause").click();
await wait(100);
former = red();
await wait(300);
told.still = changed(former, red());
told.asked = performance.getEntriesByType("resource").map(one => one.name);
return told;
