// The field of a plane run: colours between the corners of triangles, contour and stream lines, values under the pointer. Drag
// to zoom, drag with shift to move, double-click to reset; a slider goes through phases or moments.
(() => {
  "use strict";
  const { ticks, show, mix, part } = Alula;
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const floats = (text) => new Float32Array(bytes(text).buffer);
  const whole = (text) => new Uint32Array(bytes(text).buffer);
  const make = (parent, name, properties) => parent.appendChild(Object.assign(document.createElement(name), properties));
  const [LEFT, RIGHT, TOP, BOTTOM] = [64, 96, 14, 44];
  // Phases at which the range of colours of a period is looked for.
  const LOOKED_AT = 8;
  // Part of the values beyond the ends of the colours where few are far out.
  const CUT = 0.002;

  // Quantities of a particle: name, what the colour bar says, value, middle of the colours, contour lines apart.
  function quantities(free, columns) {
    const { density, pressure, speed, gamma } = free, dynamic = 0.5 * density * speed * speed;
    const total = (r, v2, p) => p * (1 + ((gamma - 1) / 2) * (v2 * r) / (gamma * p)) ** (gamma / (gamma - 1));
    const stream = total(density, speed * speed, pressure);
    const all = [
      ["Mach number", "M", ({ r, u, v, p }) => Math.sqrt(((u * u + v * v) * r) / (gamma * p))],
      ["Pressure coefficient", "Cp", ({ p }) => (p - pressure) / dynamic, 0],
      ["Total pressure loss", "1 − p₀/p₀∞", ({ r, u, v, p }) => 1 - total(r, u * u + v * v, p) / stream],
      ["Entropy", "(p/ρ^γ)/∞ − 1", ({ r, p }) => (p / r ** gamma) / (pressure / density ** gamma) - 1],
      ["Density", "ρ", ({ r }) => r],
      ["Pressure", "p", ({ p }) => p],
      ["Temperature", "T/T∞", ({ r, p }) => (p / r) / (pressure / density)],
      ["Speed", "|V|", ({ u, v }) => Math.hypot(u, v)],
      ["Velocity along x", "u", ({ u }) => u, 0],
      ["Velocity along y", "v", ({ v }) => v, 0],
    ];
    if (columns.includes("vorticity")) all.push(["Vorticity", "ω", ({ w }) => w, 0]);
    return dynamic > 0 ? all : all.filter(([name]) => name !== "Pressure coefficient");
  }

  function viewer(figure) {
    const data = JSON.parse(figure.querySelector("script").textContent), all = quantities(data.free, data.columns);
    const scales = [data.sequential, data.diverging].map(bytes);
    const frames = data.frames.map((f) => ({ ...f, terms: f.terms.map(floats), triangles: whole(f.triangles), walls: whole(f.walls) }));
    for (let k = 1; k < frames.length; k++) {
      if (!frames[k].triangles.length) Object.assign(frames[k], { triangles: frames[k - 1].triangles, walls: frames[k - 1].walls });
    }
    const harmonics = (frames[0].terms.length - 1) / 2, moving = harmonics > 0 || frames.length > 1;

    // Controls.
    const bar = make(figure, "div", { className: "controls" });
    const label = (text) => make(bar, "label", { textContent: text + " " });
    const choice = make(label("Colours"), "select", { ariaLabel: "quantity" });
    all.forEach(([name], k) => make(choice, "option", { value: k, textContent: name }));
    const low = make(label("from"), "input", { type: "number", step: "any" }), high = make(label("to"), "input", { type: "number", step: "any" });
    const tick = (text, checked) => {
      const box = document.createElement("input");
      label("").prepend(Object.assign(box, { type: "checkbox", checked }), " " + text);
      return box;
    };
    const [lines, streams, dots] = [tick("contour lines", true), tick("streamlines", false), tick("particles", false)];
    const save = make(bar, "button", { type: "button", textContent: "PNG" });
    const sheet = make(figure, "canvas", { tabIndex: 0, ariaLabel: "field" }), pen = sheet.getContext("2d");
    const tip = make(figure, "div", { className: "tip", hidden: true });
    const time = make(figure, "div", { className: "controls", hidden: !moving });
    const play = make(time, "button", { type: "button", textContent: "▶", ariaLabel: "play" });
    const slider = make(time, "input", { type: "range", min: 0, max: harmonics ? 359 : frames.length - 1, value: harmonics ? 0 : frames.length - 1, ariaLabel: harmonics ? "phase" : "moment" });
    const told = make(time, "span", {});
    make(figure, "small", { textContent: "drag to zoom, shift and drag to move, double-click to reset" });

    // The view: its middle, and units of length per pixel.
    const [x0, y0, x1, y1] = data.window, ratio = Math.min(1.2, Math.max(0.45, (y1 - y0) / (x1 - x0)));
    let width, height, home, view, sharp, zoomed = false;
    const scaleOf = (a, b, c, d) => Math.max((c - a) / width, (d - b) / height);
    const around = (a, b, c, d) => ({ x: (a + c) / 2, y: (b + d) / 2, unit: scaleOf(a, b, c, d) });
    const across = () => [view.x - (view.unit * width) / 2, view.x + (view.unit * width) / 2];
    const up = () => [view.y - (view.unit * height) / 2, view.y + (view.unit * height) / 2];
    const X = (x) => LEFT + (x - view.x) / view.unit + width / 2, Y = (y) => TOP + height / 2 - (y - view.y) / view.unit;
    const toX = (px) => view.x + (px - LEFT - width / 2) * view.unit, toY = (py) => view.y - (py - TOP - height / 2) * view.unit;

    // The numbers of all particles at the place of the slider.
    function at(place) {
      const frame = frames[harmonics ? 0 : place];
      if (!harmonics) return frame.terms[0];
      const now = Float32Array.from(frame.terms[0]);
      for (let m = 1; m <= harmonics; m++) {
        const [c, s] = [Math.cos((m * place * Math.PI) / 180), Math.sin((m * place * Math.PI) / 180)];
        const [re, im] = [frame.terms[2 * m - 1], frame.terms[2 * m]];
        for (let i = 0; i < now.length; i++) now[i] += re[i] * c - im[i] * s;
      }
      return now;
    }
    const state = (now, n, i) => ({ r: now[2 * n + i], u: now[3 * n + i], v: now[4 * n + i], p: now[5 * n + i], w: now[6 * n + i] });
    function valuesOf(now, n) {
      const value = all[choice.value][2], values = new Float32Array(n);
      for (let i = 0; i < n; i++) values[i] = value(state(now, n, i));
      return values;
    }

    // Ends of the colours over all phases and moments: extremes, but for a few particles that are far out.
    function range() {
      const places = harmonics ? [...Array(LOOKED_AT).keys()].map((k) => (360 / LOOKED_AT) * k) : frames.map((_, k) => k);
      let seen = [];
      for (const place of places) {
        const frame = frames[harmonics ? 0 : place], now = at(place), n = frame.particles, values = valuesOf(now, n);
        const inside = (i) => now[i] >= x0 && now[i] <= x1 && now[n + i] >= y0 && now[n + i] <= y1;
        for (let i = 0; i < n; i++) if (Number.isFinite(values[i]) && inside(i)) seen.push(values[i]);
      }
      seen = Float32Array.from(seen).sort();
      if (!seen.length) return [0, 1];
      const cut = Math.floor(CUT * seen.length), [a, b] = [seen[cut], seen[seen.length - 1 - cut]];
      const end = (extreme, inner) => (Math.abs(extreme - inner) <= b - a ? extreme : inner);
      const [from, to] = [end(seen[0], a), end(seen[seen.length - 1], b)];
      return to > from ? [from, to] : [from - 0.5, from + 0.5];
    }
    let ends;
    function measured() {
      ends = range();
      [low.value, high.value] = ends.map((v) => +v.toPrecision(4));
    }

    // Colours, and the triangle that covers each pixel.
    let shown, owner;
    function paint() {
      const frame = frames[harmonics ? 0 : +slider.value], now = at(+slider.value), n = frame.particles;
      const values = valuesOf(now, n), corners = frame.triangles;
      const [W, H] = [Math.round(width * sharp), Math.round(height * sharp)];
      const image = pen.createImageData(W, H), pixels = new Uint32Array(image.data.buffer).fill(0xffedeae8);
      owner = { W, H, of: new Int32Array(W * H).fill(-1) };
      const middle = all[choice.value][3], reach = Math.max(Math.abs(ends[1] - middle), Math.abs(ends[0] - middle));
      const [from, to] = middle === undefined ? ends : [middle - reach, middle + reach];
      const colours = scales[middle === undefined ? 0 : 1], count = colours.length / 3, table = new Uint32Array(count);
      for (let k = 0; k < count; k++) table[k] = 0xff000000 | (colours[3 * k + 2] << 16) | (colours[3 * k + 1] << 8) | colours[3 * k];
      const factor = (count - 1) / (to - from);
      const px = new Float32Array(n), py = new Float32Array(n);
      for (let i = 0; i < n; i++) [px[i], py[i]] = [(X(now[i]) - LEFT) * sharp - 0.5, (Y(now[n + i]) - TOP) * sharp - 0.5];
      for (let t = 0; t < corners.length; t += 3) {
        const [a, b, c] = [corners[t], corners[t + 1], corners[t + 2]];
        const [ax, ay, bx, by, cx, cy] = [px[a], py[a], px[b], py[b], px[c], py[c]];
        const top = Math.max(0, Math.ceil(Math.min(ay, by, cy))), bottom = Math.min(H - 1, Math.floor(Math.max(ay, by, cy)));
        const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
        if (top > bottom || area === 0 || Math.max(ax, bx, cx) < 0 || Math.min(ax, bx, cx) > W) continue;
        const [fa, fb, fc] = [values[a], values[b], values[c]];
        const gx = ((fb - fa) * (cy - ay) - (fc - fa) * (by - ay)) / area, gy = ((fc - fa) * (bx - ax) - (fb - fa) * (cx - ax)) / area;
        for (let y = top; y <= bottom; y++) {
          let [first, last] = [Infinity, -Infinity];
          const cross = (x1, y1, x2, y2) => {
            if (y < Math.min(y1, y2) || y > Math.max(y1, y2)) return;
            const x = y1 === y2 ? x1 : x1 + ((y - y1) * (x2 - x1)) / (y2 - y1);
            [first, last] = [Math.min(first, x), Math.max(last, x)];
            if (y1 === y2) [first, last] = [Math.min(first, x2), Math.max(last, x2)];
          };
          cross(ax, ay, bx, by);
          cross(bx, by, cx, cy);
          cross(cx, cy, ax, ay);
          for (let x = Math.max(0, Math.ceil(first)); x <= Math.min(W - 1, last); x++) {
            const k = Math.round((fa + gx * (x - ax) + gy * (y - ay) - from) * factor);
            pixels[y * W + x] = table[k < 0 ? 0 : k >= count ? count - 1 : k] || table[0];
            owner.of[y * W + x] = t;
          }
        }
      }
      shown = { now, n, values, corners, walls: frame.walls, from, to, colours };
      return image;
    }

    // Weights of the corners of the triangle at a place in pixels, `null` outside the gas.
    function found(qx, qy) {
      const [x, y] = [Math.round((qx - LEFT) * sharp - 0.5), Math.round((qy - TOP) * sharp - 0.5)];
      const t = x < 0 || y < 0 || x >= owner.W || y >= owner.H ? -1 : owner.of[y * owner.W + x];
      if (t < 0) return null;
      const { now, n, corners } = shown, [a, b, c] = [corners[t], corners[t + 1], corners[t + 2]];
      const [ax, ay] = [now[a], now[n + a]], [bx, by] = [now[b] - ax, now[n + b] - ay], [cx, cy] = [now[c] - ax, now[n + c] - ay];
      const [dx, dy] = [toX(qx) - ax, toY(qy) - ay], area = bx * cy - by * cx;
      const s = area ? Math.min(1, Math.max(0, (dx * cy - dy * cx) / area)) : 0, r = area ? Math.min(1 - s, Math.max(0, (bx * dy - by * dx) / area)) : 0;
      const value = (values, from) => values[from + a] * (1 - s - r) + values[from + b] * s + values[from + c] * r;
      return { column: (k) => value(now, k * n), value: value(shown.values, 0) };
    }

    function contours() {
      const { now, n, values, corners } = shown;
      pen.beginPath();
      for (const [level] of ticks({}, ends, 18)) {
        // the middle of a field that is zero far away is noise
        if (Math.abs(level - all[choice.value][3]) < 1e-9 * (ends[1] - ends[0])) continue;
        for (let t = 0; t < corners.length; t += 3) {
          const cut = [];
          for (let e = 0; e < 3; e++) {
            const [a, b] = [corners[t + e], corners[t + ((e + 1) % 3)]], [f, g] = [values[a] - level, values[b] - level];
            if (f < 0 !== g < 0) cut.push([X(mix([now[a], now[b]], f / (f - g))), Y(mix([now[n + a], now[n + b]], f / (f - g)))]);
          }
          if (cut.length !== 2) continue;
          pen.moveTo(...cut[0]);
          pen.lineTo(...cut[1]);
        }
      }
      Object.assign(pen, { strokeStyle: "rgb(40 44 52 / .75)", lineWidth: 0.6 });
      pen.stroke();
    }

    // Lines along the velocity. They start in the cells of a grid that hold none and end beside another one.
    function streamlines() {
      const CELL = 10, APART = 2, STEP = 2, LONGEST = 1500, columns = Math.ceil(width / CELL), rows = Math.ceil(height / CELL);
      const used = new Int32Array(columns * rows), cell = (x, y) => Math.floor((y - TOP) / CELL) * columns + Math.floor((x - LEFT) / CELL);
      const slope = (x, y) => {
        const here = found(x, y), [u, v] = here ? [here.column(3), here.column(4)] : [0, 0], size = Math.hypot(u, v);
        return size > 1e-4 * data.free.speed ? [u / size, -v / size] : null;
      };
      const walk = (x, y, sign, own) => {
        const line = [];
        for (let k = 0; k < LONGEST; k++) {
          const first = slope(x, y), half = first && slope(x + (sign * STEP * first[0]) / 2, y + (sign * STEP * first[1]) / 2);
          if (!half) break;
          [x, y] = [x + sign * STEP * half[0], y + sign * STEP * half[1]];
          const c = cell(x, y);
          if (x < LEFT || y < TOP || x > LEFT + width || y > TOP + height || (used[c] && used[c] !== own)) break;
          used[c] = own;
          line.push([x, y]);
        }
        return line;
      };
      const free = (gx, gy) => {
        for (let l = -APART; l <= APART; l++) {
          for (let k = -APART; k <= APART; k++) {
            if (gx + k >= 0 && gx + k < columns && gy + l >= 0 && gy + l < rows && used[(gy + l) * columns + gx + k]) return false;
          }
        }
        return true;
      };
      pen.beginPath();
      let own = 0;
      for (let gx = 0; gx < columns; gx++) {
        for (let gy = 0; gy < rows; gy++) {
          const [x, y] = [LEFT + (gx + 0.5) * CELL, TOP + (gy + 0.5) * CELL];
          if (!free(gx, gy) || !slope(x, y)) continue;
          used[cell(x, y)] = ++own;
          const line = [...walk(x, y, -1, own).reverse(), [x, y], ...walk(x, y, 1, own)];
          if (line.length < 16) continue;
          line.forEach(([px, py], k) => (k ? pen.lineTo(px, py) : pen.moveTo(px, py)));
          const k = line.length >> 1, [[ax, ay], [bx, by]] = [line[k - 2], line[k]], [dx, dy] = [bx - ax, by - ay];
          for (const side of [-1, 1]) {
            pen.moveTo(bx, by);
            pen.lineTo(bx - dx + side * dy * 0.6, by - dy - side * dx * 0.6);
          }
        }
      }
      Object.assign(pen, { strokeStyle: "rgb(255 255 255 / .8)", lineWidth: 1.6 });
      pen.stroke();
      Object.assign(pen, { strokeStyle: "rgb(20 24 32)", lineWidth: 0.7 });
      pen.stroke();
    }

    function draw() {
      if (!sheet.clientWidth) return;
      const style = getComputedStyle(figure), ink = style.color, image = paint();
      pen.setTransform(1, 0, 0, 1, 0, 0);
      pen.fillStyle = style.backgroundColor;
      pen.fillRect(0, 0, sheet.width, sheet.height);
      pen.putImageData(image, Math.round(LEFT * sharp), Math.round(TOP * sharp));
      pen.setTransform(sharp, 0, 0, sharp, 0, 0);
      pen.save();
      pen.beginPath();
      pen.rect(LEFT, TOP, width, height);
      pen.clip();
      if (lines.checked) contours();
      if (streams.checked) streamlines();
      const { now, n, walls } = shown;
      if (dots.checked) {
        pen.fillStyle = "rgb(20 24 32 / .8)";
        for (let i = 0; i < n; i++) pen.fillRect(X(now[i]) - 0.7, Y(now[n + i]) - 0.7, 1.4, 1.4);
      }
      pen.beginPath();
      for (let k = 0; k < walls.length; k += 2) {
        pen.moveTo(X(now[walls[k]]), Y(now[n + walls[k]]));
        pen.lineTo(X(now[walls[k + 1]]), Y(now[n + walls[k + 1]]));
      }
      Object.assign(pen, { strokeStyle: "rgb(32 36 44)", lineWidth: 1.2 });
      pen.stroke();
      pen.restore();
      frame(ink);
      told.textContent = harmonics ? `phase ${slider.value}°` : frames[+slider.value].label;
    }

    // As many labels as there is room for.
    const fitting = (room, most) => Math.max(2, Math.min(most, room));

    // Border, ticks and colour bar.
    function frame(ink) {
      Object.assign(pen, { strokeStyle: ink, fillStyle: ink, lineWidth: 1, font: "12px system-ui, sans-serif" });
      pen.strokeRect(LEFT, TOP, width, height);
      pen.textAlign = "center";
      for (const [x, text] of ticks({}, across(), fitting(width / 60, 8))) {
        pen.fillRect(X(x) - 0.5, TOP + height, 1, 4);
        pen.fillText(text, X(x), TOP + height + 17);
      }
      pen.fillText("x", LEFT + width / 2, TOP + height + 36);
      pen.textAlign = "right";
      for (const [y, text] of ticks({}, up(), fitting(height / 30, 6))) {
        pen.fillRect(LEFT - 4, Y(y) - 0.5, 4, 1);
        pen.fillText(text, LEFT - 8, Y(y) + 4);
      }
      pen.fillText("y", 14, TOP + height / 2);
      const { from, to, colours } = shown, count = colours.length / 3, x = LEFT + width + 16;
      const [first, last] = [0, height - 24], place = (v) => TOP + 24 + last - part(ends, v) * last;
      for (let y = first; y < last; y++) {
        const k = Math.min(count - 1, Math.max(0, Math.round(part([from, to], mix(ends, 1 - (y + 0.5) / last)) * (count - 1))));
        pen.fillStyle = `rgb(${colours[3 * k]} ${colours[3 * k + 1]} ${colours[3 * k + 2]})`;
        pen.fillRect(x, TOP + 24 + y, 14, 1.5);
      }
      Object.assign(pen, { fillStyle: ink, textAlign: "left" });
      pen.strokeRect(x, TOP + 24, 14, last);
      for (const [v, text] of ticks({}, ends, fitting(last / 18, 12))) {
        pen.fillRect(x + 14, place(v) - 0.5, 4, 1);
        pen.fillText(text, x + 22, place(v) + 4);
      }
      pen.fillText(all[choice.value][1], x, TOP + 12);
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
      [width, height] = [wide - LEFT - RIGHT, Math.round((wide - LEFT - RIGHT) * ratio)];
      sharp = Math.min(2, window.devicePixelRatio || 1);
      sheet.style.height = `${height + TOP + BOTTOM}px`;
      [sheet.width, sheet.height] = [Math.round(wide * sharp), Math.round((height + TOP + BOTTOM) * sharp)];
      home = around(x0, y0, x1, y1);
      if (!zoomed) view = home;
      soon();
    }

    // The pointer.
    const place = (event) => {
      const box = sheet.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    function hover(px, py) {
      const inside = px > LEFT && py > TOP && px < LEFT + width && py < TOP + height, here = inside && owner ? found(px, py) : null;
      tip.hidden = !here;
      if (!here) return;
      const one = { r: here.column(2), u: here.column(3), v: here.column(4), p: here.column(5), w: data.columns.length > 6 ? here.column(6) : 0 };
      const short = (v) => show(+v.toPrecision(4));
      const rows = all.map(([, symbol, value], k) => [symbol, short(k === +choice.value ? here.value : value(one))]);
      tip.replaceChildren();
      for (const [symbol, value] of [["x", short(toX(px))], ["y", short(toY(py))], ...rows]) {
        make(tip, "span", { textContent: symbol });
        make(tip, "b", { textContent: value });
      }
      const late = px > LEFT + width / 2;
      tip.style.left = late ? "" : `${sheet.offsetLeft + px + 14}px`;
      tip.style.right = late ? `${figure.clientWidth - sheet.offsetLeft - px + 14}px` : "";
      tip.style.top = `${sheet.offsetTop + Math.max(0, Math.min(py + 14, height - 110))}px`;
    }
    let start = null, under = null;
    sheet.addEventListener("pointerdown", (event) => {
      start = { at: place(event), view, move: event.shiftKey };
      under = pen.getImageData(0, 0, sheet.width, sheet.height);
      sheet.setPointerCapture(event.pointerId);
    });
    sheet.addEventListener("pointermove", (event) => {
      const [px, py] = place(event);
      if (!start) return hover(px, py);
      tip.hidden = true;
      if (start.move) {
        view = { ...start.view, x: start.view.x - (px - start.at[0]) * view.unit, y: start.view.y + (py - start.at[1]) * view.unit };
        zoomed = true;
        return soon();
      }
      pen.putImageData(under, 0, 0);
      pen.strokeStyle = "#1f6fd1";
      pen.strokeRect(...start.at, px - start.at[0], py - start.at[1]);
    });
    const end = (event) => {
      if (!start) return;
      const [from, to] = [start.at, place(event)];
      const moved = start.move;
      start = under = null;
      if (!moved && event.type === "pointerup" && Math.abs(from[0] - to[0]) > 8 && Math.abs(from[1] - to[1]) > 8) {
        const order = (a, b) => a - b, [a, c] = [toX(from[0]), toX(to[0])].sort(order), [b, d] = [toY(from[1]), toY(to[1])].sort(order);
        view = around(a, b, c, d);
        zoomed = true;
      }
      soon();
    };
    sheet.addEventListener("pointerup", end);
    sheet.addEventListener("pointercancel", end);
    sheet.addEventListener("pointerleave", () => { tip.hidden = true; });
    sheet.addEventListener("dblclick", () => { view = home; zoomed = false; soon(); });
    sheet.addEventListener("keydown", (event) => {
      const by = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key], factor = { "+": 0.8, "-": 1.25 }[event.key];
      if (!by && !factor) return;
      event.preventDefault();
      view = by ? { ...view, x: view.x + by[0] * width * view.unit, y: view.y + by[1] * height * view.unit } : { ...view, unit: view.unit * factor };
      zoomed = true;
      soon();
    });

    choice.addEventListener("change", () => { measured(); soon(); });
    for (const box of [lines, streams, dots]) box.addEventListener("change", soon);
    for (const input of [low, high]) {
      input.addEventListener("change", () => {
        const [a, b] = [low.valueAsNumber, high.valueAsNumber];
        if (b > a) ends = [a, b];
        else measured();
        soon();
      });
    }
    slider.addEventListener("input", soon);
    let running = null;
    play.addEventListener("click", () => {
      if (running !== null) running = clearInterval(running) ?? null;
      else running = setInterval(() => { slider.value = (+slider.value + (harmonics ? 6 : 1)) % (+slider.max + 1); soon(); }, harmonics ? 60 : 250);
      play.textContent = running === null ? "▶" : "❚❚";
    });
    save.addEventListener("click", () => {
      draw();
      make(document.body, "a", { href: sheet.toDataURL("image/png"), download: "field.png", hidden: true }).click();
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", soon);
    new ResizeObserver(resize).observe(sheet);
    measured();
    resize();
  }

  document.querySelectorAll("figure.viewer:not(.surface)").forEach(viewer);
})();
