// A surface that moves in modes: outlines in the plane, shaded triangles in space, which turn with the pointer. The displacement of a
// point is the sum over coordinates of their amplitudes times what the coordinate does to it, Re(d e^{iφ}).
(() => {
  "use strict";
  const make = (parent, name, properties) => parent.appendChild(Object.assign(document.createElement(name), properties));
  // Largest displacement that is drawn, over the chord.
  const SHOWN = 0.1;
  // Seconds of a period.
  const SECONDS = 2.4;
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

  function viewer(figure) {
    const data = JSON.parse(figure.querySelector("script").textContent);
    const { points, lines, triangles, moves, motions, chord } = data, n = points.length / 3, space = triangles.length > 0;
    if (!motions.length || !n) return;
    const bar = make(figure, "div", { className: "controls" });
    const choice = make(make(bar, "label", { textContent: "Motion " }), "select", { ariaLabel: "motion" });
    motions.forEach((m, k) => make(choice, "option", { value: k, textContent: m.name }));
    const still = make(bar, "label", {}), rest = make(still, "input", { type: "checkbox", checked: !space });
    still.append(" at rest as well");
    const sheet = make(figure, "canvas", { tabIndex: 0, ariaLabel: "surface in motion" }), pen = sheet.getContext("2d");
    const time = make(figure, "div", { className: "controls" });
    const play = make(time, "button", { type: "button", ariaLabel: "play" });
    const slider = make(time, "input", { type: "range", min: 0, max: 360, step: "any", value: 0, ariaLabel: "phase" });
    const told = make(time, "span", {});
    const caption = make(figure, "figcaption", {});
    if (space) {
      figure.classList.add("space");
      make(figure, "small", { textContent: "drag to turn, double-click to reset" });
    }

    // Real and imaginary part of the displacement, so large that the largest over a period is that shown.
    const re = new Float64Array(3 * n), im = new Float64Array(3 * n);
    function choose() {
      const motion = motions[choice.value];
      re.fill(0);
      im.fill(0);
      moves.forEach((own, k) => {
        for (let i = 0; i < 3 * n; i++) {
          re[i] += motion.re[k] * own[i];
          im[i] += motion.im[k] * own[i];
        }
      });
      let largest = 0;
      for (let i = 0; i < n; i++) {
        const a = [0, 1, 2].map((d) => re[3 * i + d]), b = [0, 1, 2].map((d) => im[3 * i + d]);
        const [aa, bb, ab] = [dot(a, a), dot(b, b), dot(a, b)];
        largest = Math.max(largest, (aa + bb) / 2 + Math.hypot((aa - bb) / 2, ab));
      }
      const scale = largest > 0 ? (SHOWN * chord) / Math.sqrt(largest) : 0;
      for (let i = 0; i < 3 * n; i++) {
        re[i] *= scale;
        im[i] *= scale;
      }
      const steady = motion.frequency === "0" || im.every((v) => v === 0) ? "" : ", parts of it out of phase";
      caption.textContent = `${motion.name}: frequency ${motion.frequency}${steady}. The largest displacement is drawn as ${100 * SHOWN} % of the chord${space ? "; colours tell how far points are from rest" : ""}.`;
    }

    // Bounds at rest with room for the motion.
    const low = [0, 1, 2].map((d) => Infinity), high = low.map((v) => -v);
    for (let i = 0; i < 3 * n; i++) {
      low[i % 3] = Math.min(low[i % 3], points[i]);
      high[i % 3] = Math.max(high[i % 3], points[i]);
    }
    const middle = low.map((v, d) => (v + high[d]) / 2), room = 1.3 * SHOWN * chord;
    const corners = [...Array(8).keys()].map((k) => [0, 1, 2].map((d) => ((k >> d) & 1 ? high[d] - middle[d] + room : low[d] - middle[d] - room)));
    let turned, view;
    const home = () => { turned = space ? [235, 24] : [270, 90]; };
    function look() {
      const [s, c] = [Math.sin((turned[0] * Math.PI) / 180), Math.cos((turned[0] * Math.PI) / 180)];
      const [t, h] = [Math.sin((turned[1] * Math.PI) / 180), Math.cos((turned[1] * Math.PI) / 180)];
      view = { eye: [h * c, h * s, t], right: [-s, c, 0], up: [-t * c, -t * s, h] };
    }
    home();
    look();

    let width, height, sharp, unit;
    function fit() {
      const reach = (axis) => Math.max(...corners.map((p) => Math.abs(dot(axis, p))));
      const wide = figure.clientWidth - 32, across = 2 * reach(view.right), up = 2 * reach(view.up);
      if (!(wide > 0)) return;
      width = wide;
      height ??= Math.min(560, Math.max(180, (wide * up) / across));
      unit = Math.max(across / width, up / height);
      sharp = Math.min(2, window.devicePixelRatio || 1);
      sheet.style.height = `${height}px`;
      [sheet.width, sheet.height] = [Math.round(width * sharp), Math.round(height * sharp)];
    }

    const x = new Float64Array(n), y = new Float64Array(n), z = new Float64Array(n), far = new Float64Array(n);
    function place(c, s) {
      const { right, up, eye } = view;
      for (let i = 0; i < n; i++) {
        const moved = [0, 1, 2].map((d) => c * re[3 * i + d] - s * im[3 * i + d]);
        const p = [0, 1, 2].map((d) => points[3 * i + d] + moved[d] - middle[d]);
        [x[i], y[i], z[i]] = [width / 2 + dot(right, p) / unit, height / 2 - dot(up, p) / unit, dot(eye, p)];
        far[i] = Math.sqrt(dot(moved, moved)) / (SHOWN * chord);
      }
    }
    function outline(fill, stroke) {
      pen.beginPath();
      let last = -1;
      for (let k = 0; k < lines.length; k += 2) {
        if (lines[k] !== last) pen.moveTo(x[lines[k]], y[lines[k]]);
        pen.lineTo(x[lines[k + 1]], y[lines[k + 1]]);
        last = lines[k + 1];
      }
      Object.assign(pen, { fillStyle: fill, strokeStyle: stroke, lineWidth: 1.6, lineJoin: "round" });
      if (fill) pen.fill();
      pen.stroke();
    }
    // Triangles that face the eye, far ones first; colours tell how far they are from rest.
    function shell(dark) {
      const order = [];
      for (let t = 0; t < triangles.length; t += 3) {
        const [a, b, c] = [triangles[t], triangles[t + 1], triangles[t + 2]];
        const area = (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a]);
        if (area < 0) order.push([z[a] + z[b] + z[c], a, b, c, -area]);
      }
      order.sort((p, q) => p[0] - q[0]);
      for (const [, a, b, c, area] of order) {
        const [ux, uy, uz] = [x[b] - x[a], y[b] - y[a], (z[b] - z[a]) / unit], [vx, vy, vz] = [x[c] - x[a], y[c] - y[a], (z[c] - z[a]) / unit];
        const size = Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, area) || 1, light = 0.35 + (0.65 * area) / size;
        const part = Math.min(1, (far[a] + far[b] + far[c]) / 3);
        const colour = `hsl(${214 - 190 * part} ${18 + 55 * part}% ${Math.round((dark ? 62 : 78) * light)}%)`;
        pen.beginPath();
        pen.moveTo(x[a], y[a]);
        pen.lineTo(x[b], y[b]);
        pen.lineTo(x[c], y[c]);
        pen.closePath();
        Object.assign(pen, { fillStyle: colour, strokeStyle: colour, lineWidth: 0.7 });
        pen.fill();
        pen.stroke();
      }
    }
    function ghost(ink) {
      pen.beginPath();
      for (let t = 0; t < triangles.length; t += 3) {
        pen.moveTo(x[triangles[t]], y[triangles[t]]);
        for (const k of [1, 2, 0]) pen.lineTo(x[triangles[t + k]], y[triangles[t + k]]);
      }
      Object.assign(pen, { strokeStyle: ink, lineWidth: 0.3 });
      pen.stroke();
    }
    function draw() {
      if (!width) return;
      const style = getComputedStyle(figure), soft = getComputedStyle(caption).color, phase = +slider.value;
      const dark = matchMedia("(prefers-color-scheme: dark)").matches, accent = style.getPropertyValue("--accent") || "#1f6fd1";
      pen.setTransform(sharp, 0, 0, sharp, 0, 0);
      pen.clearRect(0, 0, width, height);
      if (rest.checked) {
        place(0, 0);
        if (space) ghost(soft);
        else outline("", soft);
      }
      place(Math.cos((phase * Math.PI) / 180), Math.sin((phase * Math.PI) / 180));
      if (space) shell(dark);
      else {
        pen.globalAlpha = 0.18;
        outline(accent, "transparent");
        pen.globalAlpha = 1;
        outline("", accent);
      }
      told.textContent = `phase ${Math.round(phase)}°`;
    }

    let running = !matchMedia("(prefers-reduced-motion: reduce)").matches, before = null, seen = true;
    function step(now) {
      if (!running || !seen) { before = null; return; }
      if (before !== null) slider.value = (+slider.value + (360 * (now - before)) / (1000 * SECONDS)) % 360;
      before = now;
      draw();
      requestAnimationFrame(step);
    }
    function go(on) {
      running = on;
      play.textContent = on ? "❚❚" : "▶";
      if (on) requestAnimationFrame(step);
      else draw();
    }
    play.addEventListener("click", () => go(!running));
    slider.addEventListener("input", () => go(false));
    choice.addEventListener("change", () => { choose(); draw(); });
    rest.addEventListener("change", draw);
    if (space) {
      let down = null;
      sheet.addEventListener("pointerdown", (event) => { down = [event.clientX, event.clientY]; sheet.setPointerCapture(event.pointerId); });
      sheet.addEventListener("pointermove", (event) => {
        if (!down) return;
        turned = [turned[0] - 0.4 * (event.clientX - down[0]), Math.max(-90, Math.min(90, turned[1] + 0.4 * (event.clientY - down[1])))];
        down = [event.clientX, event.clientY];
        look();
        draw();
      });
      for (const name of ["pointerup", "pointercancel"]) sheet.addEventListener(name, () => { down = null; });
      sheet.addEventListener("dblclick", () => { home(); look(); fit(); draw(); });
    }
    // what is out of sight stands still
    new IntersectionObserver(([entry]) => { const was = seen; seen = entry.isIntersecting; if (seen && !was && running) requestAnimationFrame(step); }).observe(sheet);
    new ResizeObserver(() => { fit(); draw(); }).observe(figure);
    choose();
    fit();
    go(running);
  }

  document.querySelectorAll("figure.viewer.modes").forEach(viewer);
})();
