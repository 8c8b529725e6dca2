// The page of `trainsafe serve`. The text of the train file is the only state: controls change it through the program, and
// every change is answered with the reader's messages, or with a new report and the numbers of its figures.
"use strict";
(function () {
  const $ = (id) => document.getElementById(id);
  const [text, marks, main, event, broken, one] = ["text", "marks", "main", "event", "broken", "one"].map($);
  const file = JSON.parse($("file").textContent);
  let saved = file.text.replace(/\r\n?/g, "\n");
  let digest = file.digest;
  const asked = { scenario: 0, break: null, losses: false };
  let scene = null;

  function element(tag, properties, ...children) {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
  }
  const tell = (messages) => $("messages").replaceChildren(...messages.map((m) => element("li", { textContent: m })));
  const milliseconds = (ms) => (ms < 10 ? ms.toFixed(1) : Math.round(ms)) + " ms";

  // --- asking ------------------------------------------------------------------------------------------------------------
  // Changes by the controls that no answer has put into the text yet.
  const pending = new Map();
  let timer = null, flight = null, more = false, answers = 0;
  const SLOW = 1000;

  // One request at a time; the newest of later ones is sent after its answer, or ends it if it takes long.
  function ask(delay) {
    clearTimeout(timer);
    timer = setTimeout(() => {
      if (!flight) return send();
      more = true;
      if (performance.now() - flight.start > SLOW) flight.controller.abort();
    }, delay);
  }
  async function send() {
    more = false;
    flight = { controller: new AbortController(), start: performance.now() };
    const sent = { text: text.value, changes: [...pending.values()], ...asked };
    const taken = [...pending];
    try {
      const answer = await fetch("analyze", { method: "POST", body: JSON.stringify(sent), signal: flight.controller.signal });
      if (!answer.ok) throw new Error(await answer.text());
      const reply = await answer.json();
      // Where somebody has typed meanwhile, the changes are made once more in the newer text.
      if (text.value === sent.text) {
        for (const [id, change] of taken) if (pending.get(id) === change) pending.delete(id);
        write(reply.text);
      }
      await show(reply);
    } catch (error) {
      if (error.name !== "AbortError") tell([error instanceof TypeError ? "trainsafe does not answer: it has ended, or is busy. The text in this page is kept." : error.message]);
    }
    flight = null;
    if (more) send();
  }
  function change(id, what, delay) {
    pending.set(id, what);
    ask(delay);
  }

  // --- the answer --------------------------------------------------------------------------------------------------------
  async function show(reply) {
    tell(reply.messages);
    problems(reply);
    event.replaceChildren(...reply.scenarios.map((name, i) => element("option", { value: i, textContent: name })));
    if (reply.scenarios.length) event.value = asked.scenario = reply.scenario;
    for (const input of [broken, one]) if (reply.couplers) input.max = reply.couplers;
    const rows = [[$("controls"), reply.controls.filter((c) => c.value !== null)], [$("absent"), reply.controls.filter((c) => c.value === null)]];
    if (reply.controls.length || reply.body) rows.forEach(([place, controls]) => fill(place, controls.map((c) => ({ ...c, id: c.key, label: c.key.replace(/^scenario\[\d+\]/, "scenario") }))));
    $("rest").hidden = !$("absent").childElementCount;
    if (reply.body) await report(reply);
    else {
      // A verdict on another text is not left beside it.
      $("short").textContent = "";
      $("status").textContent = main.querySelector("h1") ? "Not computed. The report is of an earlier text." : "Not computed.";
    }
    answers += 1;
    document.documentElement.dataset.answers = answers;
  }
  async function report(reply) {
    const focused = main.contains(document.activeElement) ? document.activeElement.id : "";
    const opened = [...main.querySelectorAll("details")].map((d) => d.open);
    // The page keeps its place while the figures are drawn anew.
    main.style.minHeight = main.offsetHeight + "px";
    main.innerHTML = reply.body;
    // The files that `analyze` writes beside its report are not here.
    main.querySelectorAll('a[href]:not([href^="#"])').forEach((a) => a.replaceWith(a.textContent));
    main.querySelectorAll("details").forEach((d, i) => { d.open = opened[i] === true; });
    const scenes = JSON.parse(reply.data);
    scene = scenes[0];
    await window.drawFigures(scenes);
    main.style.minHeight = "";
    if (focused && $(focused)) $(focused).focus();
    const verdict = main.querySelector(".verdict");
    $("short").textContent = verdict ? verdict.querySelector("strong").textContent : "";
    $("short").className = verdict ? verdict.className.replace("verdict", "").trim() : "";
    $("status").textContent = "Analysis " + milliseconds(reply.analysis_ms) + "; with the report " + milliseconds(reply.total_ms) + ".";
    ratings();
  }

  // --- the text ----------------------------------------------------------------------------------------------------------
  function write(newer) {
    if (newer !== text.value) {
      const [from, to, top, left] = [text.selectionStart, text.selectionEnd, text.scrollTop, text.scrollLeft];
      text.value = newer;
      if (document.activeElement === text) text.setSelectionRange(from, to);
      Object.assign(text, { scrollTop: top, scrollLeft: left });
    }
    edited();
  }
  function edited() {
    $("saved").textContent = text.value === saved ? "" : "Not saved.";
    marks.textContent = "";
  }
  const follow = () => Object.assign(marks, { scrollTop: text.scrollTop, scrollLeft: text.scrollLeft });

  function problems(reply) {
    const items = reply.problems.map((p) => {
      const place = p.line ? (p.marks.length ? "line " + p.line + ", column " + p.column : p.path + ":" + p.line + ":" + p.column) : p.path;
      const lead = p.marks.length ? element("button", { type: "button", textContent: place, onclick: () => reveal(p.marks[0], p.line) }) : place;
      return element("li", {}, lead, ": " + p.message, element("span", { className: "help", textContent: p.help || "" }));
    });
    if (reply.more) items.push(element("li", { textContent: "and " + reply.more + " more problems" }));
    $("problems").replaceChildren(...items);
    if (reply.text !== text.value) return;
    // Where two places overlap, the part that the first one marks is marked once.
    let at = 0;
    const parts = [];
    for (const [from, to] of reply.problems.flatMap((p) => p.marks).sort((a, b) => a[0] - b[0])) {
      const start = Math.max(at, from), end = Math.max(to, from + 1);
      if (end <= start) continue;
      parts.push(reply.text.slice(at, start), element("mark", { textContent: reply.text.slice(start, end) || " " }));
      at = end;
    }
    // An empty last line has a height in the text alone.
    marks.replaceChildren(...(parts.length ? [...parts, reply.text.slice(at) + "\n"] : []));
    follow();
  }
  function reveal([from, to], line) {
    text.focus();
    text.setSelectionRange(from, to);
    text.scrollTop = (line - 4) * parseFloat(getComputedStyle(text).lineHeight);
  }

  // --- controls ----------------------------------------------------------------------------------------------------------
  // A number and its unit; null where a value is written in another way, which is left to the text field.
  function split(value) {
    const found = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*((?:%|[a-z\u00b5\u03bc].*)?)$/i.exec(value.replace("\u2212", "-"));
    return found && [Number(found[1]), found[2].trim()];
  }
  const STEPS = 200;

  // A field and a slider from nothing to twice the value that the file had.
  function row(control) {
    const input = element("input", { type: "text", id: "value-" + control.id, title: control.about });
    const range = element("input", { type: "range", min: 0, max: STEPS, step: 1, title: control.about });
    range.setAttribute("aria-label", control.label + ", slider");
    const made = element("div", { className: "row" }, element("label", { htmlFor: input.id, textContent: control.label, title: control.about }), input, range);
    let end = 0, unit = "";
    const give = (value, delay) => change(control.id, { ...control.change, value: control.plain && value.trim() !== "" && !isNaN(value) ? Number(value) : value }, delay);
    made.update = (next) => {
      input.placeholder = next.example;
      if (pending.has(control.id) || document.activeElement === input) return;
      input.value = next.value === null ? "" : next.value;
      const number = split(next.value === null ? next.example : next.value);
      range.disabled = !number;
      if (!number) return;
      const fits = number[1] === unit && number[0] * end > 0 && Math.abs(number[0]) <= Math.abs(end);
      const scale = number[0] === 0 ? (end !== 0 && number[1] === unit ? null : split(next.example)) : fits ? null : number;
      if (scale) [end, unit] = [2 * scale[0], scale[1]];
      range.value = next.value === null || end === 0 ? 0 : Math.round((STEPS * number[0]) / end);
      range.setAttribute("aria-valuetext", next.value === null ? "not given" : next.value);
    };
    range.addEventListener("input", () => {
      input.value = Number(((end * range.value) / STEPS).toPrecision(4)) + (unit ? " " + unit : "");
      range.setAttribute("aria-valuetext", input.value);
      give(input.value, 20);
    });
    input.addEventListener("change", () => give(input.value, 0));
    return made;
  }
  // Rows with the same keys stay, so that a slider in use is not replaced.
  function fill(place, controls) {
    const there = new Map([...place.children].map((r) => [r.dataset.id, r]));
    const rows = controls.map((control) => {
      const made = there.get(control.id) || row({ change: { key: control.key }, ...control });
      made.dataset.id = control.id;
      made.update(control);
      return made;
    });
    if (rows.length !== place.children.length || rows.some((r, i) => r !== place.children[i])) place.replaceChildren(...rows);
  }
  function ratings() {
    const coupler = Number(one.value);
    const c = scene && [...scene.couplers, scene.broken].find((c) => c && c.coupler === coupler);
    const value = (force) => Number((force / scene.force_unit[1]).toPrecision(6)) + " " + scene.force_unit[0];
    const rating = (key, label, force) => ({ id: coupler + " " + key, key, label, about: "This coupler alone: [[coupler_override]]", example: "", plain: false,
      value: value(force), change: { key, coupler } });
    fill($("ratings"), c ? [rating("rated_load", "rated in draft", c.rated_draft_n), rating("rated_buff", "rated in buff", c.rated_buff_n)] : []);
  }

  // --- acting ------------------------------------------------------------------------------------------------------------
  function breaks(coupler) {
    asked.break = coupler;
    broken.value = coupler === null ? "" : coupler;
    ask(0);
  }
  document.addEventListener("coupler", (clicked) => {
    clicked.preventDefault();
    breaks(clicked.detail);
  });
  document.addEventListener("change", (changed) => {
    if (changed.target.id !== "coupler-1") return;
    one.value = changed.target.value;
    ratings();
  });
  broken.addEventListener("change", () => breaks(broken.value === "" ? null : Math.max(1, Math.round(Number(broken.value)))));
  $("intact").addEventListener("click", () => breaks(null));
  event.addEventListener("change", () => {
    asked.scenario = Number(event.value);
    breaks(null);
  });
  $("losses").addEventListener("change", () => {
    asked.losses = $("losses").checked;
    ask(0);
  });
  one.addEventListener("input", ratings);
  text.addEventListener("input", () => {
    edited();
    ask(250);
  });
  text.addEventListener("scroll", follow);
  $("revert").addEventListener("click", () => {
    pending.clear();
    write(saved);
    ask(0);
  });
  $("save").addEventListener("click", async () => {
    for (let n = 0; n < 200 && pending.size; n++) await new Promise((done) => setTimeout(done, 50));
    const content = text.value;
    try {
      const answer = await fetch("save", { method: "POST", body: JSON.stringify({ text: content, digest }) });
      if (!answer.ok) throw new Error(await answer.text());
      digest = (await answer.json()).digest;
      saved = content;
      $("saved").textContent = text.value === saved ? "Saved." : "Not saved.";
    } catch (error) {
      $("saved").textContent = error instanceof TypeError ? "Not saved: trainsafe does not answer." : error.message;
    }
  });
  addEventListener("beforeunload", (leaving) => { if (text.value !== saved) leaving.preventDefault(); });

  document.body.dataset.click = "click it to break it, or choose it below to see its force over time";
  main.replaceChildren(element("p", { textContent: "The report is being computed." }));
  write(saved);
  ask(0);
})();
