// A map: lines whose axes may share a unit, with zoom, pan and a reading of the nearest point.
"use strict";
// Where a mover is at a time; nothing before it starts, and its last place when it has ended.
function NtgAt(line, t) {
  const n = line.t.length;
  if (!n || t < line.t[0]) return null;
  let low = 0, high = n - 1;
  while (high - low > 1) { const middle = (low + high) >> 1; if (line.t[middle] <= t) low = middle; else high = middle; }
  const span = line.t[high] - line.t[low], share = span > 0 ? Math.min(Math.max((t - line.t[low]) / span, 0), 1) : 1;
  const of = (values) => values && values[low] + share * (values[high] - values[low]);
  const at = { x: of(line.x), y: of(line.y), z: of(line.z) };
  return isFinite(at.x) && isFinite(at.y) ? at : null;
}
function NtgMap(place, chart, { colour, dash, number, told, cut }) {
  const NS = "http://www.w3.org/2000/svg";
  const make = (name, attributes, parent) => {
    const element = document.createElementNS(NS, name);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    return parent.appendChild(element);
  };
  const time = document.getElementById("clock").dataset;
  const svg = make("svg", { class: "map", role: "img" }, place);
  const tip = place.appendChild(document.createElement("div"));
  tip.className = "maptip";
  const legend = place.appendChild(document.createElement("div"));
  legend.className = "maplegend";
  const margin = { left: 62, right: 14, top: 10, bottom: 44 };
  const all = chart.lines.flatMap((line) => line.x.map((x, i) => [x, line.y[i]])).filter(([x, y]) => x != null && y != null);
  // What is passed belongs to the picture as far as it is no further away than the tracks are long.
  const spans = [0, 1].map((k) => { const v = all.map((p) => p[k]); return [Math.min(...v), Math.max(...v)]; });
  const near = ([x, y]) => [x, y].every((v, k) => { const [low, high] = spans[k], room = chart.equal ? Math.max(...spans.map(([a, b]) => b - a)) / 2 : high - low; return v >= low - room && v <= high + room; });
  for (const [kind, , xs, ys] of chart.shapes) if (kind === "place" || kind === "area" || kind === "ground") xs.forEach((x, i) => { const p = [x, ys[i]], beside = kind === "ground" && (x < spans[0][0] || x > spans[0][1]); if (x != null && p[1] != null && near(p) && !beside) all.push(p); });
  const home = () => {
    const xs = all.map((p) => p[0]), ys = all.map((p) => p[1]);
    const grow = (low, high) => { const pad = 0.06 * (high - low) || Math.max(1e-3, 0.1 * Math.abs(low)); return [low - pad, high + pad]; };
    const flat = (low, high) => { const lack = Math.max(0, chart.least - (high - low)) / 2; return [low - lack, high + lack]; };
    return { x: grow(Math.min(...xs), Math.max(...xs)), y: grow(...flat(Math.min(...ys), Math.max(...ys))) };
  };
  let view = home(), width = 0, height = 0, movers = [], now = null;

  // Widens the shorter axis until a unit is as long on both.
  const fitted = () => {
    const w = width - margin.left - margin.right, h = height - margin.top - margin.bottom;
    let { x: [x0, x1], y: [y0, y1] } = view;
    if (chart.equal) {
      const scale = Math.max((x1 - x0) / w, (y1 - y0) / h);
      const cx = (x0 + x1) / 2, cy = (y0 + y1) / 2;
      [x0, x1, y0, y1] = [cx - scale * w / 2, cx + scale * w / 2, cy - scale * h / 2, cy + scale * h / 2];
    }
    return {
      x0, x1, y0, y1, w, h,
      px: (x) => margin.left + (x - x0) / (x1 - x0) * w, py: (y) => margin.top + (y1 - y) / (y1 - y0) * h,
      ux: (p) => x0 + (p - margin.left) / w * (x1 - x0), uy: (p) => y1 - (p - margin.top) / h * (y1 - y0),
    };
  };
  const ticks = (low, high, count) => {
    const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
    const step = power * ([1, 2, 5, 10].find((m) => m * power >= raw) || 10);
    const found = [];
    for (let v = Math.ceil(low / step) * step; v <= high; v += step) found.push(Math.abs(v) < step * 1e-9 ? 0 : v);
    return found;
  };
  let taken = [];
  // A name beside a point, moved as far as it takes to lie within the frame.
  const named = (f, kind, name, [x, y, anchor], parent, tone) => {
    const text = make("text", { class: `${kind}name`, y: Math.min(Math.max(y, margin.top + 12), margin.top + f.h - 4) }, parent);
    text.textContent = name;
    if (tone) text.style.fill = tone;
    const size = text.getComputedTextLength(), share = { start: 0, middle: 0.5, end: 1 }[anchor];
    const left = Math.max(Math.min(x - share * size, margin.left + f.w - 4 - size), margin.left + 4), base = +text.getAttribute("y");
    text.setAttribute("x", left);
    // A place's name that would lie over another one is left out; the pointer tells it.
    const own = [left, base - 11, left + size, base + 3];
    if (kind === "place" && taken.some((other) => own[0] < other[2] && other[0] < own[2] && own[1] < other[3] && other[1] < own[3])) text.remove();
    else taken.push(own);
  };
  // A shape in the colour of its line; only areas are filled.
  const painted = (shape, tone, filled) => {
    if (tone) { shape.style.stroke = tone; shape.style.fill = filled ? tone : "none"; }
    return shape;
  };
  // Beneath the tracks: areas and borders that limit them, lines of equal height, the ground, and places.
  const beneath = (f, inside, names) => {
    for (const [kind, name, x, y, of] of chart.shapes) {
      // What belongs to one line alone has its colour.
      const tone = of == null ? undefined : colour(of);
      if (kind === "place") {
        const [px, py] = [f.px(x[0]), f.py(y[0])];
        const mark = painted(make("path", { class: "place", d: `M${px} ${py - 5}l4.5 8h-9z` }, inside), tone);
        make("title", {}, mark).textContent = name;
        // Before its mark where the picture ends too soon.
        const ends = px + 10 + 6.5 * name.length > margin.left + f.w;
        const within = px > margin.left && px < margin.left + f.w && py > margin.top && py < margin.top + f.h;
        if (within) named(f, kind, name, [px + (ends ? -7 : 7), py + 4, ends ? "end" : "start"], names, tone);
        continue;
      }
      let d = path({ x, y }, f);
      if (kind === "ground" && of == null) d += `V${margin.top + f.h}H${f.px(x[0])}Z`;
      const shape = painted(make("path", { class: kind, d }, inside), tone, kind === "area");
      make("title", {}, shape).textContent = name;
      if (!name || kind === "ground") continue;
      // In the middle of an area; of other lines, at a point that is in the picture.
      const seen = x.map((v, i) => [f.px(v), f.py(y[i])]).filter(([px, py]) => px > margin.left + 20 && px < margin.left + f.w - 60 && py > margin.top + 14 && py < margin.top + f.h - 6);
      if (!seen.length || (kind === "contour" && seen.length < 6)) continue;
      const middle = (k) => seen.reduce((sum, p) => sum + p[k], 0) / seen.length;
      // An area's name is above its middle, where a place may have its own.
      const top = seen.reduce((a, b) => (b[1] < a[1] ? b : a));
      // Areas of several lines may have one middle, and have their tops apart.
      const [px, py] = kind !== "area" ? seen[Math.floor(seen.length / 3)] : of == null ? [middle(0), middle(1) - 14] : [top[0], top[1] + 15];
      named(f, kind, name, [px, py, kind === "area" ? "middle" : "start"], names, tone);
    }
  };
  const path = (line, f) => {
    let text = "", pen = false;
    line.x.forEach((x, i) => {
      const y = line.y[i];
      if (x == null || y == null) { pen = false; return; }
      text += `${pen ? "L" : "M"}${f.px(x).toFixed(2)} ${f.py(y).toFixed(2)}`;
      pen = true;
    });
    return text;
  };

  function redraw() {
    width = Math.max(place.clientWidth - 14, 240);
    // As tall as what is shown is beside its width.
    const first = home(), tall = chart.equal ? (first.y[1] - first.y[0]) / (first.x[1] - first.x[0]) : 0.36;
    height = Math.round(Math.min(Math.max((width - margin.left - margin.right) * tall + margin.top + margin.bottom, 300), Math.max(320, Math.min(640, width))));
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    svg.style.height = `${height}px`;
    svg.replaceChildren();
    const f = fitted();
    const clip = make("clipPath", { id: `clip${place.dataset.chart}` }, make("defs", {}, svg));
    make("rect", { x: margin.left, y: margin.top, width: f.w, height: f.h }, clip);
    const across = ticks(f.x0, f.x1, f.w / 90), up = ticks(f.y0, f.y1, f.h / 60);
    for (const [v, text] of told(across).map((text, i) => [across[i], text])) {
      make("line", { class: "grid", x1: f.px(v), x2: f.px(v), y1: margin.top, y2: margin.top + f.h }, svg);
      make("text", { x: f.px(v), y: margin.top + f.h + 16, "text-anchor": "middle" }, svg).textContent = text;
    }
    for (const [v, text] of told(up).map((text, i) => [up[i], text])) {
      make("line", { class: "grid", x1: margin.left, x2: margin.left + f.w, y1: f.py(v), y2: f.py(v) }, svg);
      make("text", { x: margin.left - 6, y: f.py(v) + 4, "text-anchor": "end" }, svg).textContent = text;
    }
    make("rect", { class: "frame", x: margin.left, y: margin.top, width: f.w, height: f.h }, svg);
    make("text", { x: margin.left + f.w / 2, y: height - 8, "text-anchor": "middle" }, svg).textContent = cut(chart.x, f.w);
    const side = make("text", { transform: `translate(13 ${margin.top + f.h / 2}) rotate(-90)`, "text-anchor": "middle" }, svg);
    side.textContent = cut(chart.y, f.h);
    const inside = make("g", { "clip-path": `url(#clip${place.dataset.chart})` }, svg);
    const names = make("g", { "clip-path": `url(#clip${place.dataset.chart})` }, svg);
    taken = [];
    beneath(f, inside, names);
    svg.append(inside, names);
    legend.replaceChildren();
    chart.lines.forEach((line, i) => {
      const dashes = dash(line.run, i);
      make("path", { d: path(line, f), fill: "none", stroke: colour(i), "stroke-width": 2.2, "stroke-dasharray": dashes ? dashes.join(" ") : "none" }, inside);
      if (line.x.length) make("circle", { cx: f.px(line.x[0]), cy: f.py(line.y[0]), r: 5, fill: "none", stroke: colour(i), "stroke-width": 2 }, inside);
      for (const [x, y] of line.events) make("circle", { cx: f.px(x), cy: f.py(y), r: 4, fill: colour(i) }, inside);
      if (line.name) {
        const item = legend.appendChild(document.createElement("span"));
        const stroke = item.appendChild(document.createElement("i"));
        stroke.style.borderTopColor = colour(i);
        stroke.style.borderTopStyle = !dashes ? "solid" : dashes[0] < 4 ? "dotted" : "dashed";
        item.append(line.name);
      }
    });
    const reading = make("circle", { r: 5, fill: "none", "stroke-width": 2, visibility: "hidden", class: "reading" }, inside);
    reading.setAttribute("stroke", "currentColor");
    movers = chart.lines.map((line, i) => make("circle", { r: 6, fill: colour(i), stroke: "var(--paper)", "stroke-width": 2, visibility: "hidden" }, inside));
    if (now != null) clock(now);
  }
  // Puts a dot where each mover is at a time.
  function clock(t) {
    now = t;
    const f = fitted();
    chart.lines.forEach((line, i) => {
      const at = NtgAt(line, t);
      movers[i].setAttribute("visibility", at ? "visible" : "hidden");
      if (at) { movers[i].setAttribute("cx", f.px(at.x)); movers[i].setAttribute("cy", f.py(at.y)); }
    });
  }

  const at = (event) => {
    const box = svg.getBoundingClientRect();
    return [(event.clientX - box.left) * width / box.width, (event.clientY - box.top) * height / box.height];
  };
  const nearest = (px, py) => {
    const f = fitted();
    let best = { distance: 40 };
    chart.lines.forEach((line, l) => line.x.forEach((x, i) => {
      if (x == null || line.y[i] == null) return;
      const distance = Math.hypot(f.px(x) - px, f.py(line.y[i]) - py);
      if (distance < best.distance) best = { distance, line, l, i };
    }));
    return best;
  };
  let held = null;
  svg.addEventListener("pointerdown", (event) => { held = { from: at(event), view: fitted() }; svg.setPointerCapture(event.pointerId); });
  svg.addEventListener("pointerup", () => { held = null; });
  svg.addEventListener("pointermove", (event) => {
    const [px, py] = at(event);
    if (held) {
      const { x0, x1, y0, y1, w, h } = held.view;
      const dx = (held.from[0] - px) / w * (x1 - x0), dy = (py - held.from[1]) / h * (y1 - y0);
      view = { x: [x0 + dx, x1 + dx], y: [y0 + dy, y1 + dy] };
      redraw();
      return;
    }
    const { line, i } = nearest(px, py), f = fitted(), reading = svg.querySelector(".reading");
    if (!reading) return;
    reading.setAttribute("visibility", line ? "visible" : "hidden");
    if (!line) { tip.textContent = ""; return; }
    reading.setAttribute("cx", f.px(line.x[i]));
    reading.setAttribute("cy", f.py(line.y[i]));
    tip.textContent = `${line.name ? `${line.name}: ` : ""}${chart.x} ${number(line.x[i])}, ${chart.y} ${number(line.y[i])}, ${time.name} ${number(line.t[i])} ${time.unit}`;
  });
  svg.addEventListener("wheel", (event) => {
    event.preventDefault();
    const [px, py] = at(event), f = fitted(), k = event.deltaY > 0 ? 1.2 : 1 / 1.2, cx = f.ux(px), cy = f.uy(py);
    view = { x: [cx + (f.x0 - cx) * k, cx + (f.x1 - cx) * k], y: [cy + (f.y0 - cy) * k, cy + (f.y1 - cy) * k] };
    redraw();
  }, { passive: false });
  svg.addEventListener("dblclick", () => { view = home(); redraw(); });
  new ResizeObserver(redraw).observe(place);
  redraw();
  return { redraw, clock };
}
