// The HTML reports in Chromium: what a reader sees, hovers, clicks, types, prints, and what a hostile train file cannot do.
//
// Run by tests/browser/run.sh, which builds the program and installs what this needs.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { axe, browser, folder, program, root } from "./browser.js";

// Writes a train's report once and gives its folder.
const written = new Map();
function report(train) {
  if (!written.has(train)) {
    const out = join(folder, String(written.size));
    execFileSync(program, ["analyze", train, "--out", out], { stdio: ["ignore", "ignore", "inherit"] });
    written.set(train, out);
  }
  return written.get(train);
}
const paper = () => report(join(root, "trains/paper-figure-4.toml"));
const result = (out) => JSON.parse(readFileSync(join(out, "result.json"), "utf8"));

// Opens a report; `page.troubles` collects what must not happen.
async function open(out, { script = true, ...options } = {}) {
  const page = await browser.newPage({ javaScriptEnabled: script, viewport: { width: 1200, height: 900 }, ...options });
  const address = pathToFileURL(join(out, "report.html")).href;
  page.troubles = [];
  page.on("console", (m) => { if (["error", "warning"].includes(m.type())) page.troubles.push(m.text()); });
  page.on("pageerror", (e) => page.troubles.push(String(e)));
  page.on("dialog", (d) => { page.troubles.push("a dialog"); d.dismiss(); });
  page.on("request", (r) => { if (r.url() !== address && !/^(data|blob):/.test(r.url())) page.troubles.push(r.url()); });
  await page.goto(address);
  if (script) await page.waitForFunction(() => document.documentElement.dataset.drawn === "yes");
  return page;
}

async function close(page) {
  assert.deepEqual(page.troubles, [], "errors on the console, or requests");
  await page.close();
}

// Where a coupler stands in a plot, in pixels of the page.
function point(page, id, x, up) {
  return page.evaluate(([id, x, up]) => {
    const div = document.getElementById(id);
    div.scrollIntoView({ block: "center" });
    const box = div.getBoundingClientRect();
    const { xaxis, yaxis } = div._fullLayout;
    return [box.left + xaxis._offset + xaxis.l2p(x), box.top + yaxis._offset + up * yaxis._length];
  }, [id, x, up]);
}
// The program's four digits, and the texts of all hover labels.
const four = (x) => Math.abs(x).toPrecision(4);
const hover = async (page, id) => {
  await page.locator(`#${id} .hoverlayer .hovertext`).first().waitFor();
  return (await page.locator(`#${id} .hoverlayer .hovertext`).allTextContents()).join(" ");
};
// Colours of a screenshot: how many of its pixels pass a test on red, green, blue.
async function count(png, passes) {
  const page = await browser.newPage();
  const n = await page.evaluate(async ([data, passes]) => {
    const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const { data: pixels } = context.getImageData(0, 0, image.width, image.height);
    const test = new Function("r", "g", "b", `return ${passes}`);
    let n = 0;
    for (let i = 0; i < pixels.length; i += 4) n += test(pixels[i], pixels[i + 1], pixels[i + 2]);
    return n;
  }, [png.toString("base64"), passes]);
  await page.close();
  return n;
}

test("without scripts the verdict and the static figures are there", async () => {
  const page = await open(paper(), { script: false });
  assert.match(await page.locator(".verdict").innerText(), /^48 of 50 other couplers would exceed their rating/);
  assert.ok(await page.locator(".verdict").isVisible());
  for (const kind of ["envelope", "wave", "force"]) {
    const figure = page.locator(`figure[data-kind=${kind}] > svg`);
    assert.ok(await figure.isVisible(), kind);
    assert.ok((await figure.getAttribute("aria-label")).length > 20, kind);
  }
  assert.equal(await page.locator(".live:visible").count(), 0);
  const image = await page.locator("figure[data-kind=wave] > svg").screenshot();
  assert.ok(await count(image, "b > 150 && r < 60") > 5000, "draft is blue");
  assert.ok(await count(image, "r > 180 && g < 120 && b < 60") > 5000, "buff is orange");
  await close(page);
});

test("hovering a coupler tells its forces, times, ratings and utilisation", async () => {
  const page = await open(paper());
  for (const c of result(paper()).scenarios[0].cases[0].couplers.filter((c) => [1, 20, 47].includes(c.coupler))) {
    await page.mouse.move(...await point(page, "along-1", c.coupler, 0.3));
    await page.waitForFunction((n) => document.querySelector("#along-1 .hovertext")?.textContent.includes(`Coupler ${n},`), c.coupler);
    const text = await hover(page, "along-1");
    assert.ok(text.includes(`between ${c.between[0]} and ${c.between[1]}`), text);
    assert.ok(text.includes(`largest draft ${four(c.peak_draft_n)} N at ${four(c.peak_draft_time_s).replace("0.000", "0")} s: ${four(100 * c.peak_draft_n)} %`), text);
    assert.ok(text.includes(`largest buff ${four(c.peak_buff_n)} N at ${four(c.peak_buff_time_s)} s: ${four(100 * c.peak_buff_n)} %`), text);
    assert.ok(text.includes("rated 1 N in draft, 1 N in buff"), text);
  }
  await close(page);
});

test("clicking a coupler shows its history, peaks included", async () => {
  const page = await open(paper());
  await page.mouse.click(...await point(page, "along-1", 33, 0.3));
  await page.waitForFunction(() => document.querySelector("#coupler-1").value === "33");
  assert.match(await page.locator("#said-1").innerText(), /^Coupler 33, between mass 32 and mass 33;/);
  const c = result(paper()).scenarios[0].cases[0].couplers.find((c) => c.coupler === 33);
  const drawn = await page.evaluate(() => document.getElementById("history-1").data.find((t) => t.name === "coupler 33"));
  const [t, f] = [Array.from(drawn.x), Array.from(drawn.y)];
  assert.equal(f[t.indexOf(c.peak_draft_time_s)], c.peak_draft_n, "the exact peak is a point of the line");
  assert.equal(Math.min(...f), c.peak_buff_n);
  assert.equal(Math.max(...f), c.peak_draft_n);
  assert.ok(await page.locator("#history-1 .legend").textContent().then((l) => l.includes("elastic rod")));
  await close(page);
});

test("the map tells coupler, time, force and share, and its click leads there", async () => {
  const page = await open(paper());
  // A third down the upper picture, at t = 100 s: buff beyond the release wave.
  const [x, y] = await point(page, "map-1", 100, 0.33);
  await page.mouse.move(x, y);
  const text = await hover(page, "map-1");
  assert.match(text, /coupler 1[67], 100(\.\d)? s.*N in buff.* % of its rating/);
  await page.mouse.click(x, y);
  await page.waitForFunction(() => ["16", "17"].includes(document.querySelector("#coupler-1").value));
  assert.match(await page.locator("#shown-1").innerText(), /^(99\.|100\.)\d* s$/);
  const image = await page.locator("#map-1").screenshot();
  assert.ok(await count(image, "b > 150 && r < 60") > 3000, "draft is blue");
  assert.ok(await count(image, "r > 180 && g < 120 && b < 60") > 3000, "buff is orange");
  await close(page);
});

test("the time axes of history and map lie under each other", async () => {
  for (const width of [390, 1200]) {
    const page = await open(paper(), { viewport: { width, height: 900 } });
    const axes = await page.evaluate(() => ["history-1", "map-1"].map((id) => {
      const axis = document.getElementById(id)._fullLayout.xaxis;
      return [axis._offset, axis._length, ...axis.range].map((x) => Math.round(10 * x) / 10);
    }));
    assert.deepEqual(axes[0], axes[1], `${width} pixels wide`);
    await close(page);
  }
});

test("slider and play button run the wave", async () => {
  const page = await open(paper());
  const wave = () => page.evaluate(() => document.getElementById("along-1").data.slice(-2).map((t) => Array.from(t.y)));
  await page.locator("#time-1").fill("0");
  const [draft, buff] = await wave();
  assert.ok(draft.slice(0, 50).every((f) => Math.abs(f - 1) < 1e-4) && buff.slice(0, 50).every((f) => f === 0), "the load at t = 0");
  // At t = 100 s the first couplers are in buff: the wave has been mirrored at the held end.
  await page.locator("#time-1").fill(String(await page.evaluate(() => Math.round(document.getElementById("time-1").max / 2))));
  assert.equal(await page.locator("#shown-1").innerText(), "100.0 s");
  assert.ok((await wave())[1].slice(0, 40).every((f) => f < -0.5));
  await page.locator("#time-1").fill("0");
  await page.locator("#play-1").click();
  assert.equal(await page.locator("#play-1").innerText(), "Pause");
  await page.waitForFunction(() => Number(document.getElementById("time-1").value) > 20);
  await page.locator("#play-1").click();
  const stopped = await page.locator("#time-1").inputValue();
  await page.waitForTimeout(200);
  assert.equal(await page.locator("#time-1").inputValue(), stopped, "a pause is one");
  await close(page);
});

test("the keyboard alone does it all", async () => {
  const page = await open(paper());
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement.className), "skip");
  await page.keyboard.press("Enter");
  const reach = async (id) => {
    for (let n = 0; n < 12; n++) {
      await page.keyboard.press("Tab");
      if (await page.evaluate(() => document.activeElement.id) === id) return;
    }
    assert.fail(`${id} is not reached`);
  };
  await reach("play-1");
  await page.keyboard.press("Space");
  assert.equal(await page.locator("#play-1").innerText(), "Pause");
  await page.keyboard.press("Space");
  await reach("time-1");
  await page.keyboard.press("End");
  assert.equal(await page.locator("#shown-1").innerText(), "200.0 s");
  assert.equal(await page.locator("#time-1").getAttribute("aria-valuetext"), "200.0 s");
  await page.keyboard.press("ArrowLeft");
  assert.notEqual(await page.locator("#shown-1").innerText(), "200.0 s");
  await reach("coupler-1");
  await page.keyboard.press("ArrowDown");
  assert.match(await page.locator("#said-1").innerText(), /^Coupler 2, /);
  assert.equal(await page.evaluate(() => document.getElementById("history-1").data.some((t) => t.name === "coupler 2")), true);
  await close(page);
});

for (const colorScheme of ["light", "dark"]) {
  for (const width of [1200, 360]) {
    test(`nothing bars a reader, ${colorScheme}, ${width} pixels wide`, async () => {
      for (const train of ["paper-figure-4", "hauled-train-on-a-grade"]) {
        const page = await open(report(join(root, `trains/${train}.toml`)), { colorScheme, viewport: { width, height: 800 } });
        await page.evaluate(axe);
        const { violations } = await page.evaluate(() => axe.run());
        const told = violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.html.slice(0, 120)).join(" | ")}`);
        assert.deepEqual(told, [], train);
        assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "the page is no wider than the screen");
        await close(page);
      }
    });
  }
}

test("on paper the static figures stand in, whole", async () => {
  const page = await open(paper(), { colorScheme: "dark", viewport: { width: 680, height: 1000 } });
  const pdf = (await page.pdf({ format: "A4", preferCSSPageSize: true })).toString("latin1");
  const pages = pdf.match(/\/Type\s*\/Page\b(?!s)/g).length;
  assert.ok(pages >= 3 && pages <= 9, `${pages} pages`);
  await page.emulateMedia({ media: "print", colorScheme: "light" });
  assert.equal(await page.locator(".live:visible").count(), 0);
  assert.equal(await page.locator("figure > svg:visible").count(), 3);
  // Within 180 mm, which is what A4 leaves: no table scrolls, no figure is cut.
  const cut = await page.evaluate(() => [...document.querySelectorAll("main *")].filter((e) => e.getBoundingClientRect().right > innerWidth + 1 && !e.closest("svg")).map((e) => e.outerHTML.slice(0, 80)));
  assert.deepEqual(cut, []);
  assert.equal(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), "rgb(255, 255, 255)");
  await close(page);
});

test("names run nothing, whatever they hold", async () => {
  const out = report(join(import.meta.dirname, "hostile.toml"));
  const page = await open(out);
  assert.equal(await page.evaluate(() => window.hacked), undefined);
  assert.equal(await page.locator("main img, main iframe, main script, main a[href^=http]").count(), 0);
  assert.match(await page.locator("h1").innerText(), /<script>window\.hacked = 1<\/script>/);
  await page.mouse.move(...await point(page, "along-1", 2, 0.5));
  const text = await hover(page, "along-1");
  assert.match(text, /<b>bold<\/b>/);
  assert.equal(await page.locator("#along-1 .hoverlayer a").count(), 0);
  // Nothing that a page could be made to run by hand either: the policy knows two scripts.
  await page.evaluate(() => { const s = document.createElement("script"); s.textContent = "window.hacked = 2"; document.body.append(s); });
  assert.equal(await page.evaluate(() => window.hacked), undefined);
  page.troubles = page.troubles.filter((t) => !t.includes("Content Security Policy"));
  await close(page);
});

test("any of several breaks can be chosen, with its own largest forces", async () => {
  const out = report(join(root, "trains/mixed-manifest-train.toml"));
  const rows = readFileSync(join(out, "couplers.csv"), "utf8").trim().split("\n").map((row) => row.split(","));
  const head = rows[0];
  const value = (row, name) => Number(row[head.indexOf(name)]);
  const page = await open(out);
  const drawn = (trace) => page.evaluate((i) => document.getElementById("along-2").data[i].y, trace);
  await page.locator("#break-2").selectOption({ label: "the break of coupler 30" });
  const draft = await drawn(0), buff = await drawn(1);
  const of = rows.filter((row) => row[0] === "each coupler in turn" && value(row, "broken_coupler") === 30);
  assert.equal(of.length, 138);
  for (const row of of) {
    const i = value(row, "coupler") - 1;
    assert.ok(Math.abs(draft[i] * 1e6 - value(row, "peak_draft_n")) < 100, "draft of coupler " + (i + 1));
    assert.ok(Math.abs(buff[i] * 1e6 - value(row, "peak_buff_n")) < 100, "buff of coupler " + (i + 1));
  }
  assert.equal(draft[29], null, "the coupler that breaks has none");
  // What belongs to the worst break is not shown beside another.
  const worst = result(out).scenarios[1].cases.reduce((a, b) => (b.worst.utilisation > a.worst.utilisation ? b : a)).broken_coupler;
  const live = page.locator('.live[data-scenario="1"]');
  const headings = () => live.locator("h2:visible, h3:visible").allTextContents();
  assert.deepEqual(await headings(), ["Forces along the train, when coupler 30 breaks", "Largest forces of one coupler, when coupler 30 breaks"]);
  for (const id of ["history-2", "map-2", "play-2", "time-2"]) assert.equal(await page.locator(`#${id}`).isVisible(), false, id);
  assert.match(await page.locator("#absent-2").innerText(), new RegExp(`for the break of coupler ${worst} only, the worst`));
  assert.equal((await live.innerText()).includes(`when coupler ${worst} breaks`), false);
  await page.locator("#coupler-2").selectOption("30");
  assert.match(await page.locator("#said-2").innerText(), /it breaks/);
  // The worst break has all of it, but for the coupler that breaks.
  await page.locator("#break-2").selectOption({ label: `the break of coupler ${worst}` });
  assert.deepEqual(await headings(), ["Forces along the train", "Force over time", "Force by place and time"].map((h) => `${h}, when coupler ${worst} breaks`));
  for (const id of ["history-2", "map-2"]) assert.ok((await page.locator(`#${id} .plot-container`).boundingBox()).width > 500, id);
  await page.locator("#coupler-2").selectOption(String(worst));
  assert.equal(await page.locator("#history-2").isVisible(), false);
  await page.locator("#break-2").selectOption({ label: "all breaks" });
  for (const coupler of [30, worst]) assert.ok((await drawn(0))[coupler - 1] > 0, "no gap over all breaks");
  assert.equal((await headings())[0], "Forces along the train: the largest over all breaks");
  await close(page);
});

// A train of 240 couplers of which one is weak.
let long = null;
function longTrain() {
  if (long === null) {
    long = join(folder, "long.toml");
    writeFileSync(long, `name = "240 couplers"
[coupler]
stiffness = "16.9 MN/m"
rated_load = "3 MN"
[[vehicle]]
count = 241
mass = "100 t"
[[coupler_override]]
at = 23
rated_load = "900 kN"
[load]
uniform = "700 kN"
[[scenario]]
name = "one"
kind = "break"
coupler = 60
[[scenario]]
name = "a push"
kind = "pulse"
at = "tail"
force = "100 kN"
duration = "1 s"
`);
  }
  return report(long);
}

test("in a train of 240 couplers a coupler over its rating is seen, in the page and in the static figure", async () => {
  for (const scheme of ["light", "dark"]) {
    const page = await open(longTrain(), { colorScheme: scheme });
    const over = scheme === "light" ? "r > 150 && r < 200 && g < 50 && b > 70 && b < 115" : "r > 235 && g > 100 && g < 140 && b > 155 && b < 195";
    for (const id of ["along-1", "map-1", "history-1"]) {
      assert.ok(await count(await page.locator(`#${id}`).screenshot(), over) > 60, `${id}, ${scheme}`);
    }
    const marks = await page.evaluate(() => document.getElementById("map-1").data.filter((t) => t.name === "coupler over its rating").map((t) => t.y));
    assert.deepEqual(marks, [result(longTrain()).scenarios[0].cases[0].couplers.filter((c) => c.exceeds).map((c) => c.coupler)]);
    await close(page);
  }
  const page = await open(longTrain(), { script: false });
  for (const kind of ["envelope", "wave", "force"]) {
    const figure = page.locator(`figure[data-scenario="0"][data-kind=${kind}] > svg`);
    assert.ok(await count(await figure.screenshot(), "r > 150 && r < 200 && g < 50 && b > 70 && b < 115") > 60, kind);
  }
  await close(page);
});

test("a colour is the same share in all figures of a report, and its bar has no signs", async () => {
  const out = longTrain();
  const page = await open(out);
  const bars = await page.evaluate(() => ["map-1", "map-2"].map((id) => {
    const { zmax, colorbar } = document.getElementById(id).data[0];
    return [zmax, colorbar.ticktext];
  }));
  assert.deepEqual(bars[0], bars[1]);
  assert.ok(bars[0][1].length > 2 && bars[0][1].every((text) => /^\d+ %$/.test(text)), bars[0][1]);
  const numbers = (figure) => readFileSync(join(out, figure), "utf8").match(/>\d+ %</g);
  assert.deepEqual(numbers("figure-1-wave.svg"), numbers("figure-2-wave.svg"));
  await close(page);
});

test("a history has the colours of the static one: draft, buff, over the rating", async () => {
  const page = await open(paper());
  const stretches = await page.evaluate(() => {
    const paint = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
    return document.getElementById("history-1").data.filter((t) => [paint("draft"), paint("buff"), paint("over")].includes(t.line?.color))
      .map((t) => [t.name, Math.min(...t.y.filter((f) => f !== null)), Math.max(...t.y.filter((f) => f !== null))]);
  });
  const worst = result(paper()).scenarios[0].cases[0].worst;
  assert.deepEqual(stretches.map((s) => s[0]), ["draft", "buff", "over its rating", "over its rating"]);
  const [draft, buff, above, below] = stretches;
  assert.ok(draft[1] >= 0 && buff[2] <= 0 && above[1] > 1 && below[2] < -1);
  assert.equal(above[2], worst.peak_draft_n);
  assert.equal(below[1], worst.peak_buff_n);
  await close(page);
});

test("a page opens at the worst instant", async () => {
  const page = await open(paper());
  const worst = result(paper()).scenarios[0].cases[0].worst;
  const shown = parseFloat(await page.locator("#shown-1").textContent());
  assert.ok(Math.abs(shown - worst.peak_time_s) < 1, shown + " s and " + worst.peak_time_s + " s");
  await close(page);
});

test("a report is of a size that can be sent", () => {
  assert.ok(statSync(join(paper(), "report.html")).size < 1.5e6);
  assert.ok(statSync(join(report(join(root, "trains/mixed-manifest-train.toml")), "report.html")).size < 2e6);
});

const unit = () => report(join(root, "trains/north-american-286k-unit-train.toml"));
const brakes = () => report(join(root, "trains/unit-train-emergency.toml"));
// The page of a fleet of two trains, written once.
let fleet = null;
function fleetPage() {
  if (fleet === null) {
    fleet = join(folder, "fleet");
    const trains = ["trains/paper-figure-4.toml", "trains/hauled-train-on-a-grade.toml"].map((t) => join(root, t));
    execFileSync(program, ["fleet", ...trains, "--format", "csv,html", "--out", fleet, "-q"], { stdio: ["ignore", "ignore", "inherit"] });
  }
  return pathToFileURL(join(fleet, "fleet.html")).href;
}

for (const width of [390, 768, 1400]) {
  test(`legends lie beside the data and captions in view, ${width} pixels wide`, async () => {
    for (const out of [paper(), unit(), brakes()]) {
      const page = await open(out, { viewport: { width, height: 900 } });
      const troubles = await page.evaluate(() => {
        const wrong = [];
        for (const plot of document.querySelectorAll(".live .plot")) {
          const legend = plot.querySelector(".legend"), data = plot.querySelector(".plot");
          if (!legend || !data) continue;
          const [l, d] = [legend.getBoundingClientRect(), data.getBoundingClientRect()];
          if (l.bottom > d.top + 1 && l.top < d.bottom) wrong.push("legend over data in " + plot.id);
        }
        for (const caption of document.querySelectorAll("caption span")) {
          const box = caption.getBoundingClientRect();
          if (box.right > innerWidth + 1) wrong.push("caption cut: " + caption.textContent);
        }
        if (document.documentElement.scrollWidth > innerWidth) wrong.push("the page is wider than the screen");
        return wrong;
      });
      assert.deepEqual(troubles, [], out);
      await close(page);
    }
  });
}

test("every exceedance has a mark, and no other coupler", async () => {
  const page = await open(paper());
  const marks = await page.evaluate(() => {
    const trace = document.getElementById("along-1").data.find((t) => t.name === "over its rating");
    return Array.from(trace.x, (x, i) => [x, trace.y[i]]);
  });
  const couplers = result(paper()).scenarios[0].cases[0].couplers.filter((c) => c.exceeds);
  const right = couplers.flatMap((c) => [[c.coupler, c.peak_draft_n, c.rated_draft_n], [c.coupler, c.peak_buff_n, c.rated_buff_n]])
    .filter(([, f, rated]) => Math.abs(f) > rated).map(([coupler, f]) => [coupler, f]);
  assert.ok(right.length > 50);
  assert.deepEqual(marks, right);
  await close(page);
});

test("a rating far off does not press the forces flat, and its number is shown", async () => {
  const page = await open(unit());
  for (const id of ["along-1", "history-1"]) {
    const [range, notes] = await page.evaluate((id) => {
      const { _fullLayout } = document.getElementById(id);
      return [_fullLayout.yaxis.range, _fullLayout.annotations.map((a) => a.text)];
    }, id);
    // 700 kip in buff, where no force is over 253 kip.
    assert.ok(range[0] > -400 && range[1] > 400, `${id}: ${range}`);
    assert.ok(notes.includes("rated 700 kip \u2193"), `${id}: ${notes}`);
  }
  await close(page);
});

test("in dark mode no figure is white", async () => {
  for (const out of [paper(), brakes()]) {
    const page = await open(out, { colorScheme: "dark" });
    for (const figure of await page.locator(".plot[id], figure > svg").all()) {
      if (!await figure.isVisible()) continue;
      assert.equal(await count(await figure.screenshot(), "r > 250 && g > 250 && b > 250"), 0);
    }
    await close(page);
  }
});

test("the break of any coupler is a row of a folded table, which is printed open", async () => {
  const page = await open(unit());
  const rows = page.locator("details tbody tr", { hasText: "car 38, car 39" });
  assert.equal(await rows.first().isVisible(), false);
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  assert.ok(await rows.first().isVisible());
  assert.match(await rows.first().innerText(), /^40\s/);
  await close(page);
});

test("the page of a fleet fits the screen and, with all columns, the paper", async () => {
  for (const width of [390, 1400]) {
    const page = await browser.newPage({ viewport: { width, height: 900 } });
    await page.goto(fleetPage());
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${width}`);
    await page.close();
  }
  // 180 mm of A4.
  const page = await browser.newPage({ viewport: { width: 680, height: 1000 } });
  await page.goto(fleetPage());
  await page.emulateMedia({ media: "print" });
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  const cut = await page.evaluate(() => [...document.querySelectorAll("main th, main td, main svg")]
    .filter((e) => e.getBoundingClientRect().right > innerWidth + 1).map((e) => e.textContent.slice(0, 40)));
  assert.deepEqual(cut, []);
  assert.ok(await page.locator("details p").first().isVisible());
  await page.close();
});
