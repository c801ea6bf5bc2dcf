// Opens a report in headless Chromium and plays its films: node player.mjs REPORT.html [SCREENSHOT.png]
// Fails if the page writes an error to the console, or if a film does not load, play to its end, pause and move with the slider.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [report, picture] = process.argv.slice(2);
const profile = mkdtempSync(join(tmpdir(), "player-"));
const browser = spawn(process.env.CHROMIUM ?? "chromium", [
  "--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader", "--use-angle=swiftshader", "--remote-debugging-pipe",
  "--window-size=1100,900", `--user-data-dir=${profile}`, "about:blank",
], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });

// Messages are JSON, each ended by a zero byte.
const [, , , out, into] = browser.stdio;
const waiting = new Map(), errors = [];
let rest = "", last = 0;
into.on("data", data => {
  const messages = (rest + data).split("\0");
  rest = messages.pop();
  for (const message of messages.map(text => JSON.parse(text))) {
    waiting.get(message.id)?.(message);
    const { method, params } = message;
    if (method === "Runtime.exceptionThrown") errors.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    if (method === "Runtime.consoleAPICalled" && params.type === "error") errors.push(params.args.map(a => a.value).join(" "));
    if (method === "Log.entryAdded" && params.entry.level === "error") errors.push(params.entry.text);
  }
});
let session;
function send(method, params = {}) {
  const id = ++last;
  out.write(JSON.stringify({ id, method, params, sessionId: session }) + "\0");
  return new Promise((done, failed) => waiting.set(id, message => message.error ? failed(new Error(message.error.message)) : done(message.result)));
}
async function evaluate(expression) {
  const { result, exceptionDetails } = await send("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
  if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
  return result.value;
}
const sleep = ms => new Promise(done => setTimeout(done, ms));
async function until(what, expression) {
  for (let i = 0; i < 300; i++, await sleep(100)) if (await evaluate(expression)) return;
  throw new Error(`waited in vain until ${what}`);
}
function check(condition, what) {
  if (!condition) throw new Error(`not true: ${what}`);
}

let failure;
try {
  const { targetId } = await send("Target.createTarget", { url: "about:blank" });
  session = (await send("Target.attachToTarget", { targetId, flatten: true })).sessionId;
  for (const domain of ["Runtime", "Log", "Page"]) await send(`${domain}.enable`);
  await send("Page.navigate", { url: pathToFileURL(resolve(report)).href });
  await until("the page is loaded", "document.readyState === 'complete' && document.querySelectorAll('figure.player').length > 0");
  const count = await evaluate("document.querySelectorAll('figure.player').length");
  for (let i = 0; i < count; i++) {
    const figure = `document.querySelectorAll('figure.player')[${i}]`;
    const state = () => evaluate(`({...${figure}.dataset})`);
    check((await state()).state === "paused" && (await state()).frame === "0", "a film starts paused, at its first frame");
    await evaluate(`${figure}.scrollIntoView({block: "center"}); ${figure}.querySelector("button").click()`);
    check((await state()).state === "playing", "it plays when asked to");
    await until("it has moved on", `+${figure}.dataset.frame > 1`);
    if ((await state()).state === "playing") {
      await evaluate(`${figure}.querySelector("button").click()`);
      const paused = await state();
      await sleep(300);
      check(paused.state === "paused" && (await state()).frame === paused.frame, "it stands still when paused");
      await evaluate(`${figure}.querySelector("button").click()`);
    }
    await until("it has ended", `${figure}.dataset.state === "paused" && ${figure}.dataset.frame === ${figure}.querySelector("input").max`);
    // Something is drawn: more than one colour in the first run's part.
    const colours = await evaluate(`(() => {
      const player = ${figure}.player, gl = player.gl;
      player.draw();
      const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
      gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      return new Set(new Uint32Array(pixels.buffer)).size;
    })()`);
    check(colours > 20, `cloth is seen (${colours} colours)`);
    await evaluate(`(() => { const slider = ${figure}.querySelector("input"); slider.value = 1; slider.oninput(); })()`);
    check((await state()).frame === "1", "the slider moves it");
    await evaluate(`${figure}.player.go(+${figure}.querySelector("input").max)`);
  }
  if (picture) writeFileSync(picture, Buffer.from((await send("Page.captureScreenshot")).data, "base64"));
  check(errors.length === 0, `no error on the console: ${errors.join("; ")}`);
  console.log(`${count} films load, play, pause and follow the slider; no error on the console`);
} catch (error) {
  failure = error;
  console.error(`${error.message} ${errors.join("; ")}`);
}
browser.kill();
await new Promise(done => browser.once("exit", done));
rmSync(profile, { recursive: true, force: true });
process.exit(failure ? 1 : 0);
