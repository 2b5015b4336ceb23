// Uses the page as a person does and leaves what it saw in the document.
"use strict";
const wait = ms => new Promise(done => setTimeout(done, ms));
const press = key => document.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
const read = id => document.getElementById(id).textContent;
const number = id => parseFloat(read(id));
/** Points of the canvas in a colour of the style. */
function inked(name) {
  const canvas = document.getElementById("view"), pen = canvas.getContext("2d");
  pen.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
  const colour = [1, 3, 5].map(k => parseInt(pen.fillStyle.slice(k, k + 2), 16));
  const points = pen.getImageData(0, 0, canvas.width, canvas.height).data;
  let found = 0;
  for (let i = 0; i < points.length; i += 4) if (colour.every((c, k) => points[i + k] === c)) found++;
  return found;
}
async function use() {
  const saw = {}, button = () => read("play"), scrub = document.getElementById("time");
  saw.at_first = button();
  await wait(60);
  if (button() === "Pause") press(" ");
  saw.paused = button();
  press("Home");
  saw.home_s = number("seconds");
  saw.home_power_w = number("power");
  saw.ink = Object.fromEntries(["link", "head", "edge", "force", "path", "current", "ink"].map(name => [name, inked(name)]));
  press("ArrowRight");
  press("ArrowRight");
  saw.two_s = number("seconds");
  saw.two_power_w = number("power");
  saw.two_value = scrub.value;
  press("ArrowLeft");
  saw.one_s = number("seconds");
  press("End");
  saw.end_s = number("seconds");
  saw.end_value = scrub.value === scrub.max;
  press("ArrowRight");
  saw.beyond_s = number("seconds");
  scrub.value = "10";
  scrub.dispatchEvent(new Event("input"));
  saw.scrubbed_s = number("seconds");
  saw.text = scrub.getAttribute("aria-valuetext");
  press(" ");
  saw.playing = button();
  await wait(400);
  saw.played_s = number("seconds");
  document.getElementById("play").click();
  saw.clicked = button();
  saw.framed = (document.getElementById("whole").click(), document.getElementById("whole").checked && inked("link") > 20);
  saw.title = document.title;
  saw.label = document.getElementById("view").getAttribute("aria-label");
  saw.wide = document.documentElement.scrollWidth <= window.innerWidth;
  saw.requests = performance.getEntriesByType("resource").length;
  saw.errors = window.seen_errors;
  return saw;
}
use().catch(error => ({ failed: String(error) })).then(saw => {
  const out = document.createElement("pre");
  out.id = "saw";
  out.textContent = JSON.stringify(saw);
  document.body.append(out);
});
