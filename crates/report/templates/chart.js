// Charts answer to the pointer: drag to zoom, double-click to see everything, hover to read values. Their curves stand in the
// page already; zooming moves them and draws new ticks.
const Alula = (() => {
  "use strict";
  const node = (parent, name, attributes, text) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    if (text !== undefined) element.textContent = text;
    return parent.appendChild(element);
  };
  const minus = (text) => text.replace(/-/g, "\u2212");
  const show = (v) => minus(v === 0 ? "0" : Math.abs(v) >= 1e-3 && Math.abs(v) < 1e6 ? String(+v.toPrecision(6)) : v.toExponential(3));
  const mix = ([a, b], s) => a + s * (b - a);
  const part = ([a, b], v) => (v - a) / (b - a);

  // A side of the frame in data units: where it begins and ends, as numbers or as logarithms.
  const units = (side, v) => (side.log ? Math.log10(v) : v);
  const ends = (side) => [units(side, side.from), units(side, side.to)];

  function ticks(side, window, count) {
    const [a, b] = window.slice().sort((p, q) => p - q);
    if (side.log && b - a > 1) {
      const stride = Math.max(1, Math.ceil((b - a) / count)), all = [];
      for (let k = Math.ceil(a / stride) * stride; k <= b; k += stride) all.push([k, k === 0 ? "1" : minus("1e" + k)]);
      return all;
    }
    const [p, q] = side.log ? [10 ** a, 10 ** b] : [a, b];
    const power = 10 ** Math.floor(Math.log10((q - p) / count));
    const step = power * [1, 2, 5, 10].find((f) => f * power * count >= (q - p) * 0.999);
    if (!(step > 0) || Math.abs(q / step) > 1e9) return [];
    const digits = Math.min(9, Math.max(0, -Math.floor(Math.log10(step) + 1e-9))), all = [];
    for (let k = Math.ceil(p / step - 1e-9); k <= q / step + 1e-9; k++) {
      const v = k * step, large = Math.max(Math.abs(v), step);
      all.push([units(side, v), minus(k === 0 ? "0" : large >= 1e6 || large < 1e-4 ? v.toExponential(1) : v.toFixed(digits))]);
    }
    return all;
  }

  function chart(figure) {
    const svg = figure.querySelector("svg"), drawn = svg.cloneNode(true);
    const data = JSON.parse(figure.querySelector("script").textContent), { area, x: across, y: up } = data.frame;
    const home = { x: ends(across), y: ends(up) };
    let view = home, over;
    const X = (u) => area.x + part(view.x, u) * area.width, Y = (u) => area.y + (1 - part(view.y, u)) * area.height;
    // What stood at a place when everything was seen, in data units.
    const unitX = (x) => mix(home.x, (x - area.x) / area.width), unitY = (y) => mix(home.y, 1 - (y - area.y) / area.height);
    const tip = figure.appendChild(document.createElement("div"));
    tip.className = "tip";
    tip.hidden = true;
    figure.appendChild(document.createElement("small")).textContent = "drag to zoom, double-click to reset";

    function zoom(to) {
      view = to;
      svg.replaceChildren(...drawn.cloneNode(true).childNodes);
      if (view !== home) redraw();
      over = node(svg, "g", { class: "over" });
    }

    function redraw() {
      for (const path of svg.querySelectorAll(".curves path")) {
        const to = (_, x, y) => `${X(unitX(+x)).toFixed(2)} ${Y(unitY(+y)).toFixed(2)}`;
        path.setAttribute("d", path.getAttribute("d").replace(/(-?[\d.]+) (-?[\d.]+)/g, to));
      }
      for (const circle of svg.querySelectorAll(".curves circle")) {
        circle.setAttribute("cx", X(unitX(+circle.getAttribute("cx"))));
        circle.setAttribute("cy", Y(unitY(+circle.getAttribute("cy"))));
      }
      const [grid, labels] = [svg.querySelector(".grid"), svg.querySelector(".ticks")];
      const line = grid.querySelector("path"), text = labels.querySelector("text");
      if (!line || !text) return;
      grid.replaceChildren();
      labels.replaceChildren();
      const draw = (d, label, x, y, anchor) => {
        const copy = grid.appendChild(line.cloneNode());
        copy.setAttribute("d", d);
        const words = labels.appendChild(text.cloneNode());
        for (const [key, value] of Object.entries({ x, y, "text-anchor": anchor })) words.setAttribute(key, value);
        words.textContent = label;
      };
      const [right, bottom] = [area.x + area.width, area.y + area.height];
      for (const [u, label] of ticks(across, view.x, area.width > 600 ? 10 : 5)) draw(`M${X(u)} ${area.y}V${bottom}`, label, X(u), bottom + 18, "middle");
      for (const [u, label] of ticks(up, view.y, 6)) draw(`M${area.x} ${Y(u)}H${right}`, label, area.x - 8, Y(u) + 4, "end");
    }

    // The pointer in units of the sheet, inside the frame.
    const place = (event) => {
      const box = svg.getBoundingClientRect(), scale = svg.viewBox.baseVal.width / box.width;
      const clamp = (v, from, length) => Math.min(from + length, Math.max(from, v));
      return [clamp((event.clientX - box.left) * scale, area.x, area.width), clamp((event.clientY - box.top) * scale, area.y, area.height)];
    };

    function nearest(px, py) {
      let best = null, least = 900;
      data.series.forEach((s, k) => {
        const bars = s.marks === "bars", known = (v, side) => v !== null && (!side.log || v > 0);
        // Along a function the horizontal distance counts; among dots and along loops the distance.
        const weight = bars || (s.marks === "line" && s.x.every((v, i) => i === 0 || v >= s.x[i - 1])) ? 0.02 : 1;
        for (let i = 0; i < Math.min(s.x.length - bars, s.y.length); i++) {
          if (s.marks === "points" && s.x[i] === null) break;
          if (!known(s.x[i], across) || !known(s.y[i], up)) continue;
          const at = bars ? (s.x[i] + s.x[i + 1]) / 2 : s.x[i];
          const x = X(units(across, at)), y = Y(units(up, s.y[i])), d = (x - px) ** 2 + weight * (y - py) ** 2;
          if (d < least) [least, best] = [d, { s, k, x, y, at: bars ? `${show(s.x[i])} to ${show(s.x[i + 1])}` : `${data.x.label} ${show(s.x[i])}`, value: s.y[i] }];
        }
      });
      return best;
    }

    function hover(px, py) {
      over.replaceChildren();
      const hit = nearest(px, py);
      tip.hidden = !hit;
      if (!hit) return;
      const mark = svg.querySelector(".curves").children[hit.k], stroke = mark.getAttribute("stroke") || mark.getAttribute("fill");
      node(over, "path", { d: `M${hit.x} ${area.y}v${area.height}`, stroke: "#6e7580", "stroke-dasharray": "3 3" });
      node(over, "circle", { cx: hit.x, cy: hit.y, r: 5, fill: "none", stroke, "stroke-width": 2 });
      tip.textContent = `${hit.at}   ${hit.s.name || data.y.label} ${show(hit.value)}`;
      const box = svg.getBoundingClientRect(), frame = figure.getBoundingClientRect(), scale = box.width / svg.viewBox.baseVal.width;
      const left = box.left - frame.left + figure.scrollLeft + hit.x * scale, late = hit.x > area.x + area.width / 2;
      tip.style.left = late ? "" : `${left + 12}px`;
      tip.style.right = late ? `${frame.width - left + 12}px` : "";
      tip.style.top = `${Math.max(0, box.top - frame.top + hit.y * scale - 36)}px`;
    }

    let start = null;
    svg.addEventListener("pointerdown", (event) => { start = place(event); svg.setPointerCapture(event.pointerId); });
    svg.addEventListener("pointermove", (event) => {
      const [px, py] = place(event);
      if (!start) return hover(px, py);
      tip.hidden = true;
      over.replaceChildren();
      node(over, "path", { d: `M${start}H${px}V${py}H${start[0]}Z`, fill: "#1f6fd1", opacity: 0.12 });
    });
    svg.addEventListener("pointerup", (event) => {
      const [from, to] = [start, place(event)];
      start = null;
      over.replaceChildren();
      if (!from || Math.abs(from[0] - to[0]) < 8 || Math.abs(from[1] - to[1]) < 8) return;
      const order = (a, b) => a - b;
      const xs = [from[0], to[0]].sort(order).map((p) => mix(view.x, (p - area.x) / area.width));
      const ys = [from[1], to[1]].sort(order).reverse().map((p) => mix(view.y, 1 - (p - area.y) / area.height));
      zoom({ x: xs, y: ys });
    });
    svg.addEventListener("pointerleave", () => { if (!start) { over.replaceChildren(); tip.hidden = true; } });
    svg.addEventListener("pointercancel", () => { start = null; over.replaceChildren(); });
    svg.addEventListener("dblclick", () => zoom(home));
    zoom(home);
  }

  document.querySelectorAll("figure.chart").forEach(chart);
  return { ticks, show, mix, part };
})();
