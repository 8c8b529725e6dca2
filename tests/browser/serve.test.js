// The page of `trainsafe serve` in Chromium: a click breaks a coupler, controls change the text, mistakes are marked, a text is saved.
//
// Run by tests/browser/run.sh, which builds the program with the feature serve.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { copyFileSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, test } from "node:test";
import { axe, browser, folder, program, root } from "./browser.js";

const running = [];

after(() => running.forEach((server) => server.kill()));

// Serves a copy of a train and opens its page; `page.file` is the copy.
async function open(train, options = {}) {
  const file = join(folder, `${running.length}.toml`);
  copyFileSync(join(root, "trains", train), file);
  const server = spawn(program, ["serve", file, "--no-open"], { stdio: ["ignore", "pipe", "inherit"] });
  running.push(server);
  const address = await new Promise((done) => server.stdout.once("data", (line) => done(String(line).trim())));
  const page = await browser.newPage({ viewport: { width: 1500, height: 1000 }, ...options });
  Object.assign(page, { troubles: [], file, server });
  page.on("console", (m) => { if (["error", "warning"].includes(m.type())) page.troubles.push(m.text()); });
  page.on("pageerror", (e) => page.troubles.push(String(e)));
  page.on("request", (r) => { if (!r.url().startsWith(address) && !/^(data|blob):/.test(r.url())) page.troubles.push(r.url()); });
  await page.goto(address);
  await answered(page);
  return page;
}
async function close(page) {
  assert.deepEqual(page.troubles, [], "errors on the console, or requests elsewhere");
  page.server.kill();
  await page.close();
}
// Waits until what was asked last is on the page.
const count = (page) => page.evaluate(() => Number(document.documentElement.dataset.answers ?? 0));
const answered = (page, before = 0) => page.waitForFunction((n) => Number(document.documentElement.dataset.answers) > n, before);
async function then(page, act) {
  const before = await count(page);
  await act();
  await answered(page, before);
}
const verdict = (page) => page.locator(".verdict").first().innerText();
const text = (page) => page.locator("#text").inputValue();

// Where a coupler stands in the figure along the train, in pixels of the page.
function point(page, coupler) {
  return page.evaluate((x) => {
    const div = document.getElementById("along-1");
    div.scrollIntoView({ block: "center" });
    const box = div.getBoundingClientRect();
    const { xaxis, yaxis } = div._fullLayout;
    return [box.left + xaxis._offset + xaxis.l2p(x), box.top + yaxis._offset + 0.3 * yaxis._length];
  }, coupler);
}

test("a click on a coupler breaks it, with the numbers of the program", async () => {
  const page = await open("paper-figure-4.toml");
  assert.match(await verdict(page), /^48 of 50 other couplers would exceed their rating/);
  assert.ok((await verdict(page)).startsWith(await page.locator("#short.exceeds").innerText()), "the verdict stands beside the controls too");
  await then(page, async () => page.mouse.click(...await point(page, 30)));
  assert.equal(await page.locator("#broken").inputValue(), "30");
  // The same by a file that says so.
  const other = join(folder, "thirty.toml");
  writeFileSync(other, readFileSync(page.file, "utf8").replace(/^coupler = .*$/m, "coupler = 30"));
  const result = JSON.parse(execFileSync(program, ["analyze", other, "--json"], { maxBuffer: 1 << 28, stdio: ["ignore", "pipe", "ignore"] }));
  const found = result.scenarios[0].cases[0];
  assert.equal(found.broken_coupler, 30);
  assert.match(await verdict(page), new RegExp(`^${found.exceeding} of 50 other couplers`));
  const drawn = await page.evaluate(() => document.getElementById("along-1").data[0].y);
  for (const c of found.couplers) assert.equal(drawn[c.coupler - 1] ?? 0, c.peak_draft_n ?? 0, `coupler ${c.coupler}`);
  assert.equal(drawn[29], null, "the broken one is a gap");
  assert.match(await page.locator("#status").innerText(), /^Analysis [\d.]+ ms; with the report [\d.]+ ms\.$/);
  assert.ok(await page.locator("#map-1 .plot-container").isVisible() && await page.locator("#history-1 .plot-container").isVisible());
  await then(page, () => page.locator("#intact").click());
  assert.match(await verdict(page), /^48 of 50/);
  await close(page);
});

test("of many breaks any is computed with all of its figures", async () => {
  const page = await open("paper-figure-4.toml");
  const each = (await text(page)).replace(/^coupler = .*$/m, 'coupler = "each"');
  await then(page, () => page.locator("#text").fill(each));
  assert.match(await verdict(page), /^\d+ of 51 breaks would overload another coupler/);
  await then(page, () => page.locator("#break-1").selectOption({ label: "the break of coupler 20" }));
  assert.equal(await page.locator("#broken").inputValue(), "20");
  assert.match(await verdict(page), /after coupler 20 breaks/);
  assert.ok(await page.locator("#map-1 .plot-container").isVisible() && await page.locator("#history-1 .plot-container").isVisible());
  await close(page);
});

test("a mistake in the text is told and marked, and mended", async () => {
  const page = await open("ore-train.toml");
  const before = await text(page);
  const wrong = before.replace('"30 MN/m"', '"30 MN"');
  await then(page, () => page.locator("#text").fill(wrong));
  const problem = page.locator("#problems li");
  assert.equal(await problem.count(), 1);
  assert.match(await problem.innerText(), /^line \d+, column \d+: stiffness has "MN", a unit of force/);
  assert.equal(await page.locator("#marks mark").textContent(), '"30 MN"');
  // The mark lies where the text is: the letters before it are the same in both.
  const places = await page.evaluate(() => {
    const mark = document.querySelector("#marks mark").getBoundingClientRect();
    const [pre, text] = ["marks", "text"].map((id) => document.getElementById(id));
    const style = (e) => ["fontSize", "lineHeight", "fontFamily", "paddingLeft", "paddingTop", "tabSize", "borderTopWidth"].map((k) => getComputedStyle(e)[k]);
    return { mark: [mark.width, mark.height], same: JSON.stringify(style(pre)) === JSON.stringify(style(text)), scroll: pre.scrollTop - text.scrollTop,
      box: pre.getBoundingClientRect().top - text.getBoundingClientRect().top };
  });
  assert.ok(places.same && places.mark[0] > 20 && places.mark[1] > 8, JSON.stringify(places));
  assert.ok(Math.abs(places.scroll) <= 1 && Math.abs(places.box) <= 1, JSON.stringify(places));
  await problem.locator("button").click();
  const chosen = await page.evaluate(() => { const t = document.getElementById("text"); return t.value.slice(t.selectionStart, t.selectionEnd); });
  assert.equal(chosen, '"30 MN"');
  assert.match(await page.locator("#status").innerText(), /earlier text/);
  assert.equal(await page.locator("#short").textContent(), "", "no verdict stands beside a text that it is not of");
  await then(page, () => page.locator("#text").fill(before));
  assert.equal(await problem.count() + await page.locator("#marks mark").count(), 0);
  await close(page);
});

test("controls change the text, and the verdict follows", async () => {
  const page = await open("paper-figure-4.toml");
  const field = (key) => page.locator(`[id="value-${key}"]`);
  await then(page, async () => { await field("load.uniform").fill("0.4 N"); await field("load.uniform").press("Enter"); });
  assert.match(await text(page), /^uniform\s*= "0.4 N"/m);
  assert.match(await verdict(page), /^No coupler would exceed/);
  // The slider runs to twice the value that stood there first.
  const slider = page.locator('.row[data-id="load.uniform"] input[type=range]');
  await slider.fill("100");
  await page.waitForFunction(() => /^uniform\s*= "1 N"/m.test(document.getElementById("text").value));
  await page.waitForFunction(() => document.querySelector(".verdict").innerText.startsWith("48 of 50"));
  // A damping that the file has not.
  await page.locator("#rest summary").click();
  await then(page, async () => { await field("coupler.damping").fill("0.28 N*s/m"); await field("coupler.damping").press("Enter"); });
  assert.match(await text(page), /^damping = "0.28 N\*s\/m"/m);
  // With dashpots nothing is left of the overload of a half: the load is the rating.
  assert.match(await verdict(page), /It is also the worst: 1\.000 N in buff, 100\.0\d* % of its rating/);
  // One coupler's rating.
  await page.locator("#one").fill("7");
  await then(page, async () => { await field("7 rated_load").fill("0.5 N"); await field("7 rated_load").press("Enter"); });
  assert.match(await text(page), /\[\[coupler_override\]\]\nat = 7\nrated_load = "0.5 N"\n$/);
  assert.match(await verdict(page), /first is coupler 7 .* 1\.000 N in buff, 200 % of its rating/);
  await then(page, () => page.locator("#revert").click());
  assert.match(await verdict(page), /^48 of 50/);
  await close(page);
});

test("a text is saved, and not over a file that somebody has changed", async () => {
  const page = await open("ore-train.toml");
  const newer = (await text(page)).replace('"30 MN/m"', '"31 MN/m"');
  await then(page, () => page.locator("#text").fill(newer));
  assert.equal(await page.locator("#saved").innerText(), "Not saved.");
  await page.locator("#save").click();
  await page.waitForFunction(() => document.getElementById("saved").textContent === "Saved.");
  assert.equal(readFileSync(page.file, "utf8"), newer);
  writeFileSync(page.file, "# another\n");
  await page.locator("#save").click();
  await page.waitForFunction(() => document.getElementById("saved").textContent.includes("has changed on the disk"));
  assert.equal(readFileSync(page.file, "utf8"), "# another\n");
  page.troubles = page.troubles.filter((t) => !t.includes("409"));
  await close(page);
});

test("a page without its program says so, and keeps the text", async () => {
  const page = await open("ore-train.toml");
  page.server.kill();
  await new Promise((done) => page.server.once("exit", done));
  await page.locator("#text").fill("a = 1\n");
  await page.locator("#messages li").waitFor();
  assert.match(await page.locator("#messages").innerText(), /does not answer/);
  assert.equal(await text(page), "a = 1\n");
  page.troubles = page.troubles.filter((t) => !t.includes("ERR_CONNECTION_REFUSED"));
  await close(page);
});

for (const colorScheme of ["light", "dark"]) {
  for (const width of [1500, 390]) {
    test(`nothing bars a reader of the live page, ${colorScheme}, ${width} pixels wide`, async () => {
      const page = await open("mixed-manifest-train.toml", { colorScheme, viewport: { width, height: 900 } });
      await then(page, () => page.locator("#text").fill("name = 1\n"));
      await page.evaluate(axe);
      const { violations } = await page.evaluate(() => axe.run());
      assert.deepEqual(violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.html.slice(0, 120)).join(" | ")}`), []);
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "the page is no wider than the screen");
      await close(page);
    });
  }
}
