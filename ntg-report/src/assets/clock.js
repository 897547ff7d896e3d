// One slider for the time of all tracks: where everything is at that time.
"use strict";
function NtgClock(place, charts, show, number) {
  const moving = charts.filter((chart) => chart.kind === "map" || chart.kind === "space").flatMap((chart) => chart.lines);
  const times = moving.flatMap((line) => (line.t.length ? [line.t[0], line.t[line.t.length - 1]] : []));
  if (!place || !times.length) return;
  const first = Math.min(...times), last = Math.max(...times);
  const play = place.appendChild(document.createElement("button"));
  play.type = "button";
  // Drawn, since not every font has the signs.
  const sign = (path, title) => {
    play.innerHTML = `<svg viewBox="0 0 12 12" width="12" height="12" aria-hidden="true"><path fill="currentColor" d="${path}"/></svg>`;
    play.title = title;
    play.setAttribute("aria-label", title);
  };
  const PLAY = "M2 1 L11 6 L2 11 Z", PAUSE = "M2 1 H5 V11 H2 Z M7 1 H10 V11 H7 Z";
  sign(PLAY, "play");
  const slider = place.appendChild(document.createElement("input"));
  Object.assign(slider, { type: "range", min: 0, max: 1000, step: "any", value: 0, title: "time" });
  slider.setAttribute("aria-label", "time");
  const reading = place.appendChild(document.createElement("output"));
  // The whole run takes eight seconds.
  const WHOLE = 8000;
  let running = null;
  const set = (share) => {
    slider.value = 1000 * share;
    const t = first + share * (last - first);
    reading.textContent = `${place.dataset.name} = ${number(t)} ${place.dataset.unit}`;
    show(t);
  };
  const stop = () => { cancelAnimationFrame(running); running = null; sign(PLAY, "play"); };
  play.addEventListener("click", () => {
    if (running) { stop(); return; }
    const begun = performance.now() - (slider.value >= 1000 ? 0 : (slider.value / 1000) * WHOLE);
    const step = (now) => {
      const share = Math.min((now - begun) / WHOLE, 1);
      set(Math.max(share, 0));
      if (share < 1) running = requestAnimationFrame(step); else stop();
    };
    sign(PAUSE, "pause");
    running = requestAnimationFrame(step);
  });
  slider.addEventListener("input", () => { stop(); set(slider.value / 1000); });
  reading.textContent = `${place.dataset.name} = ${number(first)} ${place.dataset.unit}`;
}
