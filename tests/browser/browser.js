// What both browser tests need: the program, Chromium, and a folder that is removed at the end.
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before } from "node:test";
import { chromium } from "playwright-core";

export const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
export const root = join(import.meta.dirname, "../..");
export const program = process.env.TRAINSAFE ?? join(root, "target/debug/trainsafe");
export const folder = mkdtempSync(join(tmpdir(), "trainsafe-browser-"));
const flags = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking " +
  "--disable-component-update --disable-sync";
export let browser;

before(async () => {
  browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: flags.split(" ") });
});
after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});
