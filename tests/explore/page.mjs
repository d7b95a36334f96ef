// Drives the page of `asperity explore` in a headless Chromium, as a person with a mouse, one with
// a keyboard alone, one with a screen reader and one with a phone would:
// node page.mjs PROGRAM [PICTURES]
// PICTURES is a directory for the screenshots of the documents.

import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { createRequire } from "node:module";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { chromium } from "playwright-core";

const [program, pictures] = process.argv.slice(2);
const scratch = fs.mkdtempSync(path.join(os.tmpdir(), "asperity-explore-"));
const axe = fs.readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const FLAGS = [
  "--disable-gpu",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];
const DONE = 90_000;

// A case on a coarse mesh: its simulation takes seconds.
const CASE = `sphere = { radius = 1.0 }
contact = { friction = 0.3 }
mesh = { elements_per_contact_radius = 4 }
units = { length = "mm", force = "N", stress = "MPa" }
path = [{ indentation = 0.02 }, { shear = "full-slip" }]
[material]
youngs_modulus = 200e3
poissons_ratio = 0.3
hardening = { law = "ideal", yield_stress = 400.0 }
`;

const began = Date.now();
function told(what) {
  console.log(`ok ${((Date.now() - began) / 1000).toFixed(1).padStart(6)} s  ${what}`);
}

function serve(...options) {
  const server = spawn(program, ["explore", ...options, "--no-browser", "--device", "cpu"], {
    stdio: ["ignore", "pipe", "pipe"],
  });
  return new Promise((resolve, reject) => {
    let text = "";
    server.stdout.on("data", (part) => {
      text += part;
      if (text.includes("\n")) resolve({ server, address: text.trim() });
    });
    server.on("exit", (code) => reject(new Error(`the program ended with ${code}`)));
  });
}

// The page after the answer to what was done last.
async function settled(page) {
  await page.waitForFunction(() => document.getElementById("drawings").getAttribute("aria-busy") === "false");
}

async function open(browser, address, options = {}) {
  const context = await browser.newContext({
    viewport: { width: 1280, height: 900 },
    acceptDownloads: true,
    permissions: ["clipboard-read", "clipboard-write"],
    ...options,
  });
  const page = await context.newPage();
  const faults = [];
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  page.on(
    "request",
    (request) =>
      request.url().startsWith(new URL(address).origin) ||
      request.url().startsWith("data:") ||
      faults.push(`asks for ${request.url()}`),
  );
  await page.goto(address);
  await page.waitForSelector("#drawings figure");
  await settled(page);
  return { page, faults, close: () => context.close() };
}

async function accessible(page, where) {
  // Not as a script of the page, which its policy forbids.
  await page.evaluate(axe);
  const result = await page.evaluate(async () => {
    const { violations } = await window.axe.run(document, { resultTypes: ["violations"] });
    return violations.map(
      (one) =>
        `${one.id}: ${one.help}: ${one.nodes
          .map((node) => node.target.join(" "))
          .slice(0, 4)
          .join(", ")}`,
    );
  });
  assert.deepEqual(result, [], `axe-core, ${where}`);
}

const numberOf = (page, symbol, column = 2) =>
  page.evaluate(
    ([symbol, column]) => {
      const row = [...document.querySelectorAll("#numbers tr")].find((line) => line.cells[1].textContent === symbol);
      return Number(row.cells[column].textContent);
    },
    [symbol, column],
  );

// Every control changes what is shown.
async function controls(page) {
  const shown = () =>
    page.evaluate(() => document.getElementById("drawings").innerHTML + document.getElementById("numbers").innerHTML);
  const changes = async (what, change, also = true) => {
    const before = await shown();
    await change();
    await settled(page);
    const invalid = await page.locator("[aria-invalid]").count();
    assert.equal(invalid, 0, `${what}: a field is refused: ${await page.locator(".wrong:visible").allTextContents()}`);
    assert.equal(await page.locator("#wrong p").count(), 0, `${what}: ${await page.locator("#wrong").textContent()}`);
    if (also) assert.ok((await shown()) !== before, `${what} changes nothing`);
  };
  const fill = (id, value) => changes(id, () => page.fill(id, value));
  const choose = (id, value, also) => changes(`${id} ${value}`, () => page.selectOption(id, value), also);
  for (const [id, value] of [
    ["#f-radius", "1.5"],
    ["#f-youngs_modulus", "150e3"],
    ["#f-poissons_ratio", "0.35"],
    ["#f-friction", "0.25"],
    ["#f-indentation", "0.015"],
  ])
    await fill(id, value);
  for (const law of ["elastic", "linear", "power", "hollomon", "voce", "table", "ideal"]) {
    await choose("#f-law", law);
    for (const field of await page.locator(`[data-of="law"][data-law="${law}"] input[type="text"]:not(.wide)`).all()) {
      const value = Number(await field.inputValue());
      await changes(`${law} ${await field.getAttribute("name")}`, () => field.fill(String(value * 1.1)));
    }
  }
  await choose("#f-law", "table");
  await fill("#f-table-points", "0 300; 0.1 500");
  await choose("#f-law", "ideal");
  for (const slider of await page.locator('#fields input[type="range"]:visible').all()) {
    const id = await slider.getAttribute("data-for");
    await changes(`the slider of ${id}`, () => slider.press("ArrowLeft"));
    assert.equal(await slider.getAttribute("aria-valuetext"), await page.inputValue(`#${id}`));
  }
  await choose("#f-opponent", "equal");
  await choose("#f-opponent", "sphere");
  await fill("#f-opponent-radius", "3");
  await choose("#f-opponent-material", "own", false);
  for (const [id, value] of [
    ["#f-other-youngs_modulus", "70e3"],
    ["#f-other-poissons_ratio", "0.33"],
  ])
    await fill(id, value);
  await choose("#f-other-law", "voce");
  await fill("#f-other-voce-rate", "12");
  await choose("#f-opponent", "flat");
  await choose("#f-opponent", "plane");
  // To full slip and back is what is drawn before.
  await choose("#f-path", "cycle", false);
  await fill("#f-displacement", "0.004");
  await choose("#f-axes", "none");
  await choose("#f-axes", "case");
  await choose("#f-elements", "4", false);
  told("every control changes what is shown");
}

async function mistakes(page) {
  const field = page.locator("#f-poissons_ratio");
  await field.fill("0.9");
  await settled(page);
  assert.equal(await field.getAttribute("aria-invalid"), "true");
  assert.match(await page.textContent("#f-poissons_ratio-wrong"), /Allowed/);
  await accessible(page, "with a mistake");
  await field.fill("0.3");
  await page.fill("#f-indentation", "0.4");
  await settled(page);
  assert.match(await page.textContent("#warnings"), /Outside of what the law was made from/);
  await page.fill("#f-indentation", "0.02");
  await settled(page);
  await page.selectOption("#f-opponent", "rigid");
  await settled(page);
  assert.match(await page.textContent("#wrong"), /rigid sphere/);
  await page.selectOption("#f-opponent", "plane");
  await settled(page);
  assert.equal(await page.locator("#wrong p").count(), 0);
  told("mistakes and warnings stand where they belong");
}

// What reload and another window show is the same page.
async function shared(browser, page) {
  // The address follows a moment later.
  await page.waitForTimeout(400);
  const address = page.url();
  const state = (page) =>
    page.evaluate(() => [
      document.getElementById("numbers").innerText,
      ...[...document.querySelectorAll("#fields [name]")]
        .filter((field) => field.checkVisibility())
        .map((field) => `${field.name}=${field.value}`),
    ]);
  const before = await state(page);
  await page.reload();
  await page.waitForSelector("#drawings figure");
  await settled(page);
  assert.deepEqual(await state(page), before);
  const other = await open(browser, address);
  assert.deepEqual(await state(other.page), before);
  assert.equal(other.page.url(), address);
  await other.close();
  await page.click("#copy-address");
  assert.equal(await page.evaluate(() => navigator.clipboard.readText()), address);
  await page.click("#copy-numbers");
  const copied = await page.evaluate(() => navigator.clipboard.readText());
  assert.ok(copied.startsWith("what\tsymbol\tlaw") && copied.includes(String(await numberOf(page, "FN0"))), copied);
  told("the address is the whole page; numbers are copied");
}

function run(command, args, cwd = scratch) {
  const { status, stdout, stderr } = spawnSync(command, args, { cwd, encoding: "utf8" });
  assert.equal(status, 0, `${command} ${args.join(" ")}: ${stderr}`);
  return stdout;
}

// Each format is kept, and used.
async function exports(page) {
  for (const link of await page.locator("[data-export]").all()) {
    const [download] = await Promise.all([page.waitForEvent("download"), link.click()]);
    await download.saveAs(path.join(scratch, download.suggestedFilename()));
  }
  run("tar", ["xf", "engine-c.tar"]);
  run("tar", ["xf", "engine-lammps.tar"]);
  run("cc", ["-std=c99", "-O2", "main.c", "-o", "main", "-lm"], path.join(scratch, "engine-c"));
  assert.match(run("./main", [], path.join(scratch, "engine-c")), /on a wall: restitution 0/);
  fs.writeFileSync(path.join(scratch, "one.c"), '#include "asperity_law.h"\nint main(void) { return 0; }\n');
  run("cc", ["-std=c99", "one.c", "-o", "one", "-lm"]);
  run("./one", []);
  run("python3", ["-c", "import asperity_law"]);
  assert.match(fs.readFileSync(path.join(scratch, "engine-lammps", "in.asperity"), "utf8"), /pair_coeff/);
  const csv = fs.readFileSync(path.join(scratch, "curves.csv"), "utf8").trim().split("\n");
  assert.equal(csv[0], "path,segment,h,delta_T,F_N,F_T");
  assert.ok(
    csv.length > 300 &&
      csv.slice(1).every((line) =>
        line
          .split(",")
          .slice(1)
          .every((cell) => Number.isFinite(Number(cell))),
      ),
  );
  run(program, ["run", "case.toml", "--out", "out", "--device", "cpu", "-q"]);
  const segments = fs
    .readFileSync(path.join(scratch, "out", "history.csv"), "utf8")
    .trim()
    .split("\n")
    .slice(1)
    .map((line) => line.split(",")[1]);
  assert.equal(new Set(segments).size, 5);
  told("each export is kept and can be used: the C runs, the case runs");
}

async function simulation(page) {
  const stage = () => page.getAttribute("#simulated", "data-stage");
  await page.selectOption("#f-path", "slip");
  await page.fill("#f-indentation", "0.01");
  await settled(page);
  await page.click("#simulate");
  await page.waitForFunction(() => document.getElementById("simulated").dataset.stage === "running");
  assert.ok(await page.isDisabled("#simulate"));
  await page.click("#cancel");
  await page.waitForFunction(() => document.getElementById("simulated").dataset.stage !== "running", null, {
    timeout: DONE,
  });
  assert.equal(await stage(), "cancelled");
  await page.click("#simulate");
  await page.waitForFunction(() => document.getElementById("simulated").dataset.stage === "running");
  // It can be watched: points come in while it runs.
  await page.waitForFunction(() => Number(document.getElementById("progress").value) > 0, null, { timeout: DONE });
  await page.waitForFunction(() => document.getElementById("simulated").dataset.stage === "done", null, {
    timeout: DONE,
  });
  await page.waitForFunction(
    () => document.querySelector("#numbers tr:nth-child(7)").cells[4].textContent !== "",
    null,
    { timeout: 10_000 },
  );
  const [law, simulated] = [await numberOf(page, "FN0"), await numberOf(page, "FN0", 4)];
  assert.ok(Math.abs(simulated / law - 1) < 0.08, `${law} ${simulated}`);
  assert.match(await page.textContent("#drawing-tangential figcaption"), /simulation:/);
  // The map plays.
  await page.waitForSelector("#map svg");
  await page.locator("#frame").focus();
  await page.keyboard.press("Home");
  await page.waitForFunction(() => document.getElementById("map").dataset.shown === "0");
  await page.click("#play");
  await page.waitForFunction(() => Number(document.getElementById("map").dataset.shown) > 1);
  await page.click("#play");
  assert.equal(await page.textContent("#play"), "Play");
  // Elsewhere it is not shown, and there is a way back.
  await page.fill("#f-friction", "0.1");
  await settled(page);
  await page.click("#back");
  await page.waitForSelector("#drawing-tangential figcaption:has-text('simulation:')");
  assert.equal(await page.inputValue("#f-friction"), "0.3");
  told("a simulation is started, cancelled, watched and laid over the law");
}

// With the keyboard alone: every control is reached, and does what it does.
async function keyboard(page) {
  await page.evaluate(() => {
    document.activeElement.blur();
    scrollTo(0, 0);
  });
  await page.locator("body").press("Tab");
  const seen = new Set();
  for (let i = 0; i < 120; i++) {
    const at = await page.evaluate(() => {
      const element = document.activeElement;
      if (!element || element === document.body) return "";
      const { outlineStyle } = getComputedStyle(element);
      const { id, dataset, className, textContent } = element;
      return `${id || dataset.for || dataset.export || className || textContent.trim()} ${outlineStyle}`;
    });
    if (at === "") break;
    assert.ok(!at.endsWith(" none"), `the focus cannot be seen at ${at}`);
    seen.add(at.replace(/ [a-z]+$/, ""));
    await page.keyboard.press("Tab");
  }
  const missing = await page.evaluate(() =>
    [...document.querySelectorAll("input, select, button, a, summary")]
      .filter((one) => one.checkVisibility() && !one.disabled)
      .map((one) => one.id || one.dataset.for || one.dataset.export || one.className || one.textContent.trim()),
  );
  assert.deepEqual(
    missing.filter((one) => !seen.has(one)),
    [],
  );
  const before = await numberOf(page, "FN0");
  await page.locator('[data-for="f-indentation"]').focus();
  for (let i = 0; i < 40; i++) await page.keyboard.press("ArrowRight");
  await settled(page);
  assert.ok((await numberOf(page, "FN0")) > before);
  await page.waitForFunction(() => document.getElementById("said").textContent.includes("F_N0"));
  told("the keyboard alone does everything, and what changes is said");
}

// From a key to the answer in its place, and to the first paint.
async function times(page, address) {
  const all = [];
  for (let i = 0; i < 12; i++) {
    all.push(
      await page.evaluate(
        () =>
          new Promise((resolve) => {
            const from = performance.now();
            const drawings = document.getElementById("drawings");
            new MutationObserver((_, observer) => {
              observer.disconnect();
              resolve(performance.now() - from);
            }).observe(drawings, { childList: true });
            const slider = document.querySelector('[data-for="f-friction"]');
            slider.value = String(Number(slider.value) + 7);
            slider.dispatchEvent(new Event("input", { bubbles: true }));
          }),
      ),
    );
    await settled(page);
  }
  await page.goto(address);
  await page.waitForSelector("#drawings figure");
  const paint = await page.evaluate(
    () => performance.getEntriesByType("paint").find((one) => one.name === "first-contentful-paint").startTime,
  );
  const size = await page.evaluate(() =>
    [...performance.getEntriesByType("resource"), ...performance.getEntriesByType("navigation")]
      .filter((one) => !one.name.includes("/curves") && !one.name.includes("/simulation"))
      .reduce((sum, one) => sum + one.encodedBodySize, 0),
  );
  all.sort((a, b) => a - b);
  const [median, worst] = [all[6], all[11]].map((time) => Math.round(time));
  const slider = `answer to a slider, in the browser: median ${median} ms, worst ${worst} ms of 12`;
  console.log(`${slider}; first paint ${Math.round(paint)} ms; page ${size} bytes`);
  // The aims are 100 and 300 ms on two free cores. Here others may have them: three times as
  // long, and the middle one.
  assert.ok(median < 300 && paint < 900 && size < 200_000);
}

async function looks(browser, address) {
  for (const [name, width, colorScheme] of [
    ["explore", 1280, "light"],
    ["explore-phone", 390, "dark"],
  ]) {
    // A phone's picture begins at the top of the page and ends below the first curves.
    const narrow = width < 500;
    const { page, faults, close } = await open(browser, address, {
      viewport: { width, height: narrow ? 1700 : 900 },
      colorScheme,
    });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
    assert.ok(wide <= 0, `${wide} pixels stick out at a width of ${width}`);
    await accessible(page, `${width} pixels wide, ${colorScheme}`);
    if (pictures) await page.screenshot({ path: path.join(pictures, `${name}.png`), fullPage: !narrow });
    await page.emulateMedia({ media: "print" });
    assert.ok(!(await page.isVisible("#simulate")) && (await page.isVisible("#drawing-press")));
    assert.deepEqual(faults, []);
    await close();
  }
  told("axe-core finds nothing, light and dark, at two widths; nothing sticks out");
}

async function closed(browser, address, server) {
  const { page, close } = await open(browser, address);
  await page.selectOption("#f-elements", "8");
  await page.click("#simulate");
  await page.waitForFunction(() => document.getElementById("simulated").dataset.stage === "running");
  await close();
  const again = await open(browser, address);
  assert.equal(await again.page.getAttribute("#simulated", "data-stage"), "running");
  let said = "";
  server.stderr.on("data", (part) => {
    said += part;
  });
  server.removeAllListeners("exit");
  const ended = new Promise((resolve) => server.on("exit", resolve));
  server.kill("SIGINT");
  assert.equal(await ended, 0);
  assert.match(said, /the simulation that was running is cancelled/);
  await again.page.fill("#f-friction", "0.2");
  await again.page.waitForFunction(() => document.getElementById("wrong").textContent.includes("does not answer"));
  await again.close();
  told("a closed page does no harm; Ctrl-C ends the server, and the page says so");
}

async function main() {
  const file = path.join(scratch, "sphere.toml");
  fs.writeFileSync(file, CASE);
  const { server, address } = await serve(file);
  const sandbox = process.getuid?.() === 0 ? ["--no-sandbox"] : [];
  const browser = await chromium.launch({
    executablePath: process.env.ASPERITY_CHROMIUM || "/usr/bin/chromium",
    args: [...FLAGS, ...sandbox],
  });
  try {
    const { page, faults, close } = await open(browser, address);
    await times(page, address);
    await settled(page);
    await controls(page);
    await mistakes(page);
    await shared(browser, page);
    await exports(page);
    await page.goto(address);
    await settled(page);
    await simulation(page);
    await accessible(page, "with a simulation");
    await page.waitForTimeout(400);
    await looks(browser, page.url());
    await keyboard(page);
    assert.deepEqual(faults, []);
    await close();
    await closed(browser, address, server);
  } finally {
    await browser.close();
    server.kill("SIGKILL");
    fs.rmSync(scratch, { recursive: true, force: true });
  }
}

await main();
process.exit(0);
