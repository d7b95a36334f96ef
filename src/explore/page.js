// The page asks the server for everything: it draws nothing and computes no force. What is here
// moves values between fields, sliders and the address, and puts answers in their places.
"use strict";

const byId = (id) => document.getElementById(id);
const form = byId("fields");
// Steps of a slider, as its attributes have them.
const STEPS = 1000;
const POLL = 300;
const PLAY = 350;

// A field is asked about only where it is shown: not those of another hardening law, nor of a body
// that is not there.
const isShown = (field) => !field.closest("[hidden]");
const named = () => [...form.querySelectorAll("[name]")].filter(isShown);
const valueOf = (name) => {
  const field = named().find((one) => one.name === name);
  return field ? field.value : "";
};
// Not by form.elements, which a field of that name stands before.
const chosen = (name) => form.querySelector(`[name="${name}"]`).value;

// What depends on another field is shown or hidden.
function reveal() {
  // From the outside in: what is in a hidden part stays hidden.
  for (const part of form.querySelectorAll("[data-show]")) {
    const [name, words] = part.dataset.show.split("=");
    part.hidden = !words.split(",").includes(chosen(name));
  }
  for (const part of form.querySelectorAll("[data-law]")) {
    part.hidden = chosen(part.dataset.of) !== part.dataset.law;
  }
  const fixed = valueOf("path") === "case";
  const depth = byId("f-indentation");
  depth.readOnly = fixed;
  document.querySelector('[data-for="f-indentation"]').disabled = fixed;
}

function query() {
  const fields = new URLSearchParams();
  for (const field of named()) fields.append(field.name, field.value.trim());
  return fields.toString();
}

// Sliders.
function ends(slider) {
  const times = slider.dataset.times ? Number(valueOf(slider.dataset.times)) || 1 : 1;
  return [Number(slider.dataset.from) * times, Number(slider.dataset.to) * times];
}

function fieldOf(slider) {
  return byId(slider.dataset.for);
}

function short(value) {
  return String(Number(value.toPrecision(4)));
}

function place(slider) {
  const [from, to] = ends(slider);
  const value = Number(fieldOf(slider).value);
  const share =
    slider.dataset.scale === "log" ? Math.log(value / from) / Math.log(to / from) : (value - from) / (to - from);
  if (Number.isFinite(share)) slider.value = String(Math.round(STEPS * Math.min(1, Math.max(0, share))));
  slider.setAttribute("aria-valuetext", fieldOf(slider).value);
}

function take(slider) {
  const [from, to] = ends(slider);
  const share = Number(slider.value) / STEPS;
  const value = slider.dataset.scale === "log" ? from * (to / from) ** share : from + share * (to - from);
  fieldOf(slider).value = short(value);
  slider.setAttribute("aria-valuetext", fieldOf(slider).value);
}

function placeAll(but) {
  for (const slider of form.querySelectorAll("[data-for]")) if (slider !== but) place(slider);
}

// Asking: one request at a time, and the last state wins.
let asking = false;
let again = false;
let said = "";

// Browsers take an address a few times a second at the most.
let noting = 0;
function note(asked) {
  clearTimeout(noting);
  noting = setTimeout(() => history.replaceState(null, "", `?${asked}`), 150);
}

async function update() {
  if (asking) {
    again = true;
    return;
  }
  asking = true;
  const asked = query();
  note(asked);
  const drawings = byId("drawings");
  drawings.setAttribute("aria-busy", "true");
  try {
    const width = Math.round(
      Math.min(
        620,
        Math.max(320, drawings.clientWidth > 850 ? drawings.clientWidth / 2 - 30 : drawings.clientWidth - 16),
      ),
    );
    const answer = await fetch(`curves?${asked}&width=${width}`);
    if (answer.ok) show(await answer.json(), asked);
    else complain([await answer.text()]);
  } catch {
    complain(["The program does not answer any more. Start it again with: asperity explore"]);
  }
  asking = false;
  drawings.setAttribute("aria-busy", "false");
  if (again) {
    again = false;
    update();
  }
}

function complain(lines) {
  const list = lines.map((line) => {
    const paragraph = document.createElement("p");
    paragraph.textContent = line;
    return paragraph;
  });
  byId("wrong").replaceChildren(...list);
}

function mark(mistakes) {
  for (const field of form.querySelectorAll("[aria-invalid]")) {
    field.removeAttribute("aria-invalid");
    const told = byId(`${field.id}-wrong`);
    if (told) told.hidden = true;
  }
  const rest = [];
  for (const { field, what } of mistakes) {
    const found = named().find((one) => one.name === field);
    const told = found && byId(`${found.id}-wrong`);
    if (!told) {
      rest.push(field ? `${field}: ${what}` : what);
      continue;
    }
    found.setAttribute("aria-invalid", "true");
    told.textContent = what;
    told.hidden = false;
  }
  return rest;
}

function show(answer, asked) {
  const rest = mark(answer.mistakes);
  if (answer.problem) rest.push(answer.problem);
  complain(rest);
  document.body.classList.toggle("stale", rest.length > 0 || answer.mistakes.length > 0);
  for (const link of document.querySelectorAll("[data-export]")) link.href = `export/${link.dataset.export}?${asked}`;
  if (answer.mistakes.length > 0 || answer.problem) {
    say(answer.problem || `${answer.mistakes.length} of the fields cannot be taken`);
    return;
  }
  byId("regime").textContent = answer.regime;
  const warnings = answer.warnings.map(
    (text) => `Outside of what the law was made from: ${text}. Compare with a simulation.`,
  );
  list(byId("warnings"), warnings.concat(answer.doubts));
  byId("drawings").replaceChildren(...answer.drawings.map(figure));
  numbers(answer.numbers);
  byId("other").hidden = !answer.other;
  const number = (symbol) => answer.numbers.find((row) => row.symbol === symbol).law;
  // Not again for each step of a simulation.
  if (asked === said) return;
  said = asked;
  say(`F_N0 ${number("F_N0")}, greatest F_T ${number("F_T,max")}, Lambda ${number("Λ")}, ${answer.regime}`);
}

function list(where, lines) {
  where.hidden = lines.length === 0;
  where.replaceChildren(
    ...lines.map((line) => {
      const item = document.createElement("li");
      item.textContent = line;
      return item;
    }),
  );
}

// The server's pictures are drawings alone; whatever else might be in one is not taken over.
function picture(svg, words) {
  const drawn = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
  drawn.setAttribute("role", "img");
  drawn.setAttribute("aria-label", words);
  return document.importNode(drawn, true);
}

function figure({ name, title, svg, words, curves }) {
  const box = document.createElement("figure");
  box.id = `drawing-${name}`;
  box.append(picture(svg, `${title}. ${words}`));
  const caption = document.createElement("figcaption");
  const terms = document.createElement("dl");
  for (const curve of curves) {
    const term = document.createElement("dt");
    const about = document.createElement("dd");
    term.textContent = `${curve.name}:`;
    write(about, `${curve.source}. ${curve.trust}.`);
    terms.append(term, about);
  }
  caption.append(terms);
  box.append(caption);
  return box;
}

// F_N,slip as F with N,slip below.
function write(where, text) {
  for (const [i, part] of text.split(/_([A-Za-z0-9]+(?:,[a-z]+)?)/).entries()) {
    if (i % 2 === 0) {
      where.append(part);
      continue;
    }
    const sub = document.createElement("sub");
    sub.textContent = part;
    where.append(sub);
  }
  return where;
}

function numbers(rows) {
  byId("numbers").replaceChildren(
    ...rows.map((row) => {
      const line = document.createElement("tr");
      const head = document.createElement("th");
      head.scope = "row";
      write(head, row.words);
      line.append(head, write(document.createElement("td"), row.symbol));
      for (const [text, kind] of [
        [row.law, "number"],
        [row.closed, "number"],
        [row.simulation, "number"],
        [row.unit, ""],
      ]) {
        const cell = document.createElement("td");
        cell.textContent = text;
        if (kind) cell.className = kind;
        line.append(cell);
      }
      return line;
    }),
  );
}

// The pictures are as wide as there is room for them.
let resizing = 0;
addEventListener("resize", () => {
  clearTimeout(resizing);
  resizing = setTimeout(update, 200);
});

// What a screen reader says, when the values have stood for a moment.
let saying = 0;
function say(text) {
  clearTimeout(saying);
  saying = setTimeout(() => {
    byId("said").textContent = text;
  }, 900);
}

async function copy(text, told) {
  try {
    await navigator.clipboard.writeText(text);
    told.textContent = "copied";
  } catch {
    told.textContent = "the browser does not allow it; select and copy by hand";
  }
  say(told.textContent);
  setTimeout(() => {
    told.textContent = "";
  }, 4000);
}

function copyNumbers() {
  const lines = ["what\tsymbol\tlaw\tclosed form\tsimulation\tunit"];
  for (const row of byId("numbers").rows) lines.push([...row.cells].map((cell) => cell.textContent).join("\t"));
  copy(`${lines.join("\n")}\n`, byId("copied-numbers"));
}

// The simulation.
let polling = 0;
let simulated = "";

async function post(what) {
  const answer = await fetch(what, { method: "POST" });
  if (!answer.ok) complain([await answer.text()]);
  return answer.ok;
}

async function start() {
  if (await post(`simulate?${query()}`)) {
    say("the simulation has started");
    poll();
  }
}

let steps = -1;
async function poll() {
  clearTimeout(polling);
  let run;
  try {
    run = await (await fetch("simulation")).json();
  } catch {
    return;
  }
  const running = run.stage === "running";
  byId("simulate").disabled = running;
  byId("cancel").disabled = !running;
  byId("progress").hidden = !running;
  if (run.stage === "none") return;
  byId("progress").value = run.fraction;
  byId("simulated").textContent = `${run.stage}: ${run.message}`;
  byId("simulated").dataset.stage = run.stage;
  simulated = run.query;
  film(run.frames);
  const state = `${run.stage} ${run.steps}`;
  if (state !== steps) {
    steps = state;
    update();
  }
  if (running) polling = setTimeout(poll, POLL);
  else say(`the simulation is ${run.stage}`);
}

// The map of the contact along the shear.
let playing = 0;
let loading = false;

function film(frames) {
  byId("film").hidden = frames === 0;
  const slider = byId("frame");
  const atEnd = slider.value === slider.max;
  slider.max = String(Math.max(0, frames - 1));
  if (frames === 0) return;
  if (atEnd && !playing) slider.value = slider.max;
  if (byId("map").dataset.shown !== slider.value) frame();
}

async function frame() {
  if (loading) return;
  loading = true;
  const wanted = byId("frame").value;
  try {
    const answer = await fetch(`frame?frame=${wanted}&width=420&axes=${valueOf("axes")}`);
    if (answer.ok) {
      const { svg, words } = await answer.json();
      byId("map").replaceChildren(picture(svg, words));
      byId("map").dataset.shown = wanted;
    }
  } catch {
    stop();
  }
  loading = false;
  if (byId("frame").value !== wanted) frame();
}

function stop() {
  clearInterval(playing);
  playing = 0;
  byId("play").textContent = "Play";
}

function play() {
  if (playing) {
    stop();
    return;
  }
  const slider = byId("frame");
  if (slider.value === slider.max) slider.value = "0";
  byId("play").textContent = "Pause";
  frame();
  playing = setInterval(() => {
    if (slider.value === slider.max) stop();
    else {
      slider.value = String(Number(slider.value) + 1);
      frame();
    }
  }, PLAY);
}

form.addEventListener("submit", (event) => event.preventDefault());
form.addEventListener("input", (event) => {
  const slider = event.target.dataset.for ? event.target : null;
  if (slider) take(slider);
  reveal();
  placeAll(slider);
  if (event.target.id !== "study") update();
});
byId("simulate").addEventListener("click", start);
byId("cancel").addEventListener("click", () => post("cancel"));
byId("back").addEventListener("click", () => {
  location.search = `?${simulated}`;
});
byId("show-case").addEventListener("click", () => {
  location.search = `?${byId("study").value}`;
});
byId("copy-numbers").addEventListener("click", copyNumbers);
byId("copy-address").addEventListener("click", () => copy(location.href, byId("copied-address")));
byId("frame").addEventListener("input", () => {
  stop();
  frame();
});
byId("play").addEventListener("click", play);

// On a narrow screen the curves stand below the fields, and what is needed less often folds away.
if (matchMedia("(max-width: 56rem)").matches) {
  for (const part of form.querySelectorAll("details.later")) part.open = false;
}
reveal();
placeAll(null);
update();
poll();
