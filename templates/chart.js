// Small interactive charts: drag to zoom, double-click to see everything, hover to read values.
(() => {
  "use strict";
  const SVG = "http://www.w3.org/2000/svg";
  const node = (parent, name, attributes, text) => {
    const element = document.createElementNS(SVG, name);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    if (text !== undefined) element.textContent = text;
    parent.appendChild(element);
    return element;
  };
  const minus = (text) => text.replace(/-/g, "\u2212");
  const show = (v) => minus(v === 0 ? "0" : Math.abs(v) >= 1e-3 && Math.abs(v) < 1e6 ? String(+v.toPrecision(6)) : v.toExponential(3));

  // A side of the plot: window [a, b] in (logarithms of) data units.
  const forward = (axis, v) => (axis.log ? Math.log10(v) : v);
  const backward = (axis, u) => (axis.log ? 10 ** u : u);
  const usable = (axis, v) => v !== null && Number.isFinite(v) && (!axis.log || v > 0);

  function ticks(axis, [a, b], count) {
    if (axis.log && b - a > 1) {
      const stride = Math.max(1, Math.ceil((b - a) / count));
      const all = [];
      for (let k = Math.ceil(a / stride) * stride; k <= b; k += stride) all.push([k, k === 0 ? "1" : minus("1e" + k)]);
      return all;
    }
    const [p, q] = [backward(axis, a), backward(axis, b)];
    const rough = (q - p) / count;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find((f) => f * power >= rough * 0.999);
    if (!(step > 0) || !Number.isFinite(step) || Math.abs(q / step) > 1e9) return [];
    const digits = Math.min(9, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
    const all = [];
    for (let k = Math.ceil(p / step - 1e-9); k * step <= q * (1 + Math.sign(q) * 1e-9); k++) {
      const v = k * step;
      const large = Math.max(Math.abs(v), step);
      all.push([forward(axis, v), minus(k === 0 ? "0" : large >= 1e6 || large < 1e-4 ? v.toExponential(1) : v.toFixed(digits))]);
    }
    return all;
  }

  function extent(axis, values, zero) {
    let a = Infinity, b = -Infinity;
    for (const v of values) if (usable(axis, v)) { const u = forward(axis, v); a = Math.min(a, u); b = Math.max(b, u); }
    if (zero) { a = Math.min(a, 0); b = Math.max(b, 0); }
    if (a > b) [a, b] = [0, 1];
    const room = b > a ? 0.05 * (b - a) : 0.1 * Math.max(Math.abs(a), 0.1);
    return [zero && a === 0 ? 0 : a - room, b + room];
  }

  function chart(plot, data) {
    const W = plot.closest(".charts") ? 480 : 960, H = plot.closest(".charts") ? 280 : 400;
    const area = { x: 70, y: 8, w: W - 86, h: H - 54 };
    const bars = data.series.some((s) => s.marks === "bars");
    const all = (key) => data.series.flatMap((s) => s[key]);
    const home = { x: extent(data.x, all("x"), false), y: extent(data.y, all("y"), bars) };
    let view = { x: home.x.slice(), y: home.y.slice() };
    const colour = (k) => `var(--c${k % 6})`;

    const head = document.createElement("header");
    const title = document.createElement("b");
    title.textContent = data.title;
    head.appendChild(title);
    data.series.forEach((s, k) => {
      if (!s.name || (data.series.length < 2 && s.name === data.y.label)) return;
      const entry = document.createElement("span"), dot = document.createElement("i");
      dot.style.background = dot.style.borderColor = colour(k);
      if (s.marks === "rings") dot.className = "ring";
      entry.append(dot, s.name);
      head.appendChild(entry);
    });
    const hint = document.createElement("small");
    hint.textContent = "drag to zoom, double-click to reset";
    head.appendChild(hint);
    plot.appendChild(head);
    const svg = node(plot, "svg", { viewBox: `0 0 ${W} ${H}`, role: "img", "aria-label": data.title });
    const tip = document.createElement("div");
    tip.className = "tip";
    tip.hidden = true;
    plot.appendChild(tip);

    const X = (v) => area.x + (forward(data.x, v) - view.x[0]) / (view.x[1] - view.x[0]) * area.w;
    const Y = (v) => {
      const s = (forward(data.y, v) - view.y[0]) / (view.y[1] - view.y[0]);
      return area.y + (data.y.reversed ? s : 1 - s) * area.h;
    };
    const good = (s, i) => usable(data.x, s.x[i]) && usable(data.y, s.y[i]);
    let over;

    function series(parent, s, k) {
      const n = Math.min(s.x.length, s.y.length);
      if (s.marks === "line") {
        let path = "", pen = "M";
        for (let i = 0; i < n; i++) {
          if (!good(s, i)) { pen = "M"; continue; }
          path += `${pen}${X(s.x[i]).toFixed(2)} ${Y(s.y[i]).toFixed(2)}`;
          pen = "L";
        }
        node(parent, "path", { d: path, fill: "none", stroke: colour(k), "stroke-width": 1.8, "stroke-linejoin": "round" });
      } else if (s.marks === "bars") {
        for (let i = 0; i + 1 < s.x.length && i < s.y.length; i++) {
          if (!good(s, i) || !usable(data.x, s.x[i + 1])) continue;
          const [x0, x1, y0, y1] = [X(s.x[i]), X(s.x[i + 1]), Y(0), Y(s.y[i])];
          node(parent, "rect", { x: x0 + 0.5, width: Math.max(0.5, x1 - x0 - 1), y: Math.min(y0, y1), height: Math.abs(y0 - y1), fill: colour(k), opacity: 0.85 });
        }
      } else {
        const ring = s.marks === "rings";
        const style = ring ? { fill: "none", stroke: colour(k), "stroke-width": 1.5 } : { fill: colour(k) };
        const group = node(parent, "g", style);
        for (let i = 0; i < n; i++) if (good(s, i)) node(group, "circle", { cx: X(s.x[i]).toFixed(2), cy: Y(s.y[i]).toFixed(2), r: ring ? 3.6 : 2.3 });
      }
    }

    function draw() {
      svg.replaceChildren();
      const id = "area" + Math.random().toString(36).slice(2);
      node(node(svg, "clipPath", { id }), "rect", { x: area.x, y: area.y, width: area.w, height: area.h });
      for (const [u, label] of ticks(data.x, view.x, W > 600 ? 9 : 6)) {
        const x = X(backward(data.x, u));
        node(svg, "line", { class: "grid", x1: x, x2: x, y1: area.y, y2: area.y + area.h });
        node(svg, "text", { x, y: area.y + area.h + 17, "text-anchor": "middle" }, label);
      }
      for (const [u, label] of ticks(data.y, view.y, 6)) {
        const y = Y(backward(data.y, u));
        node(svg, "line", { class: "grid", x1: area.x, x2: area.x + area.w, y1: y, y2: y });
        node(svg, "text", { x: area.x - 8, y: y + 4, "text-anchor": "end" }, label);
      }
      const marks = node(svg, "g", { "clip-path": `url(#${id})` });
      data.series.forEach((s, k) => series(marks, s, k));
      node(svg, "rect", { class: "axis", x: area.x, y: area.y, width: area.w, height: area.h });
      node(svg, "text", { x: area.x + area.w / 2, y: H - 6, "text-anchor": "middle" }, data.x.label);
      const middle = area.y + area.h / 2;
      node(svg, "text", { x: 14, y: middle, "text-anchor": "middle", transform: `rotate(-90 14 ${middle})` }, data.y.label);
      over = node(svg, "g", {});
    }

    const place = (event) => {
      const box = svg.getBoundingClientRect();
      const clamp = (v, a, b) => Math.min(b, Math.max(a, v));
      return [
        clamp((event.clientX - box.left) * W / box.width, area.x, area.x + area.w),
        clamp((event.clientY - box.top) * H / box.height, area.y, area.y + area.h),
      ];
    };

    function nearest(px, py) {
      let best = null, least = 900;
      data.series.forEach((s, k) => {
        const bar = s.marks === "bars";
        for (let i = 0; i < Math.min(s.x.length, s.y.length); i++) {
          if (!good(s, i) || (bar && i + 1 >= s.x.length)) continue;
          const x = bar ? (X(s.x[i]) + X(s.x[i + 1])) / 2 : X(s.x[i]), y = Y(s.y[i]);
          // Along a curve the horizontal distance counts; among dots the distance.
          const d = (x - px) ** 2 + (bar || s.marks === "line" ? 0.02 : 1) * (y - py) ** 2;
          if (d < least) { least = d; best = { s, k, i, x, y, bar }; }
        }
      });
      return best;
    }

    function hover(px, py) {
      over.replaceChildren();
      const hit = nearest(px, py);
      tip.hidden = !hit;
      if (!hit) return;
      node(over, "line", { class: "hair", x1: hit.x, x2: hit.x, y1: area.y, y2: area.y + area.h });
      node(over, "circle", { cx: hit.x, cy: hit.y, r: 5, fill: "none", stroke: colour(hit.k), "stroke-width": 2 });
      const at = hit.bar ? `${show(hit.s.x[hit.i])} to ${show(hit.s.x[hit.i + 1])}` : `${data.x.label} ${show(hit.s.x[hit.i])}`;
      tip.textContent = `${at}   ${hit.s.name || data.y.label} ${show(hit.s.y[hit.i])}`;
      const box = svg.getBoundingClientRect(), frame = plot.getBoundingClientRect(), scale = box.width / W;
      const left = box.left - frame.left + hit.x * scale;
      tip.style.left = hit.x > W / 2 ? "" : `${left + 12}px`;
      tip.style.right = hit.x > W / 2 ? `${frame.width - left + 12}px` : "";
      tip.style.top = `${Math.max(0, box.top - frame.top + hit.y * scale - 36)}px`;
    }

    let start = null;
    svg.addEventListener("pointerdown", (event) => { start = place(event); svg.setPointerCapture(event.pointerId); });
    svg.addEventListener("pointermove", (event) => {
      const [px, py] = place(event);
      if (!start) return hover(px, py);
      tip.hidden = true;
      over.replaceChildren();
      node(over, "rect", { class: "drag", x: Math.min(px, start[0]), y: Math.min(py, start[1]), width: Math.abs(px - start[0]), height: Math.abs(py - start[1]) });
    });
    svg.addEventListener("pointerup", (event) => {
      const [from, to] = [start, place(event)];
      start = null;
      over.replaceChildren();
      if (!from || Math.abs(from[0] - to[0]) < 8 || Math.abs(from[1] - to[1]) < 8) return;
      const pick = (window, s) => window[0] + s * (window[1] - window[0]);
      const xs = [from[0], to[0]].map((p) => (p - area.x) / area.w).sort((a, b) => a - b);
      const ys = [from[1], to[1]].map((p) => (p - area.y) / area.h).map((s) => (data.y.reversed ? s : 1 - s)).sort((a, b) => a - b);
      view = { x: xs.map((s) => pick(view.x, s)), y: ys.map((s) => pick(view.y, s)) };
      draw();
    });
    svg.addEventListener("pointerleave", () => { if (!start) { over.replaceChildren(); tip.hidden = true; } });
    svg.addEventListener("pointercancel", () => { start = null; over.replaceChildren(); });
    svg.addEventListener("dblclick", () => { view = { x: home.x.slice(), y: home.y.slice() }; draw(); });
    draw();
  }

  for (const figure of document.querySelectorAll("figure.chart")) {
    chart(figure.querySelector(".plot"), JSON.parse(figure.querySelector("script").textContent));
  }
})();
