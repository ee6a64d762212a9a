"use strict";
// The page's behaviour: sorting and picking always; the 3-D view where WebGL2 is to be had.

const find = (selector, root = document) => root.querySelector(selector);
const findAll = (selector, root = document) => Array.from(root.querySelectorAll(selector));

const report = { selected: -1, view: null };

// --- Picking a panel: table row, flat pattern and 3-D view follow each other -------------------------------------

function select(index, scroll) {
  report.selected = index;
  for (const item of findAll("[data-panel]")) {
    item.classList.toggle("selected", Number(item.dataset.panel) === index);
  }
  const row = index < 0 ? null : find("#panel-" + index);
  const card = find("#picked");
  card.hidden = !row;
  if (row) {
    const heads = findAll("#table thead th button").map((b) => b.textContent);
    card.replaceChildren();
    const name = document.createElement("b");
    name.textContent = row.cells[0].textContent;
    const table = document.createElement("table");
    for (let k = 1; k < row.cells.length; k++) {
      const line = table.insertRow();
      line.insertCell().textContent = heads[k];
      line.insertCell().append(...Array.from(row.cells[k].cloneNode(true).childNodes));
    }
    card.append(name, table);
    if (scroll) {
      // Only the table scrolls; the page stays where the reader is.
      const box = find("#panels .scroll");
      box.scrollTop = row.offsetTop - box.clientHeight / 2;
    }
  }
  if (report.view) report.view.redraw();
}

function listen() {
  for (const row of findAll("#table tbody tr")) {
    const pick = () => select(Number(row.dataset.panel), false);
    row.addEventListener("click", pick);
    row.addEventListener("keydown", (e) => { if (e.key === "Enter") pick(); });
  }
  for (const piece of findAll("svg.flat g")) {
    piece.addEventListener("click", () => select(Number(piece.dataset.panel), true));
  }
  for (const link of findAll("a[data-pick]")) {
    link.addEventListener("click", () => select(Number(link.dataset.pick), true));
  }
  const heads = findAll("#table thead th");
  heads.forEach((head, column) => find("button", head).addEventListener("click", () => {
    const up = head.getAttribute("aria-sort") !== "ascending";
    for (const other of heads) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", up ? "ascending" : "descending");
    const body = find("#table tbody");
    const value = (row) => row.cells[column].dataset.value;
    const order = (a, b) => {
      const [x, y] = [Number(value(a)), Number(value(b))];
      const both = Number.isNaN(x) || Number.isNaN(y) ? value(a).localeCompare(value(b), "en", { numeric: true }) : x < y ? -1 : x > y ? 1 : 0;
      return up ? both : -both;
    };
    body.append(...Array.from(body.rows).sort(order));
  }));
}

// --- Small linear algebra: vectors as arrays, matrices column by column -------------------------------------------

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const add = (a, b, s) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const unit = (a) => { const n = Math.hypot(...a); return a.map((x) => x / n); };

function multiply(a, b) {
  const m = new Float32Array(16);
  for (let i = 0; i < 4; i++) {
    for (let j = 0; j < 4; j++) {
      for (let k = 0; k < 4; k++) m[4 * j + i] += a[4 * k + i] * b[4 * j + k];
    }
  }
  return m;
}

// --- Shaders ------------------------------------------------------------------------------------------------------

const MESH_VERTEX = `#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float value;
layout(location = 3) in vec3 colour;
layout(location = 4) in uint panel;
layout(location = 5) in float curvature;
uniform mat4 camera;
uniform bool bent;
out vec3 place, direction, base;
out float deviation;
flat out uint owner;
void main() {
  place = position; direction = normal; base = colour; deviation = bent ? curvature : value; owner = panel;
  gl_Position = camera * vec4(position, 1.0);
}`;

const MESH_FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
in vec3 place, direction, base;
in float deviation;
flat in uint owner;
uniform vec3 eye, right, up;
uniform float tolerance, alpha;
uniform int selected;
uniform bool coloured, picking, striped, bent;
uniform sampler2D scale;
out vec4 pixel;
void main() {
  if (picking) {
    uint k = owner + 1u;
    pixel = vec4(float(k & 255u), float((k >> 8) & 255u), float((k >> 16) & 255u), 255.0) / 255.0;
    return;
  }
  vec3 toward = normalize(eye - place);
  vec3 n = dot(direction, direction) > 0.25 ? normalize(direction) : normalize(cross(dFdx(place), dFdy(place)));
  if (dot(n, toward) < 0.0) n = -n;
  vec3 c = base;
  if (coloured) {
    float share = deviation / tolerance;
    if (bent) share = clamp(share, -1.0, 1.0);
    int last = textureSize(scale, 0).x - 1;
    c = abs(share) > 1.000001
      ? texelFetch(scale, ivec2(last, 0), 0).rgb
      : texelFetch(scale, ivec2(int((share * 0.5 + 0.5) * float(last - 1) + 0.5), 0), 0).rgb;
  }
  bool other = selected >= 0 && int(owner) != selected;
  if (other) c = mix(c, vec3(0.78), coloured ? 0.35 : 0.72);
  vec3 lamp = normalize(-0.55 * right + 0.7 * up + 0.85 * toward);
  float sky = 0.5 + 0.5 * dot(n, up);
  float soft = max((dot(n, lamp) + 0.35) / 1.35, 0.0);
  float gloss = pow(max(dot(n, normalize(lamp + toward)), 0.0), 40.0);
  float level = (coloured ? 0.66 : 0.58) * (0.72 + 0.28 * sky) + (coloured ? 0.38 : 0.5) * soft;
  c = c * level + gloss * (coloured ? 0.04 : 0.12);
  if (striped) {
    // Parallel lamps far away, square to the view's upright: their images break where surfaces meet at an angle and have
    // corners where curvature jumps.
    vec3 image = reflect(-toward, n);
    float lamp_angle = atan(dot(image, up), dot(image, toward));
    float wave = sin(24.0 * lamp_angle), edge = max(fwidth(wave), 0.05);
    c = mix(c * 0.45 + 0.5, vec3(0.06, 0.08, 0.12), smoothstep(-edge, edge, wave) * (other ? 0.35 : 1.0));
  }
  pixel = vec4(min(c, 1.0) * alpha, alpha);
}`;

// Each segment is a rectangle as wide as the pen, spanned on the screen.
const LINE_VERTEX = `#version 300 es
layout(location = 0) in vec2 corner;
layout(location = 1) in vec3 a;
layout(location = 2) in vec3 b;
layout(location = 3) in uint panel;
layout(location = 4) in float value;
uniform mat4 camera;
uniform vec2 size;
uniform float pen, lift;
uniform int selected;
out float strength, measure;
void main() {
  measure = value;
  vec4 p = camera * vec4(a, 1.0), q = camera * vec4(b, 1.0);
  const float near = 1e-4;
  if (p.w < near && q.w < near) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
  if (p.w < near) p = mix(p, q, (near - p.w) / (q.w - p.w));
  if (q.w < near) q = mix(q, p, (near - q.w) / (p.w - q.w));
  vec2 d = (q.xy / q.w - p.xy / p.w) * size;
  d = dot(d, d) > 0.0 ? normalize(d) : vec2(1.0, 0.0);
  bool own = selected < 0 || int(panel) == selected;
  float width = own && selected >= 0 ? pen * 1.5 : pen;
  strength = own ? 1.0 : 0.35;
  vec4 at = corner.x < 0.5 ? p : q;
  vec2 shift = vec2(-d.y, d.x) * corner.y + d * (corner.x * 2.0 - 1.0) * 0.5;
  at.xy += shift * width / size * at.w;
  at.z -= lift * at.w;
  gl_Position = at;
}`;

const LINE_FRAGMENT = `#version 300 es
precision highp float;
in float strength, measure;
uniform vec4 ink;
uniform float end;
uniform sampler2D scale;
out vec4 pixel;
void main() {
  float a = ink.a * strength;
  vec3 c = ink.rgb;
  if (end > 0.0) {
    int last = textureSize(scale, 0).x - 1;
    c = texelFetch(scale, ivec2(int(clamp(measure / end, 0.0, 1.0) * float(last - 1) + 0.5), 0), 0).rgb;
  }
  pixel = vec4(c * a, a);
}`;

function program(gl, vertex, fragment) {
  const p = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const s = gl.createShader(kind);
    gl.shaderSource(s, source);
    gl.compileShader(s);
    if (!gl.getShaderParameter(s, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(s));
    gl.attachShader(p, s);
  }
  gl.linkProgram(p);
  if (!gl.getProgramParameter(p, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(p));
  const at = {};
  for (let i = 0; i < gl.getProgramParameter(p, gl.ACTIVE_UNIFORMS); i++) {
    const name = gl.getActiveUniform(p, i).name;
    at[name] = gl.getUniformLocation(p, name);
  }
  return { p, at };
}

// --- The 3-D view -------------------------------------------------------------------------------------------------

function open_view(canvas, gl) {
  const scene = JSON.parse(find("#scene").textContent);
  const text = atob(find("#geometry").textContent.trim());
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);

  const shading = program(gl, MESH_VERTEX, MESH_FRAGMENT);
  const drawing = program(gl, LINE_VERTEX, LINE_FRAGMENT);
  const FOV = 24 * Math.PI / 180;
  const shown = { panels: true, surface: false, rulings: true, borders: true, deviation: false, curvature: false, joints: false, witnesses: true, reflections: false };
  let eye_at;

  const upload = (from, length, target = gl.ARRAY_BUFFER) => {
    const buffer = gl.createBuffer();
    gl.bindBuffer(target, buffer);
    gl.bufferData(target, bytes.subarray(from, from + length), gl.STATIC_DRAW);
    return buffer;
  };

  const mesh = (part) => {
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const float = (slot, from, width, type, bytesEach, normalised) => {
      upload(from, part.vertices * bytesEach);
      gl.enableVertexAttribArray(slot);
      gl.vertexAttribPointer(slot, width, type, normalised, bytesEach, 0);
    };
    float(0, part.position, 3, gl.FLOAT, 12, false);
    float(1, part.normal, 3, gl.SHORT, 8, true);
    float(2, part.value, 1, gl.FLOAT, 4, false);
    float(3, part.colour, 3, gl.UNSIGNED_BYTE, 4, true);
    upload(part.panel, part.vertices * 4);
    gl.enableVertexAttribArray(4);
    gl.vertexAttribIPointer(4, 1, gl.UNSIGNED_INT, 4, 0);
    float(5, part.curvature, 1, gl.FLOAT, 4, false);
    upload(part.index, part.indices * 4, gl.ELEMENT_ARRAY_BUFFER);
    gl.bindVertexArray(null);
    return { array, count: part.indices };
  };

  const lines = (part) => {
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([0, -1, 1, -1, 0, 1, 1, 1]), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 8, 0);
    upload(part.ends, part.segments * 24);
    for (const slot of [1, 2]) {
      gl.enableVertexAttribArray(slot);
      gl.vertexAttribPointer(slot, 3, gl.FLOAT, false, 24, (slot - 1) * 12);
      gl.vertexAttribDivisor(slot, 1);
    }
    upload(part.panel, part.segments * 4);
    gl.enableVertexAttribArray(3);
    gl.vertexAttribIPointer(3, 1, gl.UNSIGNED_INT, 4, 0);
    gl.vertexAttribDivisor(3, 1);
    upload(part.value, part.segments * 4);
    gl.enableVertexAttribArray(4);
    gl.vertexAttribPointer(4, 1, gl.FLOAT, false, 4, 0);
    gl.vertexAttribDivisor(4, 1);
    gl.bindVertexArray(null);
    return { array, count: part.segments };
  };

  const parts = { panels: mesh(scene.panels), surface: mesh(scene.surface), rulings: lines(scene.rulings), borders: lines(scene.borders), joints: lines(scene.joints), witnesses: lines(scene.witnesses) };
  // Without panels there is still the surface to look at.
  const whole = scene.panels.indices > 0 ? scene.panels : scene.surface;
  const positions = new Float32Array(bytes.buffer, whole.position, 3 * whole.vertices);
  if (whole === scene.surface) {
    shown.surface = true;
    find('[data-toggle="surface"]').setAttribute("aria-pressed", "true");
  }

  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  const colours = new Uint8Array(scene.scale.flatMap((c) => [...c, 255]));
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, scene.scale.length, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, colours);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);

  // The legend shows the same colours.
  const ramp = find("#ramp").getContext("2d");
  scene.scale.slice(0, -1).forEach((c, i, all) => {
    ramp.fillStyle = "rgb(" + c.join(",") + ")";
    ramp.fillRect(0, all.length - 1 - i, 1, 2);
  });

  // Camera: the eye on a sphere around the target, z upwards.
  const home = () => {
    const d = unit(scene.direction);
    eye_at = { target: [0, 0, 0], azimuth: Math.atan2(d[1], d[0]), elevation: Math.asin(d[2]), distance: 1 };
    // As near as all vertices stay inside the picture.
    const { right, up, toward } = axes();
    const slope = Math.tan(FOV / 2), aspect = canvas.clientWidth / Math.max(canvas.clientHeight, 1);
    let [x0, x1, y0, y1] = [Infinity, -Infinity, Infinity, -Infinity];
    const step = 3 * Math.max(1, Math.floor(positions.length / 60000));
    const each = (act) => { for (let i = 0; i < positions.length; i += step) act([positions[i], positions[i + 1], positions[i + 2]]); };
    each((p) => {
      x0 = Math.min(x0, dot(p, right)); x1 = Math.max(x1, dot(p, right));
      y0 = Math.min(y0, dot(p, up)); y1 = Math.max(y1, dot(p, up));
    });
    if (x0 > x1) { eye_at.distance = scene.radius / slope; return; }
    eye_at.target = add(add([0, 0, 0], right, (x0 + x1) / 2), up, (y0 + y1) / 2);
    let distance = 0;
    each((p) => {
      const q = add(p, eye_at.target, -1);
      const reach = Math.max(Math.abs(dot(q, right)) / aspect, Math.abs(dot(q, up))) / slope;
      distance = Math.max(distance, dot(q, toward) + reach);
    });
    eye_at.distance = 1.07 * distance || scene.radius / slope;
  };

  const axes = () => {
    const { azimuth: a, elevation: e } = eye_at;
    const toward = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
    const right = [-Math.sin(a), Math.cos(a), 0];
    const up = [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)];
    return { right, up, toward, eye: add(eye_at.target, toward, eye_at.distance) };
  };

  const camera = ({ right, up, toward, eye }) => {
    const reach = Math.hypot(...eye) + scene.radius;
    const near = Math.max(eye_at.distance - 2.5 * scene.radius - Math.hypot(...eye_at.target), 0.01 * eye_at.distance);
    const f = 1 / Math.tan(FOV / 2), aspect = canvas.width / Math.max(canvas.height, 1);
    const projection = [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (reach + near) / (near - reach), -1, 0, 0, 2 * reach * near / (near - reach), 0];
    const view = [right[0], up[0], toward[0], 0, right[1], up[1], toward[1], 0, right[2], up[2], toward[2], 0, -dot(right, eye), -dot(up, eye), -dot(toward, eye), 1];
    return multiply(projection, view);
  };

  const paint = (picking) => {
    const see = axes(), matrix = camera(see);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.disable(gl.BLEND);
    gl.useProgram(shading.p);
    const at = shading.at;
    gl.uniformMatrix4fv(at.camera, false, matrix);
    gl.uniform3fv(at.eye, see.eye);
    gl.uniform3fv(at.right, see.right);
    gl.uniform3fv(at.up, see.up);
    const coloured = shown.deviation || shown.curvature;
    gl.uniform1f(at.tolerance, shown.curvature ? scene.curvature : scene.tolerance);
    gl.uniform1i(at.bent, shown.curvature ? 1 : 0);
    gl.uniform1i(at.selected, picking ? -1 : report.selected);
    gl.uniform1i(at.picking, picking ? 1 : 0);
    const triangles = (part, alpha, coloured) => {
      gl.uniform1f(at.alpha, alpha);
      gl.uniform1i(at.coloured, coloured ? 1 : 0);
      gl.uniform1i(at.striped, shown.reflections && !picking ? 1 : 0);
      gl.bindVertexArray(part.array);
      gl.drawElements(gl.TRIANGLES, part.count, gl.UNSIGNED_INT, 0);
    };
    // Pushed back a little, so that lines on the surface lie in front.
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1.5, 2);
    if (shown.panels || picking) triangles(parts.panels, 1, coloured);
    if (picking) return;
    if (shown.surface) {
      gl.uniform1i(at.selected, -1);
      if (shown.panels) {
        // A veil in front of the panels: the two lie too close together to be told apart by depth.
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
        gl.depthMask(false);
        gl.polygonOffset(-1, -2);
        triangles(parts.surface, 0.45, false);
        gl.depthMask(true);
      } else {
        triangles(parts.surface, 1, shown.curvature);
      }
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    gl.useProgram(drawing.p);
    gl.uniformMatrix4fv(drawing.at.camera, false, matrix);
    gl.uniform2f(drawing.at.size, canvas.width, canvas.height);
    gl.uniform1i(drawing.at.selected, report.selected);
    gl.uniform1f(drawing.at.lift, 4e-4);
    const dots = canvas.width / Math.max(canvas.clientWidth, 1);
    const segments = (part, pen, ink, end = 0) => {
      gl.uniform1f(drawing.at.pen, pen * dots);
      gl.uniform1f(drawing.at.end, end);
      gl.uniform4fv(drawing.at.ink, ink);
      gl.bindVertexArray(part.array);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, part.count);
    };
    if (shown.rulings) segments(parts.rulings, 1, [0.1, 0.12, 0.16, 0.42]);
    if (shown.borders) segments(parts.borders, 1.9, [0.08, 0.1, 0.14, 0.95]);
    if (shown.joints) segments(parts.joints, 4.5, [0, 0, 0, 1], scene.angle);
    if (shown.witnesses && parts.witnesses.count > 0) {
      // Places where something is wrong are seen through everything.
      gl.disable(gl.DEPTH_TEST);
      gl.uniform1i(drawing.at.selected, -1);
      segments(parts.witnesses, 18, [1, 1, 1, 1]);
      segments(parts.witnesses, 12, [0, 0, 0, 1]);
    }
    gl.depthMask(true);
    gl.bindVertexArray(null);
  };

  let waiting = false;
  const redraw = () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; paint(false); });
  };

  const fit = () => {
    const dots = Math.min(window.devicePixelRatio || 1, 2);
    const [w, h] = [Math.max(1, Math.round(canvas.clientWidth * dots)), Math.max(1, Math.round(canvas.clientHeight * dots))];
    if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
    redraw();
  };

  // What the first picture shows at a place (pixels of the page, from the canvas' corner): a panel or −1.
  const panel_at = (x, y) => {
    paint(true);
    const dots = canvas.width / Math.max(canvas.clientWidth, 1);
    const pixel = new Uint8Array(4);
    gl.readPixels(Math.round(x * dots), Math.round(canvas.height - 1 - y * dots), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    paint(false);
    return pixel[3] === 255 ? pixel[0] + 256 * pixel[1] + 65536 * pixel[2] - 1 : -1;
  };

  // Number of pixels that show something: lets a check tell an empty canvas.
  const drawn_pixels = () => {
    paint(false);
    const all = new Uint8Array(4 * canvas.width * canvas.height);
    gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, all);
    let count = 0;
    for (let i = 3; i < all.length; i += 4) if (all[i] > 0) count++;
    return count;
  };

  // --- Hands: mouse, touch and keys ---
  const turn = (dx, dy) => {
    eye_at.azimuth -= dx * 0.008;
    eye_at.elevation = Math.max(-1.5706, Math.min(1.5706, eye_at.elevation + dy * 0.008));
    redraw();
  };
  const move = (dx, dy) => {
    const { right, up } = axes();
    const per = 2 * eye_at.distance * Math.tan(FOV / 2) / Math.max(canvas.clientHeight, 1);
    eye_at.target = add(add(eye_at.target, right, -dx * per), up, dy * per);
    redraw();
  };
  const zoom = (factor) => {
    eye_at.distance = Math.max(0.02 * scene.radius, Math.min(60 * scene.radius, eye_at.distance * factor));
    redraw();
  };
  const fingers = new Map();
  let travelled = 0;
  canvas.addEventListener("pointerdown", (e) => {
    canvas.focus({ preventScroll: true });
    try { canvas.setPointerCapture(e.pointerId); } catch { /* a made-up pointer cannot be captured */ }
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
    if (fingers.size === 1) travelled = 0;
  });
  canvas.addEventListener("pointermove", (e) => {
    const before = fingers.get(e.pointerId);
    if (!before) return;
    const [dx, dy] = [e.clientX - before[0], e.clientY - before[1]];
    travelled += Math.abs(dx) + Math.abs(dy);
    if (fingers.size === 2) {
      const other = Array.from(fingers.entries()).find(([id]) => id !== e.pointerId)[1];
      const gap = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
      const [old, now] = [gap(before), gap([e.clientX, e.clientY])];
      if (old > 0 && now > 0) zoom(old / now);
      move(dx / 2, dy / 2);
    } else if (e.shiftKey || e.buttons & 6) {
      move(dx, dy);
    } else {
      turn(dx, dy);
    }
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
  });
  const release = (e) => {
    const one = fingers.size === 1 && fingers.delete(e.pointerId);
    fingers.delete(e.pointerId);
    if (one && e.type === "pointerup" && travelled < 5) {
      const box = canvas.getBoundingClientRect();
      select(panel_at(e.clientX - box.left, e.clientY - box.top), true);
    }
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  canvas.addEventListener("wheel", (e) => {
    // The page scrolls past the view until the reader has clicked into it.
    if (document.activeElement !== canvas && !e.ctrlKey) return;
    e.preventDefault();
    zoom(Math.exp(Math.max(-60, Math.min(60, e.deltaY * (e.deltaMode ? 20 : 1))) * 0.0025));
  }, { passive: false });
  canvas.addEventListener("keydown", (e) => {
    const acts = {
      ArrowLeft: () => turn(-12, 0), ArrowRight: () => turn(12, 0), ArrowUp: () => turn(0, 12), ArrowDown: () => turn(0, -12),
      "+": () => zoom(0.85), "-": () => zoom(1 / 0.85), Escape: () => select(-1, false), Home: () => { home(); redraw(); },
    };
    if (acts[e.key]) { e.preventDefault(); acts[e.key](); }
  });
  // Ends of the scale that is shown; those of distances come with the page.
  const ends = findAll("#legend span");
  const given = ends.map((e) => e.textContent);
  const figures = (x) => Number(x.toPrecision(3)).toString();
  const legend = () => {
    find("#legend").hidden = !(shown.deviation || shown.curvature || shown.joints);
    const per_metre = figures(scene.curvature * 1e6) + "\u00a0/m\u00b2";
    const words = shown.curvature ? ["+" + per_metre, "\u2212" + per_metre] : shown.joints ? [figures(scene.angle) + "\u00b0", "0\u00b0"] : given;
    ends.forEach((e, k) => { e.textContent = words[k]; });
  };
  for (const button of findAll("[data-toggle]")) {
    button.addEventListener("click", () => {
      const name = button.dataset.toggle;
      shown[name] = !shown[name];
      // One scale of colours at a time.
      const scales = ["deviation", "curvature", "joints"];
      for (const other of scales) if (scales.includes(name) && other !== name) shown[other] = false;
      for (const b of findAll("[data-toggle]")) b.setAttribute("aria-pressed", String(shown[b.dataset.toggle]));
      legend();
      redraw();
    });
  }
  find("#home").addEventListener("click", () => { home(); redraw(); });
  canvas.addEventListener("webglcontextlost", () => still("The 3-D view was closed by the browser; reload the page to open it again."));

  fit();
  home();
  new ResizeObserver(fit).observe(canvas);
  return { redraw, panel_at, drawn_pixels };
}

function still(words) {
  report.view = null;
  find("#view").classList.add("flatview");
  find("#hint").textContent = words;
}

listen();
const canvas = find("#canvas");
const gl = canvas.getContext("webgl2", { antialias: true, alpha: true, premultipliedAlpha: true });
if (gl) {
  report.view = open_view(canvas, gl);
  window.torse = { select, drawn_pixels: report.view.drawn_pixels, panel_at: report.view.panel_at, selected: () => report.selected };
} else {
  still("This browser has no WebGL2, so here is a still picture instead of the 3-D view.");
}
document.documentElement.dataset.view = gl ? "live" : "still";
