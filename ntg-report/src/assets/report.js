// Draws the page's charts: uPlot for what is over time or iterations, NtgMap for tracks.
"use strict";
(() => {
  const root = document.documentElement;
  const charts = JSON.parse(document.getElementById("data").textContent);
  const css = (name) => getComputedStyle(root).getPropertyValue(name).trim();
  const isDark = () => root.classList.contains("dark");
  // Okabe and Ito's colours; the lighter set is legible on dark paper.
  const light = ["#0072b2", "#d55e00", "#009e73", "#aa4499", "#56b4e9", "#b07d00", "#785e28", "#5a5a5a"];
  const dark = ["#58b4ea", "#ff9248", "#2fd3a2", "#e08bd2", "#9bd7ff", "#f0c04a", "#c9a86a", "#b0b0b0"];
  const colour = (i) => (isDark() ? dark : light)[i % 8];
  // Runs differ in their gaps; lines that have the same colour again in their dashes.
  const dash = (run, i) => {
    const again = Math.floor(i / 8);
    if (run) return [10 / (1 + again), 3 + 4 * run];
    return [undefined, [2, 4], [10, 4], [14, 4, 2, 4], [20, 6]][again % 5];
  };
  const drawn = [];

  const prefers = matchMedia("(prefers-color-scheme: dark)");
  const wear = (on) => { root.classList.toggle("dark", on); drawn.forEach((chart) => chart.redraw()); };
  wear(prefers.matches);
  prefers.addEventListener("change", (event) => wear(event.matches));
  // Paper is light and narrow: charts are drawn anew for it, and again for the screen.
  const paper = matchMedia("print");
  let worn = null;
  const print = (on) => {
    if (on === (worn !== null)) return;
    if (on) worn = isDark();
    root.classList.toggle("paper", on);
    drawn.forEach((chart) => chart.resize && chart.resize());
    wear(!on && worn);
    if (!on) worn = null;
  };
  addEventListener("beforeprint", () => print(true));
  addEventListener("afterprint", () => print(false));
  paper.addEventListener("change", (event) => print(event.matches));
  document.getElementById("theme").addEventListener("click", () => wear(!isDark()));

  const number = (v) => {
    if (v == null || !isFinite(v)) return "–";
    if (v !== 0 && (Math.abs(v) >= 1e6 || Math.abs(v) < 1e-3)) return v.toExponential(2).replace(/\.?0+e/, "e");
    return String(+v.toPrecision(5));
  };

  // One table of all lines over the union of their abscissas.
  const joined = (lines) => {
    const tables = lines.map((line) => {
      const xs = [], ys = [];
      line.x.forEach((x, i) => {
        // uPlot wants increasing abscissas; the two sides of a jump are a hair apart.
        const last = xs[xs.length - 1];
        xs.push(last !== undefined && x <= last ? last + 1e-9 * Math.max(1, Math.abs(last)) : x);
        ys.push(line.y[i]);
      });
      return [xs, ys];
    });
    return tables.length === 1 ? tables[0] : uPlot.join(tables);
  };

  const marks = (chart) => (u) => {
    const { ctx } = u, { left, top, width, height } = u.bbox, px = devicePixelRatio;
    ctx.save();
    ctx.beginPath(); ctx.rect(left, top, width, height); ctx.clip();
    ctx.font = `${11 * px}px system-ui, sans-serif`; ctx.textAlign = "left"; ctx.textBaseline = "alphabetic";
    ctx.fillStyle = css("--quiet"); ctx.strokeStyle = css("--ink"); ctx.lineWidth = 1.5 * px; ctx.setLineDash([4 * px, 4 * px]);
    // A limit stands where it holds.
    for (const [at, name, from, to, xs, ys] of chart.limits) {
      // One that is a function of time is a curve, whose name stands where it comes into the picture.
      if (xs) {
        const points = xs.map((x, i) => [u.valToPos(x, "x", true), u.valToPos(ys[i], "y", true)]);
        ctx.beginPath(); points.forEach(([x, y], i) => (i ? ctx.lineTo(x, y) : ctx.moveTo(x, y))); ctx.stroke();
        const seen = points.find(([x, y]) => x >= left && x <= left + width && y >= top && y <= top + height);
        ctx.textAlign = "left";
        if (seen) ctx.fillText(name, seen[0] + 6 * px, Math.max(seen[1] - 4 * px, top + 12 * px));
        continue;
      }
      const y = u.valToPos(at, "y", true), [x0, x1] = [Math.max(left, u.valToPos(from, "x", true)), Math.min(left + width, u.valToPos(to, "x", true))];
      if (x1 < x0) continue;
      ctx.beginPath(); ctx.moveTo(x0, y); ctx.lineTo(x1, y); ctx.stroke();
      // Events have their names at the top, so near it a limit that begins with one has its own at its other end.
      const begins = chart.marks.some(([mark]) => Math.abs(u.valToPos(mark, "x", true) - x0) < 4 * px) && y < top + 64 * px;
      ctx.textAlign = begins ? "right" : "left";
      ctx.fillText(name, begins ? x1 - 6 * px : x0 + 6 * px, y - 4 * px);
    }
    ctx.strokeStyle = css("--quiet"); ctx.lineWidth = px; ctx.setLineDash([7 * px, 5 * px]);
    chart.marks.forEach(([at, name], i) => {
      const x = u.valToPos(at, "x", true);
      if (x < left || x > left + width) return;
      ctx.beginPath(); ctx.moveTo(x, top); ctx.lineTo(x, top + height); ctx.stroke();
      // Before the line where it does not fit behind it.
      const fits = x + 4 * px + ctx.measureText(name).width <= left + width;
      ctx.textAlign = fits ? "left" : "right";
      ctx.fillText(name, x + (fits ? 4 : -4) * px, top + (12 + 13 * (i % 4)) * px);
    });
    ctx.restore();
  };

  // The ordinates of a limit.
  const values = ([at, , , , , ys]) => ys || [at];

  // Limits that are near enough to the values belong into the picture.
  const spanned = (chart) => (u, low, high) => {
    if (low == null) return [0, 1];
    for (const line of chart.lines) if (line.sigma) line.y.forEach((y, i) => { if (y != null && line.sigma[i] != null) { low = Math.min(low, y - line.sigma[i]); high = Math.max(high, y + line.sigma[i]); } });
    const flat = high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high));
    // What is nearly constant is drawn so: its last digits are no signal.
    const lack = flat ? 0 : Math.max(0, chart.least - (high - low)) / 2;
    [low, high] = [low - lack, high + lack];
    const reach = 3 * (high - low);
    const [least, most] = [low - reach, high + reach];
    for (const at of chart.limits.flatMap(values)) if (at > least && at < most) { low = Math.min(low, at); high = Math.max(high, at); }
    const pad = high > low && !(flat && high - low <= chart.least) ? 0.06 * (high - low) : Math.max(0.1 * Math.abs(low), 1e-3);
    return [low - pad, high + pad];
  };

  // Limits that are too far away for the picture, each once.
  const far = (chart) => {
    const own = chart.lines.flatMap((line) => line.y).filter((y) => y != null);
    if (!own.length) return [];
    const least = (pick) => own.reduce((a, b) => pick(a, b)), [min, max] = spanned(chart)(null, least(Math.min), least(Math.max));
    const outside = chart.limits.filter((limit) => values(limit).every((at) => at < min || at > max));
    return [...new Set(outside.map(([at, name, , , , ys]) => `${name} ${ys ? `${number(Math.min(...ys))} .. ${number(Math.max(...ys))}` : number(at)}`))];
  };

  // As much of a label as there is room for, without its middle: a unit stays at the end.
  const cut = (text, pixels) => {
    const most = Math.max(Math.floor(pixels / 7.5), 3), end = Math.floor(most / 3);
    return text.length <= most ? text : `${text.slice(0, most - 1 - end)}…${text.slice(-end)}`;
  };

  const axis = (label) => ({
    label, labelSize: 22, labelFont: "12px system-ui, sans-serif", font: "11px system-ui, sans-serif",
    stroke: () => css("--ink"), grid: { stroke: () => css("--line"), width: 1 }, ticks: { stroke: () => css("--line"), width: 1 },
  });

  // Powers of ten, at most seven of them.
  const decades = (u, axis, low, high) => {
    const first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9);
    const step = Math.max(1, Math.ceil((last - first) / 6)), found = [];
    for (let power = first; power <= last; power += step) found.push(10 ** power);
    return found;
  };
  // With as many decimals as it takes to tell one from the next.
  const told = (ticks) => {
    const short = ticks.map(number);
    if (new Set(short).size === short.length) return short;
    const decimals = 1 - Math.floor(Math.log10(ticks[1] - ticks[0]));
    return ticks.map((v) => v.toFixed(Math.min(Math.max(decimals, 0), 12)));
  };
  // As wide as its longest number.
  const room = (u, values) => 22 + 7 * Math.max(4, ...(values || []).map((text) => (text || "").length));
  const whole = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000];

  // Measured points with a deviation to both sides.
  const deviations = (chart, shade) => (u) => {
    const { ctx } = u, px = devicePixelRatio;
    chart.lines.forEach((line, l) => {
      if (!line.sigma || !u.series[l + 1].show) return;
      ctx.save();
      ctx.beginPath(); ctx.rect(u.bbox.left - 4 * px, u.bbox.top, u.bbox.width + 8 * px, u.bbox.height); ctx.clip();
      ctx.strokeStyle = shade(l); ctx.lineWidth = 1.2 * px; ctx.beginPath();
      line.x.forEach((at, i) => {
        if (line.y[i] == null || line.sigma[i] == null) return;
        const x = u.valToPos(at, "x", true), [low, high] = [-1, 1].map((side) => u.valToPos(line.y[i] + side * line.sigma[i], "y", true));
        ctx.moveTo(x, low); ctx.lineTo(x, high);
        for (const y of [low, high]) { ctx.moveTo(x - 3 * px, y); ctx.lineTo(x + 3 * px, y); }
      });
      ctx.stroke(); ctx.restore();
    });
  };

  // A long title stands above; its line's value has a short name below.
  const named = (line, chart) => line.name || (chart.title.length > 24 ? "value" : chart.title);

  const time = (place, chart) => {
    const log = chart.kind === "log", shade = (i) => colour(chart.lines[i].like ?? i);
    const width = () => Math.max(place.clientWidth - 14, 240), height = 270;
    // An ordinate's label stands beside the plot, which is less high than the picture.
    const less = 60;
    // How the frame of a square in the legend tells the dashes of its line.
    const looks = (i) => { const gaps = dash(chart.lines[i].run, chart.lines[i].like ?? i); return !gaps ? "solid" : gaps.length > 2 ? "double" : gaps[0] < 4 ? "dotted" : "dashed"; };
    const series = chart.lines.map((line, i) => ({
      label: named(line, chart), stroke: () => shade(i), width: line.sigma ? 0 : 2, pxAlign: 0, dash: dash(line.run, line.like ?? i), spanGaps: false,
      ...(line.sigma ? { paths: () => null } : {}),
      value: (u, v) => number(v), points: { show: !!line.sigma || (log || (chart.y.startsWith("dJ*") && !line.x.some((x, k) => k && x === line.x[k - 1]))) && line.x.length < 100, size: 5, fill: () => shade(i), stroke: () => shade(i) },
    }));
    const u = new uPlot({
      width: width(), height, series: [{ label: chart.x, value: (u, v) => number(v) }, ...series],
      scales: { x: { time: false }, y: log ? { distr: 3 } : { range: spanned(chart) } },
      axes: [
        { ...axis(cut(chart.x, width())), ...(log ? { incrs: whole } : {}), values: (u, ticks) => told(ticks) },
        {
          ...axis(cut(chart.y, height - less)), size: room, ...(log ? { splits: decades, filter: (u, splits) => splits } : {}),
          values: (u, ticks) => (log ? ticks.map((v) => `1e${Math.round(Math.log10(v))}`) : told(ticks)),
        },
      ],
      cursor: { sync: log ? undefined : { key: "t" }, drag: { x: true, y: false } },
      legend: { live: true, markers: { width: 2, dash: (u, s) => looks(s - 1), fill: (u, s) => (chart.lines[s - 1].sigma ? shade(s - 1) : null) } }, hooks: { draw: [marks(chart), deviations(chart, shade)] },
    }, joined(chart.lines), place);
    const beyond = log ? [] : far(chart);
    if (beyond.length) {
      const note = place.appendChild(document.createElement("p"));
      note.className = "beyond"; note.textContent = `beyond the picture: ${beyond.join(", ")}`;
    }
    const resize = () => u.setSize({ width: width(), height });
    new ResizeObserver(resize).observe(place);
    // The clock moves the cursor of all charts over time.
    const clock = (t) => { if (!log) u.setCursor({ left: u.valToPos(t, "x"), top: -10 }); };
    drawn.push({ redraw: () => u.redraw(false, true), resize, clock });
  };

  for (const place of document.querySelectorAll("[data-chart]")) {
    const chart = charts[+place.dataset.chart];
    const title = place.appendChild(document.createElement("h3"));
    title.textContent = chart.title;
    const hint = place.appendChild(document.createElement("span"));
    hint.className = "hint";
    const hints = { map: "wheel zooms, drag moves, double click resets", space: "drag turns, wheel zooms, double click resets" };
    hint.textContent = hints[chart.kind] || "drag zooms, double click resets";
    place.classList.toggle("crowded", chart.lines.length > 6);
    if (chart.kind === "space") {
      place.classList.add("wide");
      drawn.push(NtgSpace(place, chart, { colour, dash, number, told, css }));
    } else if (chart.kind === "map") {
      place.classList.add("wide");
      drawn.push(NtgMap(place, chart, { colour, dash, number, told, cut }));
    } else {
      time(place, chart);
    }
  }

  NtgClock(document.getElementById("clock"), charts, (t) => drawn.forEach((chart) => chart.clock && chart.clock(t)), number);

  // Tips beside the pointer or the focused constraint, within the window.
  for (const mark of document.querySelectorAll("pre.spec mark")) {
    const tip = mark.querySelector(".tip");
    const show = () => {
      const box = mark.getClientRects()[0], size = tip.getBoundingClientRect();
      tip.style.left = `${Math.max(8, Math.min(box.left, innerWidth - size.width - 8))}px`;
      tip.style.top = `${box.bottom + size.height + 8 < innerHeight ? box.bottom + 4 : Math.max(8, box.top - size.height - 4)}px`;
    };
    mark.addEventListener("mouseenter", show);
    mark.addEventListener("focus", show);
  }
  for (const link of document.querySelectorAll("nav a")) if (!document.querySelector(link.hash)) link.remove();
})();
