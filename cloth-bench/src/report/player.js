"use strict";
// Plays the films of a page: every <figure class="player"> holds its data as JSON (see player.rs).
// One canvas per player, one part of it per run; what is drawn follows figure.dataset.frame and .state.

const VERTEX_SHADER = `#version 300 es
in vec3 place; in vec3 normal; in float red;
uniform mat4 camera;
out vec3 n; out float r;
void main() { n = normal; r = red; gl_Position = camera * vec4(place, 1.0); }`;

const FRAGMENT_SHADER = `#version 300 es
precision highp float;
in vec3 n; in float r;
uniform vec3 front, back, light;
out vec4 color;
void main() {
  vec3 m = normalize(n) * (gl_FrontFacing ? 1.0 : -1.0);
  float shade = 0.42 + 0.58 * max(dot(m, light), 0.0) + 0.12 * max(-dot(m, light), 0.0);
  color = vec4(mix(gl_FrontFacing ? front : back, vec3(0.85, 0.1, 0.1), r) * shade, 1.0);
}`;

const COLORS = {
  cloth: [[0.25, 0.53, 0.77], [0.89, 0.66, 0.34]],
  obstacle: [[0.71, 0.72, 0.73], [0.55, 0.56, 0.57]],
};

function bytes(base64) {
  return Uint8Array.from(atob(base64), letter => letter.charCodeAt(0)).buffer;
}

// Positions (m) and normals of one surface at one frame.
class Film {
  constructor(data) {
    this.colors = data.is_cloth ? COLORS.cloth : COLORS.obstacle;
    this.low = data.low;
    this.scale = data.size.map(size => size / 65535);
    this.triangles = new Uint32Array(bytes(data.triangles));
    this.coordinates = new Uint16Array(bytes(data.frames));
    this.count = 3 * data.vertices;
    this.frames = this.count ? this.coordinates.length / this.count : 0;
    this.places = new Float32Array(this.count);
    this.normals = new Float32Array(this.count);
    // Of every vertex in every frame, if the film has colours; of the one that is shown.
    this.allReds = data.reds && new Uint8Array(bytes(data.reds));
    this.reds = new Float32Array(this.count / 3);
    this.shown = -1;
  }

  show(frame) {
    frame = Math.min(frame, this.frames - 1);
    if (frame === this.shown || frame < 0) return false;
    this.shown = frame;
    const from = frame * this.count, x = this.places, n = this.normals;
    for (let i = 0; i < this.count; i++) x[i] = this.low[i % 3] + this.scale[i % 3] * this.coordinates[from + i];
    if (this.allReds) for (let i = 0; i < this.count / 3; i++) this.reds[i] = this.allReds[from / 3 + i] / 255;
    n.fill(0);
    for (let t = 0; t < this.triangles.length; t += 3) {
      const [a, b, c] = [3 * this.triangles[t], 3 * this.triangles[t + 1], 3 * this.triangles[t + 2]];
      const ux = x[b] - x[a], uy = x[b + 1] - x[a + 1], uz = x[b + 2] - x[a + 2];
      const vx = x[c] - x[a], vy = x[c + 1] - x[a + 1], vz = x[c + 2] - x[a + 2];
      const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
      for (const v of [a, b, c]) { n[v] += nx; n[v + 1] += ny; n[v + 2] += nz; }
    }
    return true;
  }
}

const subtract = (a, b) => a.map((x, i) => x - b[i]);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => a.map(x => x / Math.hypot(...a));

// What a camera at `eye` sees that looks at `target`, z up, columns one after the other.
function view(eye, target, aspect, near, far) {
  const back = unit(subtract(eye, target)), right = unit(cross([0, 0, 1], back)), up = cross(back, right);
  const f = 1 / Math.tan(0.3), depth = (far + near) / (near - far), offset = 2 * far * near / (near - far);
  const rows = [[...right, -dot(right, eye)], [...up, -dot(up, eye)], [...back, -dot(back, eye)]];
  const [fx, fy] = [f * Math.min(1, 1 / aspect), f * Math.min(1, aspect)];
  const matrix = [];
  for (let column = 0; column < 4; column++) {
    const last = column === 3 ? 1 : 0;
    matrix.push(fx * rows[0][column], fy * rows[1][column], depth * rows[2][column] + offset * last, -rows[2][column]);
  }
  return matrix;
}

class Player {
  constructor(figure) {
    this.figure = figure;
    this.canvas = figure.querySelector("canvas");
    this.tiles = [...figure.querySelectorAll(".tile")];
    [this.button, this.slider, this.clock] = figure.querySelectorAll(".controls > *");
    const data = JSON.parse(figure.querySelector("script").textContent);
    this.seconds = data.seconds_per_frame;
    this.tracks = data.tracks.map(track => track.surfaces.map(surface => new Film(surface)));
    this.frames = Math.max(1, ...this.tracks.flat().map(film => film.frames));
    this.slider.max = this.frames - 1;
    this.gl = this.canvas.getContext("webgl2", { antialias: true });
    if (!this.gl) {
      figure.dataset.state = "unsupported";
      this.clock.textContent = "This needs a browser with WebGL 2.";
      this.button.disabled = this.slider.disabled = true;
      return;
    }
    this.prepare();
    this.frameAll();
    this.listen();
    this.go(0);
    this.pause();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  prepare() {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, FRAGMENT_SHADER]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    this.uniforms = Object.fromEntries(["camera", "front", "back", "light"].map(name => [name, gl.getUniformLocation(program, name)]));
    for (const film of this.tracks.flat()) {
      film.array = gl.createVertexArray();
      gl.bindVertexArray(film.array);
      film.buffers = [["place", 3], ["normal", 3], ["red", 1]].map(([name, size]) => {
        const at = gl.getAttribLocation(program, name), buffer = gl.createBuffer();
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        gl.bufferData(gl.ARRAY_BUFFER, 4 * film.count * size / 3, gl.DYNAMIC_DRAW);
        gl.enableVertexAttribArray(at);
        gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
        return buffer;
      });
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, film.triangles, gl.STATIC_DRAW);
    }
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.SCISSOR_TEST);
  }

  // The camera sees all frames of the run whose extent is the median one: a run that blew up would make the others a dot.
  frameAll() {
    const boxes = this.tracks.filter(films => films.length).map(films => {
      const low = [0, 1, 2].map(k => Math.min(...films.map(film => film.low[k])));
      const high = [0, 1, 2].map(k => Math.max(...films.map(film => film.low[k] + 65535 * film.scale[k])));
      return { middle: low.map((x, k) => (x + high[k]) / 2), radius: Math.hypot(...subtract(high, low)) / 2 };
    });
    boxes.sort((a, b) => a.radius - b.radius);
    const box = boxes[Math.floor((boxes.length - 1) / 2)] ?? { middle: [0, 0, 0], radius: 1 };
    this.target = box.middle;
    this.radius = box.radius || 1;
    Object.assign(this, { yaw: -0.9, pitch: 0.35, distance: 3.3 * this.radius });
  }

  listen() {
    this.button.onclick = () => this.timer ? this.pause() : this.play();
    this.slider.oninput = () => { this.pause(); this.go(+this.slider.value); };
    this.canvas.onpointerdown = event => this.canvas.setPointerCapture(event.pointerId);
    this.canvas.onpointermove = event => {
      if (!event.buttons) return;
      this.yaw -= 0.008 * event.movementX;
      this.pitch = Math.min(1.5, Math.max(-1.5, this.pitch + 0.008 * event.movementY));
      this.draw();
    };
    this.canvas.addEventListener("wheel", event => {
      event.preventDefault();
      this.distance *= Math.exp(0.001 * event.deltaY);
      this.draw();
    }, { passive: false });
  }

  play() {
    this.button.textContent = "Pause";
    this.figure.dataset.state = "playing";
    const first = this.frame + 1 < this.frames ? this.frame : 0, started = performance.now();
    const tick = now => {
      const frame = first + Math.floor(Math.max(0, now - started) / 1000 / this.seconds);
      this.go(Math.min(frame, this.frames - 1));
      if (frame >= this.frames - 1) this.pause();
      else this.timer = requestAnimationFrame(tick);
    };
    this.timer = requestAnimationFrame(tick);
  }

  pause() {
    cancelAnimationFrame(this.timer);
    this.timer = 0;
    this.button.textContent = "Play";
    this.figure.dataset.state = "paused";
  }

  go(frame) {
    if (frame === this.frame) return;
    this.frame = frame;
    this.figure.dataset.frame = frame;
    this.slider.value = frame;
    this.clock.textContent = (frame * this.seconds).toFixed(2) + " s";
    this.draw();
  }

  draw() {
    const gl = this.gl, ratio = window.devicePixelRatio || 1, stage = this.canvas.getBoundingClientRect();
    const [width, height] = [Math.round(stage.width * ratio), Math.round(stage.height * ratio)];
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    const ray = [Math.cos(this.pitch) * Math.sin(this.yaw), -Math.cos(this.pitch) * Math.cos(this.yaw), Math.sin(this.pitch)];
    const eye = this.target.map((x, k) => x + this.distance * ray[k]);
    const light = unit([ray[0] + 0.4, ray[1] - 0.2, ray[2] + 0.8]);
    gl.uniform3fv(this.uniforms.light, light);
    this.tracks.forEach((films, number) => {
      const tile = this.tiles[number].getBoundingClientRect();
      const box = [tile.left - stage.left, stage.bottom - tile.bottom, tile.width, tile.height].map(x => Math.round(x * ratio));
      gl.viewport(...box);
      gl.scissor(...box);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      const camera = view(eye, this.target, tile.width / tile.height, 0.02 * this.distance, this.distance + 20 * this.radius);
      gl.uniformMatrix4fv(this.uniforms.camera, false, camera);
      for (const film of films) {
        gl.bindVertexArray(film.array);
        if (film.show(this.frame)) [film.places, film.normals, film.reds].forEach((numbers, i) => {
          gl.bindBuffer(gl.ARRAY_BUFFER, film.buffers[i]);
          gl.bufferSubData(gl.ARRAY_BUFFER, 0, numbers);
        });
        gl.uniform3fv(this.uniforms.front, film.colors[0]);
        gl.uniform3fv(this.uniforms.back, film.colors[1]);
        gl.drawElements(gl.TRIANGLES, film.triangles.length, gl.UNSIGNED_INT, 0);
      }
    });
  }
}

document.querySelectorAll("figure.player").forEach(figure => { figure.player = new Player(figure); });
