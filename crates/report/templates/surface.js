// The walls of a run in space: drag turns them, the wheel or two fingers zoom, shift or the right button moves, double-click resets.
// Colours are looked up pixel by pixel, so that a shock stays sharp on large triangles. The pointer reads the values below it.
(() => {
  "use strict";
  const { ticks, show, mix, part } = Alula;
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const words = (text) => new Uint16Array(bytes(text).buffer);
  const make = (parent, name, properties) => parent.appendChild(Object.assign(document.createElement(name), properties));
  const [LEFT, RIGHT, TOP, BOTTOM] = [8, 96, 8, 8], STEPS = 65535;
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const along = (a, s, b) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
  // Azimuth and elevation of the eye, in degrees: x is downstream, z up.
  const VIEWS = { iso: [-142, 28], top: [-90, 90], bottom: [-90, -90], side: [-90, 0], front: [180, 0], rear: [0, 0] };
  // Room around what is shown at first.
  const ROOM = 1.1;
  // Lines of equal value from the least to the greatest colour.
  const LINES = 18;

  const VERTEX = `#version 300 es
    in vec3 place, normal; in float value;
    uniform vec3 low, high, sign, shift, right, up, eye, centre; uniform vec2 half_size; uniform float radius, lift;
    out vec3 n; out float v;
    void main() {
      vec3 x = sign * mix(low, high, place) + shift - centre;
      n = sign * normal;
      v = value;
      gl_Position = vec4(dot(right, x) / half_size.x, dot(up, x) / half_size.y, -dot(eye, x) / radius - lift, 1.0);
    }`;
  // Light comes from behind the left shoulder of the viewer; what is seen from inside a body is grey.
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 n; in float v;
    uniform vec3 right, up, eye; uniform vec2 ends; uniform float spacing, sonic; uniform bool mirrored, lit, edges;
    uniform sampler2D colours;
    out vec4 colour;
    float line(float f, float width) { return 1.0 - smoothstep(width - 0.5, width + 0.5, abs(f) / max(fwidth(f), 1e-9)); }
    void main() {
      if (edges) { colour = vec4(0.08, 0.09, 0.12, 1.0) * 0.6; return; }
      vec3 c = texture(colours, vec2(clamp((v - ends.x) / (ends.y - ends.x), 0.002, 0.998), 0.5)).rgb;
      if (spacing > 0.0) {
        float f = v / spacing;
        float near = f - round(f);
        c = mix(c, vec3(0.16, 0.17, 0.2), 0.55 * (1.0 - smoothstep(0.3, 1.1, abs(near) / max(fwidth(f), 1e-9))));
      }
      if (sonic > -1e30) c = mix(c, vec3(0.05), line(v - sonic, 1.3));
      if (gl_FrontFacing == mirrored) c = vec3(0.62, 0.64, 0.67);
      float size = max(length(n), 1e-6), facing = dot(n, eye) / size;
      vec3 seen = vec3(dot(n, right), dot(n, up), dot(n, eye)) / size * (facing < 0.0 ? -1.0 : 1.0);
      float light = lit ? 0.6 + 0.46 * max(dot(seen, normalize(vec3(-0.35, 0.55, 0.76))), 0.0) : 1.0;
      colour = vec4(c * light, 1.0);
    }`;

  function viewer(figure) {
    const data = JSON.parse(figure.querySelector("script").textContent), n = data.points;
    const places = words(data.places), normals = new Int8Array(bytes(data.normals).buffer), body = bytes(data.body);
    const packed = bytes(data.triangles), corners = new Uint32Array(packed.length / 3);
    for (let k = 0; k < corners.length; k++) corners[k] = packed[3 * k] | (packed[3 * k + 1] << 8) | (packed[3 * k + 2] << 16);
    const fields = data.fields.map((f) => ({ ...f, values: words(f.values) }));
    const scales = [data.sequential, data.diverging].map(bytes);
    const x = new Float64Array(3 * n);
    for (let k = 0; k < 3 * n; k++) x[k] = mix([data.low[k % 3], data.high[k % 3]], places[k] / STEPS);

    // Controls.
    const bar = make(figure, "div", { className: "controls" });
    const label = (text) => make(bar, "label", { textContent: text + " " });
    const choice = make(label("Colours"), "select", { ariaLabel: "quantity" });
    fields.forEach((f, k) => make(choice, "option", { value: k, textContent: f.name }));
    const low = make(label("from"), "input", { type: "number", step: "any" }), high = make(label("to"), "input", { type: "number", step: "any" });
    const tick = (text, checked, hidden = false) => {
      const box = document.createElement("input"), own = label("");
      own.prepend(Object.assign(box, { type: "checkbox", checked }), " " + text);
      own.hidden = hidden;
      return box;
    };
    const halved = data.mirrors.length > 0;
    const [whole, lines, mesh, lamp] = [tick("mirror image", halved, !halved), tick("contour lines", true), tick("triangles", false), tick("light", true)];
    const save = make(bar, "button", { type: "button", textContent: "PNG" });
    const sides = make(figure, "div", { className: "controls" });
    for (const name in VIEWS) make(sides, "button", { type: "button", textContent: name }).addEventListener("click", () => { look(name); soon(); });
    const sheet = make(figure, "canvas", { tabIndex: 0, ariaLabel: "surface" }), pen = sheet.getContext("2d");
    const tip = make(figure, "div", { className: "tip", hidden: true });
    make(figure, "small", { textContent: `${data.thinned ? "thinned out; " : ""}drag to turn, wheel to zoom, shift or right button to move, double-click to reset` });

    // Pictures of the walls and of their images: each keeps the sign of an axis or turns it.
    function copies() {
      let all = [{ sign: [1, 1, 1], shift: [0, 0, 0], mirrored: false }];
      if (!whole.checked) return all;
      for (const [axis, at] of data.mirrors) {
        const image = ({ sign, shift, mirrored }) => {
          const other = { sign: [...sign], shift: [...shift], mirrored: !mirrored };
          [other.sign[axis], other.shift[axis]] = [-sign[axis], 2 * at - shift[axis]];
          return other;
        };
        all = [...all, ...all.map(image)];
      }
      return all;
    }

    // The view: directions on the screen, the middle, and units of length per pixel.
    let width, height, sharp, view;
    function turned(azimuth, elevation) {
      const [a, b] = [azimuth, elevation].map((v) => (v * Math.PI) / 180), [c, s, d, t] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b)];
      return { azimuth, elevation, right: [-s, c, 0], up: [-t * c, -t * s, d], eye: [d * c, d * s, t] };
    }
    function bounds() {
      const [from, to] = [[...data.low], [...data.high]];
      for (const { sign, shift } of copies()) {
        for (let d = 0; d < 3; d++) {
          const [a, b] = [data.low[d], data.high[d]].map((v) => sign[d] * v + shift[d]);
          [from[d], to[d]] = [Math.min(from[d], a, b), Math.max(to[d], a, b)];
        }
      }
      return [from, to];
    }
    function look(name) {
      const [from, to] = bounds(), axes = turned(...VIEWS[name]), middle = from.map((v, d) => (v + to[d]) / 2);
      const reach = (axis) => axis.reduce((sum, v, d) => sum + Math.abs(v) * (to[d] - from[d]), 0);
      const radius = Math.hypot(...to.map((v, d) => v - from[d])) || 1;
      view = { ...axes, centre: middle, radius, unit: ROOM * Math.max(reach(axes.right) / width, reach(axes.up) / height, 1e-9 * radius), name };
    }
    const turn = (dx, dy) => {
      const elevation = Math.min(90, Math.max(-90, view.elevation + dy));
      view = { ...view, ...turned(view.azimuth - dx, elevation), name: null };
    };
    const move = (dx, dy) => { view = { ...view, centre: along(along(view.centre, -dx * view.unit, view.right), dy * view.unit, view.up), name: null }; };
    const zoom = (factor, [px, py]) => {
      const [dx, dy] = [px - LEFT - width / 2, py - TOP - height / 2];
      move(-dx, -dy);
      view.unit *= factor;
      move(dx, dy);
    };

    // What the graphics card holds.
    const canvas = document.createElement("canvas");
    let gl = canvas.getContext("webgl2", { antialias: true, premultipliedAlpha: true }), at, kept;
    function prepare() {
      const program = gl.createProgram();
      for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(shader));
        gl.attachShader(program, shader);
      }
      gl.linkProgram(program);
      gl.useProgram(program);
      const buffer = (kind, values) => {
        const own = gl.createBuffer();
        gl.bindBuffer(kind, own);
        gl.bufferData(kind, values, gl.STATIC_DRAW);
        return own;
      };
      const attribute = (name, count, type, size) => {
        const index = gl.getAttribLocation(program, name);
        gl.enableVertexAttribArray(index);
        gl.vertexAttribPointer(index, count, type, true, size, 0);
      };
      const padded = (values, kind) => {
        // the card wants corners to begin at multiples of four bytes
        const all = new kind(4 * n);
        for (let k = 0; k < 3 * n; k++) all[4 * Math.floor(k / 3) + (k % 3)] = values[k];
        return all;
      };
      buffer(gl.ARRAY_BUFFER, padded(places, Uint16Array));
      attribute("place", 3, gl.UNSIGNED_SHORT, 8);
      buffer(gl.ARRAY_BUFFER, padded(normals, Int8Array));
      attribute("normal", 3, gl.BYTE, 4);
      const values = fields.map((f) => buffer(gl.ARRAY_BUFFER, f.values));
      const triangles = buffer(gl.ELEMENT_ARRAY_BUFFER, corners);
      const textures = scales.map((colours) => {
        const own = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, own);
        gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, colours.length / 3, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, colours);
        for (const [key, value] of [[gl.TEXTURE_MIN_FILTER, gl.LINEAR], [gl.TEXTURE_MAG_FILTER, gl.LINEAR], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]]) gl.texParameteri(gl.TEXTURE_2D, key, value);
        return own;
      });
      at = (name) => gl.getUniformLocation(program, name);
      kept = { buffer, attribute, values, triangles, textures, edges: null };
      gl.enable(gl.DEPTH_TEST);
    }
    // Sides of triangles, each once.
    function edges() {
      const seen = new Set(), all = [];
      for (let t = 0; t < corners.length; t += 3) {
        for (let e = 0; e < 3; e++) {
          const [a, b] = [corners[t + e], corners[t + ((e + 1) % 3)]], key = Math.min(a, b) * n + Math.max(a, b);
          if (!seen.has(key)) all.push(a, b);
          seen.add(key);
        }
      }
      return Uint32Array.from(all);
    }

    let ends;
    const field = () => fields[choice.value];
    function measured() {
      ends = [field().from, field().to];
      [low.value, high.value] = ends.map((v) => +v.toPrecision(4));
    }
    // Ends of the scale of colours, of which the bar shows the part between the ends.
    function scale() {
      const { middle } = field(), reach = middle === null ? 0 : Math.max(Math.abs(ends[1] - middle), Math.abs(ends[0] - middle));
      return middle === null ? ends : [middle - reach, middle + reach];
    }

    function walls() {
      const shown = field(), span = shown.high - shown.low || 1, inside = (v) => (v - shown.low) / span;
      [canvas.width, canvas.height] = [Math.round(width * sharp), Math.round(height * sharp)];
      gl.viewport(0, 0, canvas.width, canvas.height);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      for (const key of ["low", "high"]) gl.uniform3fv(at(key), data[key]);
      for (const key of ["right", "up", "eye", "centre"]) gl.uniform3fv(at(key), view[key]);
      gl.uniform2f(at("half_size"), (view.unit * width) / 2, (view.unit * height) / 2);
      gl.uniform1f(at("radius"), 4 * view.radius);
      gl.uniform2fv(at("ends"), scale().map(inside));
      // lines stand at values that are round numbers
      const levels = ticks({}, ends, LINES), apart = levels.length > 1 ? (levels[1][0] - levels[0][0]) / span : 0;
      gl.uniform1f(at("spacing"), lines.checked ? apart : 0);
      gl.uniform1f(at("sonic"), lines.checked && shown.symbol === "M" ? inside(1) : -2e30);
      gl.uniform1i(at("lit"), lamp.checked);
      gl.bindTexture(gl.TEXTURE_2D, kept.textures[shown.middle === null ? 0 : 1]);
      gl.bindBuffer(gl.ARRAY_BUFFER, kept.values[choice.value]);
      kept.attribute("value", 1, gl.UNSIGNED_SHORT, 2);
      if (mesh.checked) kept.edges ??= { count: 0, ...((all) => ({ count: all.length, own: kept.buffer(gl.ELEMENT_ARRAY_BUFFER, all) }))(edges()) };
      for (const { sign, shift, mirrored } of copies()) {
        gl.uniform3fv(at("sign"), sign);
        gl.uniform3fv(at("shift"), shift);
        gl.uniform1i(at("mirrored"), mirrored);
        gl.uniform1i(at("edges"), 0);
        gl.uniform1f(at("lift"), 0);
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, kept.triangles);
        gl.drawElements(gl.TRIANGLES, corners.length, gl.UNSIGNED_INT, 0);
        if (!mesh.checked) continue;
        gl.uniform1i(at("edges"), 1);
        gl.uniform1f(at("lift"), 1e-4);
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, kept.edges.own);
        gl.drawElements(gl.LINES, kept.edges.count, gl.UNSIGNED_INT, 0);
      }
    }

    function draw() {
      if (!sheet.clientWidth || gl.isContextLost()) return;
      const style = getComputedStyle(figure), ink = style.color;
      walls();
      pen.setTransform(1, 0, 0, 1, 0, 0);
      pen.fillStyle = style.backgroundColor;
      pen.fillRect(0, 0, sheet.width, sheet.height);
      pen.drawImage(canvas, Math.round(LEFT * sharp), Math.round(TOP * sharp));
      pen.setTransform(sharp, 0, 0, sharp, 0, 0);
      frame(ink);
    }

    // Colour bar and axes.
    function frame(ink) {
      const [from, to] = scale(), colours = scales[field().middle === null ? 0 : 1], count = colours.length / 3;
      const [left, top, last] = [LEFT + width + 12, TOP + 24, height - 40], place = (v) => top + last - part(ends, v) * last;
      for (let y = 0; y < last; y++) {
        const k = Math.min(count - 1, Math.max(0, Math.round(part([from, to], mix(ends, 1 - (y + 0.5) / last)) * (count - 1))));
        pen.fillStyle = `rgb(${colours[3 * k]} ${colours[3 * k + 1]} ${colours[3 * k + 2]})`;
        pen.fillRect(left, top + y, 14, 1.5);
      }
      Object.assign(pen, { strokeStyle: ink, fillStyle: ink, lineWidth: 1, font: "12px system-ui, sans-serif", textAlign: "left" });
      pen.strokeRect(left, top, 14, last);
      for (const [v, text] of ticks({}, ends, Math.max(2, Math.min(12, last / 18)))) {
        pen.fillRect(left + 14, place(v) - 0.5, 4, 1);
        pen.fillText(text, left + 22, place(v) + 4);
      }
      pen.fillText(field().symbol, left, TOP + 12);
      const [ox, oy, long] = [LEFT + 44, TOP + height - 44, 30];
      pen.textAlign = "center";
      ["x", "y", "z"].forEach((name, d) => {
        const [dx, dy] = [view.right[d], -view.up[d]];
        if (Math.hypot(dx, dy) < 0.1) return;
        pen.beginPath();
        pen.moveTo(ox, oy);
        pen.lineTo(ox + long * dx, oy + long * dy);
        pen.stroke();
        pen.fillText(name, ox + (long + 9) * dx, oy + (long + 9) * dy + 4);
      });
    }

    let waiting = false;
    function soon() {
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(() => { waiting = false; draw(); });
    }
    function resize() {
      const wide = sheet.clientWidth;
      if (!wide) return;
      const before = width;
      [width, height] = [wide - LEFT - RIGHT, Math.round(Math.min(680, Math.max(260, 0.62 * wide)))];
      sharp = Math.min(2, window.devicePixelRatio || 1);
      sheet.style.height = `${height + TOP + BOTTOM}px`;
      [sheet.width, sheet.height] = [Math.round(wide * sharp), Math.round((height + TOP + BOTTOM) * sharp)];
      if (!view || view.name) look(view ? view.name : "iso");
      else view.unit *= before / width;
      soon();
    }

    // The wall under a place of the sheet: the nearest triangle that the line of sight meets.
    function found(px, py) {
      const start = along(along(view.centre, (px - LEFT - width / 2) * view.unit, view.right), -(py - TOP - height / 2) * view.unit, view.up);
      let best = null, nearest = -Infinity;
      for (const { sign, shift } of copies()) {
        const o = start.map((v, d) => sign[d] * (v - shift[d])), e = view.eye.map((v, d) => sign[d] * v);
        const r = view.right.map((v, d) => sign[d] * v), u = view.up.map((v, d) => sign[d] * v);
        const [a0, b0] = [dot(r, o), dot(u, o)];
        for (let t = 0; t < corners.length; t += 3) {
          const [i, j, k] = [3 * corners[t], 3 * corners[t + 1], 3 * corners[t + 2]];
          const ai = r[0] * x[i] + r[1] * x[i + 1] + r[2] * x[i + 2] - a0, bi = u[0] * x[i] + u[1] * x[i + 1] + u[2] * x[i + 2] - b0;
          const aj = r[0] * x[j] + r[1] * x[j + 1] + r[2] * x[j + 2] - a0, bj = u[0] * x[j] + u[1] * x[j + 1] + u[2] * x[j + 2] - b0;
          const ak = r[0] * x[k] + r[1] * x[k + 1] + r[2] * x[k + 2] - a0, bk = u[0] * x[k] + u[1] * x[k + 1] + u[2] * x[k + 2] - b0;
          const wi = aj * bk - ak * bj, wj = ak * bi - ai * bk, wk = ai * bj - aj * bi, sum = wi + wj + wk;
          if (sum === 0 || (wi > 0 || wj > 0 || wk > 0) === (wi < 0 || wj < 0 || wk < 0)) continue;
          const weights = [wi / sum, wj / sum, wk / sum];
          const where = [0, 1, 2].map((d) => weights[0] * x[i + d] + weights[1] * x[j + d] + weights[2] * x[k + d]);
          const depth = dot(e, where) - dot(e, o);
          if (depth > nearest) [nearest, best] = [depth, { t, weights, where: where.map((v, d) => sign[d] * v + shift[d]) }];
        }
      }
      return best;
    }
    function hover(px, py) {
      const inside = px > LEFT && py > TOP && px < LEFT + width && py < TOP + height, hit = inside ? found(px, py) : null;
      tip.hidden = !hit;
      if (!hit) return;
      const short = (v) => show(+v.toPrecision(4));
      const value = ({ values, low: from, high: to }) => mix([from, to], hit.weights.reduce((sum, w, k) => sum + w * values[corners[hit.t + k]], 0) / STEPS);
      tip.replaceChildren();
      const rows = [["x", short(hit.where[0])], ["y", short(hit.where[1])], ["z", short(hit.where[2])], ...fields.map((f) => [f.symbol, short(value(f))])];
      for (const [symbol, text] of [["body", data.bodies[body[corners[hit.t]]] || ""], ...rows]) {
        make(tip, "span", { textContent: symbol });
        make(tip, "b", { textContent: text });
      }
      const late = px > LEFT + width / 2;
      tip.style.left = late ? "" : `${sheet.offsetLeft + px + 14}px`;
      tip.style.right = late ? `${figure.clientWidth - sheet.offsetLeft - px + 14}px` : "";
      tip.style.top = `${sheet.offsetTop + Math.max(0, Math.min(py + 14, height - 110))}px`;
    }

    // The pointer, or two fingers.
    const place = (event) => {
      const box = sheet.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    const down = new Map();
    let moving = false, asked = null;
    sheet.addEventListener("pointerdown", (event) => {
      down.set(event.pointerId, place(event));
      moving = event.shiftKey || event.button > 0;
      tip.hidden = true;
      sheet.setPointerCapture(event.pointerId);
    });
    sheet.addEventListener("pointermove", (event) => {
      const here = place(event), before = down.get(event.pointerId);
      if (!before) {
        if (asked === null) requestAnimationFrame(() => { const now = asked; asked = null; if (!down.size) hover(...now); });
        asked = here;
        return;
      }
      const [dx, dy] = [here[0] - before[0], here[1] - before[1]];
      if (down.size > 1) {
        const [, other] = [...down].find(([id]) => id !== event.pointerId), apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
        zoom(apart(before) / apart(here), other);
        move(dx / 2, dy / 2);
      } else if (moving) move(dx, dy);
      else turn(0.4 * dx, 0.4 * dy);
      down.set(event.pointerId, here);
      soon();
    });
    for (const name of ["pointerup", "pointercancel"]) sheet.addEventListener(name, (event) => down.delete(event.pointerId));
    sheet.addEventListener("pointerleave", () => { tip.hidden = true; });
    sheet.addEventListener("contextmenu", (event) => event.preventDefault());
    sheet.addEventListener("dblclick", () => { look("iso"); soon(); });
    sheet.addEventListener("wheel", (event) => {
      event.preventDefault();
      zoom(Math.exp((event.deltaMode ? 0.05 : 0.0015) * event.deltaY), place(event));
      soon();
    }, { passive: false });
    sheet.addEventListener("keydown", (event) => {
      const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key], factor = { "+": 0.8, "-": 1.25 }[event.key];
      if (!by && !factor) return;
      event.preventDefault();
      if (factor) zoom(factor, [LEFT + width / 2, TOP + height / 2]);
      else if (event.shiftKey) move(20 * by[0], 20 * by[1]);
      else turn(5 * by[0], 5 * by[1]);
      soon();
    });

    choice.addEventListener("change", () => { measured(); soon(); });
    whole.addEventListener("change", () => { if (view.name) look(view.name); soon(); });
    for (const box of [lines, mesh, lamp]) box.addEventListener("change", soon);
    for (const input of [low, high]) {
      input.addEventListener("change", () => {
        const [a, b] = [low.valueAsNumber, high.valueAsNumber];
        if (b > a) ends = [a, b];
        else measured();
        soon();
      });
    }
    save.addEventListener("click", () => {
      draw();
      make(document.body, "a", { href: sheet.toDataURL("image/png"), download: "surface.png", hidden: true }).click();
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", soon);

    // Without a graphics card the pictures of the run stand in.
    function instead(reason) {
      figure.replaceChildren();
      make(figure, "p", { className: "word", textContent: `The surface does not turn here: ${reason}. The picture shows it as it is.` });
      const picture = document.querySelector('img[alt="surface views"]') || document.querySelector('img[alt="cp"]');
      if (picture) make(figure, "img", { src: picture.src, alt: "walls" });
    }
    if (!gl) return instead("this browser has no WebGL 2");
    try {
      prepare();
    } catch (error) {
      return instead(`WebGL 2 refused the drawing (${error.message})`);
    }
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => { prepare(); soon(); });
    measured();
    new ResizeObserver(resize).observe(sheet);
    resize();
  }

  document.querySelectorAll("figure.viewer.surface").forEach(viewer);
})();
