"use strict";
// showScene(canvas, scene): draws the layers of a scene with WebGL 2; drag, wheel and double click
// turn, zoom and reset. Returns null where the browser has no WebGL 2.

// Depth by which lines on a surface, and a clear surface at the same place, come before it.
const LIFT = 0.0005;

function showScene(canvas, scene) {
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
  if (!gl) return null;

  const bytes = text => {
    const raw = atob(text), made = new Uint8Array(raw.length);
    for (let k = 0; k < raw.length; k++) made[k] = raw.charCodeAt(k);
    return made.buffer;
  };
  const rgb = hex => [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16) / 255);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                           a[0] * b[1] - a[1] * b[0]];
  const unit = a => { const n = Math.hypot(...a); return a.map(x => x / n); };

  const project = `uniform mat3 turn; uniform vec3 target; uniform vec2 scale; uniform vec2 shift;
    uniform float depth; uniform float lift;
    vec3 turned(vec3 place) { return turn * (place - target); }
    vec4 projected(vec3 seen) { 
      return vec4(seen.xy * scale + shift, -seen.z * depth - lift, 1.0); }`;

  function program(vertex, fragment, ...inputs) {
    const made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, project + vertex],
                                [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, "#version 300 es\nprecision highp float;\n" + text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
        throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    }
    inputs.forEach((name, k) => gl.bindAttribLocation(made, k, name));
    gl.linkProgram(made);
    return made;
  }

  // The normal of a facet is that of its picture: no normals need be kept. What is seen from
  // inside is red.
  const facets = program(`in vec3 place; out vec3 seen;
    void main() { seen = turned(place); gl_Position = projected(seen); }`,
    `uniform vec4 tint; in vec3 seen; out vec4 color;
    void main() { vec3 n = normalize(cross(dFdx(seen), dFdy(seen)));
      float light = 0.40 + 0.69 * max(dot(n, normalize(vec3(0.35, 0.5, 0.8))), 0.0)
                    + 0.16 * max(dot(n, normalize(vec3(-0.7, -0.2, 0.6))), 0.0);
      vec3 base = gl_FrontFacing ? tint.rgb : vec3(0.86, 0.45, 0.42);
      color = vec4(base * light, tint.a); }`, "place");
  const dots = program(`uniform float size; in vec3 place;
    void main() { gl_PointSize = size; gl_Position = projected(turned(place)); }`,
    `uniform vec4 tint; uniform float size; out vec4 color;
    void main() { float r = length(gl_PointCoord - 0.5) * size; if (2.0 * r > size) discard;
      color = 2.0 * r > 0.86 * size - 1.0 ? vec4(1.0, 1.0, 1.0, tint.a) : tint; }`, "place");
  // A segment is a strip of two triangles, as wide in pixels as asked: WebGL draws no wide lines.
  const segments = program(`uniform vec2 pixels; uniform float size; in vec3 start; in vec3 end;
    void main() { vec4 a = projected(turned(start)), b = projected(turned(end));
      vec2 along = (b.xy - a.xy) * pixels;
      vec2 aside = dot(along, along) > 0.0 ? normalize(vec2(-along.y, along.x)) : vec2(1.0, 0.0);
      gl_Position = (gl_VertexID & 1) == 0 ? a : b;
      gl_Position.xy += (gl_VertexID < 2 ? -1.0 : 1.0) * aside * size / pixels; }`,
    `uniform vec4 tint; out vec4 color; void main() { color = tint; }`, "start", "end");

  function buffer(data, kind = gl.ARRAY_BUFFER) {
    gl.bindBuffer(kind, gl.createBuffer());
    gl.bufferData(kind, data, gl.STATIC_DRAW);
  }
  function vertexArray(fill) {
    const made = gl.createVertexArray();
    gl.bindVertexArray(made);
    fill();
    gl.bindVertexArray(null);
    return made;
  }
  function places(data) {
    buffer(data);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
  }

  function loaded(part) {
    const points = new Float32Array(bytes(part.points));
    const rows = part.rows && new Uint32Array(bytes(part.rows));
    const made = { ...part, tint: rgb(part.color) };
    if (part.kind === "surface") {
      made.count = rows.length;
      made.array = vertexArray(() => { places(points); buffer(rows, gl.ELEMENT_ARRAY_BUFFER); });
    } else if (part.kind === "dots") {
      made.count = points.length / 3;
      made.array = vertexArray(() => places(points));
    } else {
      const ends = new Float32Array(3 * rows.length);
      for (let k = 0; k < rows.length; k++)
        for (let x = 0; x < 3; x++) ends[3 * k + x] = points[3 * rows[k] + x];
      made.count = rows.length / 2;
      made.array = segmentArray(ends);
    }
    return made;
  }
  function segmentArray(ends) {
    return vertexArray(() => {
      buffer(ends);
      for (const k of [0, 1]) {
        gl.enableVertexAttribArray(k);
        gl.vertexAttribPointer(k, 3, gl.FLOAT, false, 24, 12 * k);
        gl.vertexAttribDivisor(k, 1);
      }
    });
  }

  const up = scene.up, side = unit(cross(Math.abs(up[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0], up));
  const front = cross(up, side);
  const layers = new Map(scene.layers.map(layer => [
    layer.name, { shown: layer.shown, parts: layer.parts.map(loaded) }]));
  const plate = plateBelow();

  function plateBelow() {
    const step = 10 ** Math.floor(Math.log10(scene.size / 2)), ends = [];
    const half = Math.ceil(scene.size * 0.7 / step);
    const base = up.map(u => u * scene.floor);
    for (let i = -half; i <= half; i++) for (const [a, b] of [[side, front], [front, side]])
      for (const j of [-half, half])
        ends.push(...base.map((c, k) => c + step * (i * a[k] + j * b[k])));
    return { array: segmentArray(new Float32Array(ends)), count: ends.length / 6,
             tint: [0.55, 0.62, 0.7], width: 1 };
  }

  let azimuth, height, zoom, target, shift;
  function reset() {
    azimuth = -0.6; height = 0.45; zoom = 1; target = [0, 0, 0]; shift = [0, 0];
  }

  function draw() {
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.max(1, canvas.clientWidth * ratio);
    canvas.height = Math.max(1, canvas.clientHeight * ratio);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0.93, 0.945, 0.96, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const flat = side.map((s, k) => Math.sin(azimuth) * s + Math.cos(azimuth) * -front[k]);
    const z = flat.map((f, k) => Math.cos(height) * f + Math.sin(height) * up[k]);
    const x = unit(cross(up, z)), y = cross(z, x);
    const scale = 1.9 * zoom / scene.size * Math.min(canvas.width, canvas.height);

    function use(made, part, opacity, size, lift) {
      gl.useProgram(made);
      const at = name => gl.getUniformLocation(made, name);
      gl.uniformMatrix3fv(at("turn"), false, [x[0], y[0], z[0], x[1], y[1], z[1],
                                              x[2], y[2], z[2]]);
      gl.uniform3fv(at("target"), target);
      gl.uniform2f(at("scale"), scale / canvas.width, scale / canvas.height);
      gl.uniform2fv(at("shift"), shift);
      gl.uniform1f(at("depth"), 0.4 / scene.size);
      gl.uniform1f(at("lift"), lift);
      gl.uniform2f(at("pixels"), canvas.width, canvas.height);
      gl.uniform1f(at("size"), size * ratio);
      gl.uniform4f(at("tint"), ...part.tint, opacity);
      gl.bindVertexArray(part.array);
    }
    function drawSegments(part, opacity) {
      use(segments, part, opacity, part.width, LIFT);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, part.count);
    }
    const clear = part => part.opacity < 1;
    function drawSurface(part) {
      use(facets, part, part.opacity, 0, clear(part) ? LIFT : 0);
      gl.drawElements(gl.TRIANGLES, part.count, gl.UNSIGNED_INT, 0);
    }

    const parts = [...layers.values()].filter(layer => layer.shown).flatMap(layer => layer.parts);
    const kind = name => parts.filter(part => part.kind === name);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthFunc(gl.LEQUAL);
    drawSegments(plate, 0.6);
    for (const part of kind("surface")) if (!clear(part)) drawSurface(part);
    for (const part of kind("lines")) drawSegments(part, 1);
    gl.enable(gl.CULL_FACE);
    gl.depthMask(false);
    for (const part of kind("surface")) if (clear(part)) drawSurface(part);
    gl.depthMask(true);
    gl.disable(gl.CULL_FACE);
    // What is behind a surface shines through it.
    for (const [test, opacity] of [[gl.GREATER, 0.5], [gl.LEQUAL, 1]]) {
      gl.depthFunc(test);
      gl.depthMask(test === gl.LEQUAL);
      for (const part of kind("lines")) if (part.through) drawSegments(part, opacity);
      for (const part of kind("dots")) {
        use(dots, part, opacity, part.size, LIFT);
        gl.drawArrays(gl.POINTS, 0, part.count);
      }
    }
  }

  let held = null;
  canvas.addEventListener("contextmenu", event => event.preventDefault());
  canvas.addEventListener("pointerdown", event => {
    held = event; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointerup", () => { held = null; });
  canvas.addEventListener("pointermove", event => {
    if (!held) return;
    const dx = event.clientX - held.clientX, dy = event.clientY - held.clientY;
    if (held.buttons & 2 || held.shiftKey) {
      shift = [shift[0] + 2 * dx / canvas.clientWidth, shift[1] - 2 * dy / canvas.clientHeight];
    } else {
      azimuth -= dx * 0.01;
      height = Math.max(-1.55, Math.min(1.55, height + dy * 0.01));
    }
    held = { clientX: event.clientX, clientY: event.clientY, buttons: event.buttons,
             shiftKey: event.shiftKey };
    draw();
  });
  canvas.addEventListener("wheel", event => {
    event.preventDefault(); zoom *= Math.exp(-event.deltaY * 0.001); draw(); },
    { passive: false });
  canvas.addEventListener("dblclick", () => { reset(); draw(); });
  window.addEventListener("resize", draw);
  reset();
  draw();

  return {
    show(name, shown) { layers.get(name).shown = shown; draw(); },
    // Brings the first dot of a layer to the middle.
    look(name) {
      const marks = scene.layers.find(layer => layer.name === name).parts
        .find(part => part.kind === "dots");
      target = [...new Float32Array(bytes(marks.points)).subarray(0, 3)];
      shift = [0, 0];
      zoom = Math.max(zoom, 2);
      draw();
    },
  };
}
