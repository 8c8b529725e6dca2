// Interactive figures of a report. Without this script, or on paper, the static ones stand in their place.
//
// Numbers come in SI from the element "data", one entry per scenario. Plotly.js lies compressed in the element "library".
// `drawFigures` is for a page that draws other numbers later.
"use strict";
(function () {
  // --- the library -----------------------------------------------------------------------------------------------------
  let Plotly = null;
  async function unpackLibrary() {
    const packed = Uint8Array.from(atob(document.getElementById("library").textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    const script = document.createElement("script");
    script.textContent = await new Response(stream).text();
    document.head.append(script);
    Plotly = window.Plotly;
  }

  // --- words and numbers -----------------------------------------------------------------------------------------------
  const escaped = (s) => s.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
  const digits = (x) => {
    const text = x.toPrecision(4);
    return x === 0 ? "0" : text.includes("e+") && x < 1e6 ? Math.round(x).toString() : text;
  };
  // What was given rather than computed: no zeros at its end.
  const given = (x) => Number(x.toPrecision(6)).toString();
  const sense = (f) => (f < 0 ? "buff" : "draft");
  const percent = (share) => digits(100 * Math.abs(share)) + " %";

  function element(tag, properties, ...children) {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
  }

  // --- one scenario ----------------------------------------------------------------------------------------------------
  function unpack(forces, columns) {
    const bytes = Uint8Array.from(atob(forces.forces), (c) => c.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    return (row, column) => {
      const number = view.getInt16(2 * (row * columns + column), true);
      return number === -32768 ? null : number * forces.unit_n;
    };
  }

  function decode(forces, rows) {
    const n = forces.columns;
    const force = unpack(forces, n);
    const times = Array.from({ length: n }, (_, i) => forces.from_s + i * forces.step_s);
    return { rows, times, force, row: (r) => times.map((_, i) => force(r, i)),
      open: (r, i) => forces.slack !== undefined && forces.slack[r] && force(r, i) === 0, folded: forces.instants_per_column };
  }

  // Above this the 16-bit numbers leave no doubt that a force is over its rating, %.
  const OVER = 100.02;

  // Of the figures that are drawn: what is chosen in each, by scenario, and what ends them.
  const states = new Map();
  let endings = [];

  function figures(scene, number, place, several) {
    const [unitName, unit] = scene.force_unit;
    const [clockName, clock] = scene.time_unit;
    const force = (f) => digits(Math.abs(f) / unit) + " " + unitName + " in " + sense(f);
    const time = (t) => digits(t / clock) + " " + clockName;
    const all = scene.couplers.concat(scene.broken || []).sort((a, b) => a.coupler - b.coupler);
    const by = new Map(all.map((c) => [c.coupler, c]));
    const count = Math.max(...by.keys(), scene.broken_coupler || 0);
    const share = (c, f) => f / (f < 0 ? c.rated_buff_n : c.rated_draft_n);
    const name = (c) => "Coupler " + c.coupler + ", between " + c.between[0] + " and " + c.between[1];
    const wave = scene.wave && decode(scene.wave, count);
    const rod = scene.rod && decode(scene.rod, count);
    function nearest(t) {
      return Math.min(wave.times.length - 1, Math.max(0, Math.round((t - scene.wave.from_s) / scene.wave.step_s)));
    }
    function worst_instant(c) {
      const peaks = [[c.peak_draft_n, c.peak_draft_time_s], [c.peak_buff_n, c.peak_buff_time_s]].filter((p) => p[0] !== null);
      return peaks.reduce((a, b) => (Math.abs(share(c, b[0])) > Math.abs(share(c, a[0])) ? b : a), [0, 0])[1];
    }
    // Largest forces of one break of several; null where those over all breaks are shown.
    const byBreak = scene.breaks && unpack(scene.breaks, 2 * count);
    const chosen = (c, buff) => byBreak(state.brk, (buff ? count : 0) + c.coupler - 1);
    // Forces over time are those of one break.
    const broken = () => (state.brk === null ? scene.broken_coupler : scene.breaks.broken[state.brk]);
    const timed = () => wave && broken() === scene.broken_coupler;
    const gone = () => scene.several && state.coupler === scene.broken_coupler;
    // What the 16-bit numbers leave in doubt is not marked.
    const exceeds = (c, f) => (state.brk !== null ? Math.abs(share(c, f)) > OVER / 100 : Math.abs(share(c, f)) > 1 && (scene.several ? scene.largest[c.coupler - 1].exceeds : c.exceeds === true));
    const over = (c, f) => (exceeds(c, f) ? " (over)" : "");
    // The page opens at the worst instant; the first run starts at t = 0 all the same.
    const opening = wave ? nearest(worst_instant(by.get(scene.worst))) : 0;
    const state = { coupler: scene.worst, picked: false, column: opening, timer: null, fresh: true, brk: null };
    // What a reader chose in figures of earlier numbers stays.
    const earlier = states.get(number);
    if (earlier && earlier.picked && by.has(earlier.coupler)) Object.assign(state, { coupler: earlier.coupler, picked: true });
    if (earlier && wave && !earlier.fresh) Object.assign(state, { column: Math.min(earlier.column, wave.times.length - 1), fresh: false });
    states.set(number, state);

    // The largest forces of a coupler in words, a list of lines.
    function facts(c) {
      const lines = [name(c)];
      const peak = (word, f, t, suffix) => lines.push(
        f === null || f === 0 ? "never in " + word : "largest " + word + " " + digits(Math.abs(f) / unit) + " " + unitName + suffix +
          (t === null ? "" : " at " + time(t)) + ": " + percent(share(c, f)) + " of its rating" + over(c, f));
      if (state.brk !== null && scene.breaks.broken[state.brk] === c.coupler) {
        lines.push("it breaks");
      } else if (state.brk !== null) {
        peak("draft", chosen(c, false), null, "");
        peak("buff", chosen(c, true), null, "");
      } else if (scene.several) {
        const l = scene.largest[c.coupler - 1];
        const after = (b) => (b === null ? "" : " after coupler " + b + " breaks");
        peak("draft", l.draft_n, null, after(l.draft_break));
        peak("buff", l.buff_n, null, after(l.buff_break));
      } else {
        peak("draft", c.peak_draft_n, c.peak_draft_time_s, "");
        peak("buff", c.peak_buff_n, c.peak_buff_time_s, "");
      }
      lines.push("rated " + given(c.rated_draft_n / unit) + " " + unitName + " in draft, " + given(c.rated_buff_n / unit) + " " + unitName + " in buff");
      return lines;
    }

    // --- elements ------------------------------------------------------------------------------------------------------
    const id = (what) => what + "-" + (number + 1);
    const select = element("select", { id: id("coupler") });
    for (const c of all) {
      select.append(element("option", { value: c.coupler, textContent: c.coupler + " (" + c.between.join(", ") + ")" }));
    }
    const said = element("p", { id: id("said"), className: "note" });
    said.setAttribute("aria-live", "polite");
    const along = element("div", { className: "plot", id: id("along") });
    const over_time = element("div", { className: "plot", id: id("history") });
    const map = element("div", { className: "plot", id: id("map") });
    const play = element("button", { type: "button", id: id("play"), textContent: "Play" });
    const slider = element("input", { type: "range", id: id("time"), min: 0, max: wave ? wave.times.length - 1 : 0, step: 1, value: 0 });
    const shown = element("output", { id: id("shown") });
    shown.htmlFor = slider.id;
    // One level below the heading that they stand under.
    const heading = (text) => element(several ? "h3" : "h2", { textContent: text });
    const label = (control, text) => element("label", { htmlFor: control.id, textContent: text });
    const note = (text) => element("p", { className: "note", textContent: text });
    const [lead, of_one] = [heading(""), heading("")];
    const pointing = note("");
    const parts = [lead, pointing];
    const brk = element("select", { id: id("break") });
    if (byBreak) {
      brk.append(element("option", { value: "", textContent: "all breaks" }));
      scene.breaks.broken.forEach((b, i) => brk.append(element("option", { value: i, textContent: "the break of coupler " + b })));
      parts.push(element("div", { className: "bar" }, label(brk, "Show the forces of"), brk));
      if (scene.breaks.left_out) parts.push(note("The " + scene.breaks.broken.length + " worst breaks can be chosen; to keep the file small, it leaves out the forces of " + scene.breaks.left_out + " others."));
    }
    // What follows is hidden where it is not of the break that is chosen.
    const running = element("div", {}, note("The slider and the button run the wave through the train" + scene.when.replace(",", "") + "."),
      element("div", { className: "bar" }, play, label(slider, scene.since), slider, shown));
    if (wave && wave.folded > 1) {
      running.append(note("To keep the file small, each step covers " + time(scene.wave.step_s) + " and shows each coupler's largest utilisation in it."));
    }
    const by_place = element("div", {}, heading("Force by place and time" + scene.when),
      note("As a share of the rating: draft blue, buff orange, outlined where the force exceeds the rating" +
        (wave && scene.wave.slack ? "; grey where a coupler is open (it passes its slack, without force)" : "") + ". Click for that coupler and that instant."), map);
    const absent = element("p", { id: id("absent"), className: "note" });
    parts.push(along);
    if (wave) parts.push(running);
    parts.push(of_one, element("div", { className: "bar" }, label(select, "Coupler"), select), said, absent);
    if (wave) parts.push(over_time, by_place);
    place.append(...parts);
    place.hidden = false;

    // --- looks ---------------------------------------------------------------------------------------------------------
    const style = getComputedStyle(document.documentElement);
    const color = (name) => style.getPropertyValue("--" + name).trim();
    const narrow = () => place.clientWidth < 520;
    const touch = matchMedia("(pointer: coarse)").matches;
    const config = { displayModeBar: false, responsive: true, showTips: false, doubleClick: "reset" };
    function layout(height, x, y, more) {
      const axis = (title) => ({ title: { text: title, standoff: 8 }, gridcolor: color("line"), zerolinecolor: color("quiet"), linecolor: color("quiet"), automargin: true, fixedrange: touch });
      return Object.assign({
        height, margin: { l: 8, r: 8, t: 8, b: 8 }, paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
        font: { color: color("text"), family: getComputedStyle(document.body).fontFamily, size: 13 },
        hoverlabel: { align: "left", bgcolor: color("page"), bordercolor: color("quiet"), font: { color: color("text") } },
        legend: { orientation: "h", x: 0, y: 1, yanchor: "bottom" }, dragmode: touch ? false : "zoom", xaxis: axis(x), yaxis: axis(y),
      }, more);
    }
    // Ends of a force axis, and what it says of ratings beyond them: one that is far off would press the forces flat.
    const reach = ([low, high]) => [low / unit, high / unit];
    function beyond(couplers, [low, high]) {
      return [["rated_draft_n", 1], ["rated_buff_n", -1]].flatMap(([key, sign]) => {
        const sizes = couplers.map((c) => c[key]).filter((f) => (sign > 0 ? f > high : -f < low)).map((f) => f / unit);
        if (sizes.length === 0) return [];
        const [least, most] = [Math.min(...sizes), Math.max(...sizes)].map(given);
        return [{ x: 1, xref: "paper", y: sign > 0 ? 1 : 0, yref: "paper", xanchor: "right", yanchor: sign > 0 ? "top" : "bottom", showarrow: false, bgcolor: color("card"),
          font: { color: color("text"), size: 12 }, text: "rated " + least + (least === most ? "" : " to " + most) + " " + unitName + (sign > 0 ? " \u2191" : " \u2193") }];
      });
    }
    const line = (x, y, name, paint, more) => Object.assign({ x, y, name, mode: "lines", line: Object.assign({ color: paint, width: 2 }, more && more.line), hoverinfo: "skip" },
      more && more.trace);
    const forceAxis = "force, " + unitName + " (draft +, buff \u2212)";
    const timeAxis = scene.since + ", " + clockName;
    const inUnits = (f) => (f === null ? null : f / unit);

    // --- along the train: the envelope, the ratings, the wave at an instant ----------------------------------------------
    // Every coupler's place; one that breaks is a gap.
    const places = Array.from({ length: count }, (_, i) => i + 1);
    const of = (value) => places.map((p) => (by.has(p) ? value(by.get(p)) : null));
    const high = (c) => (state.brk !== null ? chosen(c, false) : scene.several ? scene.largest[c.coupler - 1].draft_n : c.peak_draft_n || 0);
    const low = (c) => (state.brk !== null ? chosen(c, true) : scene.several ? scene.largest[c.coupler - 1].buff_n : c.peak_buff_n || 0);
    const marked = () => all.flatMap((c) => [high(c), low(c)].filter((f) => exceeds(c, f)).map((f) => [c.coupler, f / unit]));
    // As in the static figures: smaller where they are many, and never so small that they are overlooked.
    const mark_size = (marks) => 2 * Math.min(6, Math.max(4.5, 600 / Math.max(1, marks)));
    const step = { line: { shape: "hvh" } };
    const dashed = { line: { dash: "dash", width: 1.5, shape: "hvh" } };
    // A few couplers of a lower rating between stronger ones: a dash of the line of ratings is too narrow to be seen there.
    const weak = [["rated_draft_n", 1], ["rated_buff_n", -1]].flatMap(([key, sign]) => {
      const strongest = Math.max(...all.map((c) => c[key]));
      const lower = all.filter((c) => c[key] < 0.999 * strongest);
      return 5 * lower.length > all.length ? [] : lower.map((c) => [c.coupler, (sign * c[key]) / unit]);
    });
    const WAVE = 7;
    function alongTraces() {
      const exceeding = marked();
      const filled = (name, paint) => line(places, [], name, paint, { line: { shape: "hvh", width: 1 }, trace: { fill: "tozeroy" } });
      return [
        Object.assign(line(places, of((c) => inUnits(high(c))), "largest draft", color("draft"), step),
          { hoverinfo: "text", hovertext: of((c) => facts(c).map(escaped).join("<br>")) }),
        line(places, of((c) => inUnits(low(c))), "largest buff", color("buff"), step),
        line(places, of((c) => c.rated_draft_n / unit), "rated", color("text"), dashed),
        line(places, of((c) => -c.rated_buff_n / unit), "rated", color("text"), Object.assign({ trace: { showlegend: false } }, dashed)),
        { x: weak.map((w) => w[0]), y: weak.map((w) => w[1]), mode: "markers", showlegend: false, hoverinfo: "skip",
          marker: { symbol: "line-ew", size: 11, line: { color: color("text"), width: 2.5 } }, visible: weak.length > 0 },
        { x: exceeding.map((e) => e[0]), y: exceeding.map((e) => e[1]), name: "over its rating", mode: "markers", hoverinfo: "skip",
          marker: { symbol: "diamond", color: color("over"), size: mark_size(exceeding.length), line: { color: color("card"), width: 0.7 } }, visible: exceeding.length > 0 },
        line(places, scene.initial_force_n ? of((c) => inUnits(scene.initial_force_n[c.coupler - 1])) : [], "before the event", color("text"),
          { line: { dash: "dot", width: 1.5, shape: "hvh" }, trace: { visible: scene.initial_force_n ? true : false } }),
        filled("the wave, draft", color("draft")), filled("the wave, buff", color("buff")),
      ];
    }
    function instant() {
      const at = (keep) => places.map((p) => {
        const f = wave.force(p - 1, state.column);
        return f === null ? null : keep(f / unit);
      });
      return [at((f) => Math.max(f, 0)), at((f) => Math.min(f, 0))];
    }

    function alongLayout() {
      const made = layout(narrow() ? 470 : 380, "coupler, counted from the head", forceAxis, { hovermode: "x", hoverdistance: -1 });
      made.xaxis.range = [0.3, count + 0.7];
      if (count < 10) made.xaxis.dtick = 1;
      const b = broken();
      made.yaxis.range = reach(scene.reach_n);
      // The numbers of few weak ratings, on a ground of their own beyond the line.
      if (weak.length <= 6) made.annotations = weak.map(([x, y]) => ({ x, y, text: given(Math.abs(y)), showarrow: false, xanchor: "left", xshift: 9,
        yanchor: y > 0 ? "bottom" : "top", yshift: y > 0 ? 6 : -6, bgcolor: color("card"), borderpad: 1, font: { color: color("text"), size: 11 } }));
      made.annotations = (made.annotations || []).concat(beyond(all, scene.reach_n));
      if (b === null || (scene.several && state.brk === null)) return made;
      made.shapes = [{ type: "line", xref: "x", yref: "paper", x0: b, x1: b, y0: 0, y1: 1, line: { color: color("quiet"), width: 1.5, dash: "dot" } }];
      // Where the label covers least: beside the line, over some of the couplers there.
      const [text, side, [bottom, top]] = ["coupler " + b + " breaks", 2 * b > count ? -1 : 1, scene.reach_n];
      const beside = all.filter((c) => (c.coupler - b) * side >= 0 && (c.coupler - b) * side < (7.5 * text.length * count) / (place.clientWidth - 110));
      const drawn = beside.flatMap((c) => [high(c), low(c), c.rated_draft_n, -c.rated_buff_n, 0, scene.initial_force_n ? scene.initial_force_n[c.coupler - 1] : 0]);
      const covers = (y) => drawn.filter((f) => Math.abs(f - y) < 0.05 * (top - bottom)).length;
      const heights = Array.from({ length: 23 }, (_, i) => bottom + ((i + 1) / 24) * (top - bottom));
      const y = heights.reduce((a, b) => (covers(b) < covers(a) ? b : a)) / unit;
      made.annotations.push({ x: b, y, text, showarrow: false, xanchor: side < 0 ? "right" : "left", bgcolor: color("card") });
      return made;
    }

    // --- one coupler over time -------------------------------------------------------------------------------------------
    // The exact peaks take the place of the nearest instants, which stand beside them.
    function course(field, c) {
      const t = field.times.slice(), f = field.row(c.coupler - 1);
      if (field === wave && wave.folded === 1) {
        for (const [peak, at] of [[c.peak_draft_n, c.peak_draft_time_s], [c.peak_buff_n, c.peak_buff_time_s]]) {
          if (peak === null) continue;
          const column = nearest(at);
          t[column] = at;
          f[column] = peak;
        }
      }
      return [t.map((x) => x / clock), f.map(inUnits)];
    }
    // The part of a line that lies between two heights.
    function between(t, f, low, high) {
      const x = [], y = [];
      for (let i = 1; i < t.length; i++) {
        const rise = f[i] - f[i - 1];
        if (f[i] === null || f[i - 1] === null || (rise === 0 && (f[i] < low || f[i] > high))) continue;
        const [enter, leave] = [low, high].map((v) => (v - f[i - 1]) / rise).sort((a, b) => a - b);
        const [from, to] = rise === 0 ? [0, 1] : [Math.max(0, enter), Math.min(1, leave)];
        if (from >= to) continue;
        const at = (s) => { x.push(t[i - 1] + s * (t[i] - t[i - 1])); y.push(f[i - 1] + s * rise); };
        if (from > 0 || x[x.length - 1] !== t[i - 1]) { x.push(null); y.push(null); at(from); }
        at(to);
      }
      return [x, y];
    }
    function historyTraces() {
      const c = by.get(state.coupler);
      const across = [0, wave.times[wave.times.length - 1] / clock];
      const [t, f] = course(wave, c);
      const peaks = [[c.peak_draft_n, c.peak_draft_time_s], [c.peak_buff_n, c.peak_buff_time_s]].filter((p) => p[0] !== null);
      const traces = [
        line(across, [c.rated_draft_n / unit, c.rated_draft_n / unit], "rated", color("text"), { line: { dash: "dash", width: 1.5 } }),
        line(across, [-c.rated_buff_n / unit, -c.rated_buff_n / unit], "rated", color("text"), { line: { dash: "dash", width: 1.5 }, trace: { showlegend: false } }),
      ];
      if (rod) traces.push(line(...course(rod, c), "elastic rod", color("rod"), { line: { dash: "dot" } }));
      // Each stretch in the colour of its sense, and over that what is over the rating; a line along the rating is not over it.
      const aside = 0.006 * (c.reach_n[1] - c.reach_n[0]) / unit;
      for (const [low, high, name, paint, width] of [[0, Infinity, "draft", "draft", 2], [-Infinity, 0, "buff", "buff", 2],
        [c.rated_draft_n / unit + aside, Infinity, "over its rating", "over", 3], [-Infinity, -c.rated_buff_n / unit - aside, "over its rating", "over", 3]]) {
        const [x, y] = between(t, f, low, high);
        if (x.length) traces.push(line(x, y, name, color(paint), { line: { width }, trace: { showlegend: !traces.some((trace) => trace.name === name) } }));
      }
      traces.push(Object.assign(line(t, f, "coupler " + c.coupler, "rgba(0,0,0,0)"), { showlegend: false, hoverinfo: "text",
        hovertext: t.map((x, i) => (f[i] === null ? "" : time(x * clock) + ": " + force(f[i] * unit) + ", " + percent(share(c, f[i] * unit)) + " of its rating")) }));
      traces.push({ x: peaks.map((p) => p[1] / clock), y: peaks.map((p) => p[0] / unit), name: "largest draft and buff", mode: "markers", hoverinfo: "text",
        hovertext: peaks.map((p) => "largest " + sense(p[0]) + ": " + force(p[0]) + " at " + time(p[1])), marker: { symbol: "diamond", size: 9, color: peaks.map((p) => color(exceeds(c, p[0]) ? "over" : sense(p[0]))) } });
      return traces;
    }
    // Axes of the same time lie under each other.
    function aligned(made) {
      made.margin.l = 64;
      made.margin.r = 16;
      made.xaxis.range = [0, wave.times[wave.times.length - 1] / clock];
      for (const axis of [made.yaxis, made.yaxis2].filter((a) => a)) axis.automargin = false;
      return made;
    }
    function historyLayout() {
      const c = by.get(state.coupler);
      const made = aligned(layout(narrow() ? 400 : 340, timeAxis, forceAxis, { hovermode: "x", shapes: cursor(), annotations: beyond([c], c.reach_n) }));
      made.yaxis.range = reach(c.reach_n);
      return made;
    }
    const cursor = () => [{ type: "line", xref: "x", yref: "paper", y0: 0, y1: 1, x0: wave.times[state.column] / clock, x1: wave.times[state.column] / clock,
      line: { color: color("quiet"), width: 1 } }];

    // --- place and time --------------------------------------------------------------------------------------------------
    // Couplers over their ratings, marked at the right, and where and when: symbols, as an outline one coupler high is not seen.
    function marks(field, end, axis) {
      const [wide, high] = [place.clientWidth, rod ? 210 : 290];
      const apart = (a, b) => Math.hypot(((a[0] - b[0]) * wide) / scene.horizon_s, ((a[1] - b[1]) * high) / count) >= 14;
      const shown = field.over_at.reduce((kept, p) => (kept.every((k) => apart(p, k)) ? kept.concat([p]) : kept), []);
      const mark = (x, y, marker, name) => ({ type: "scatter", mode: "markers", x, y, yaxis: axis, marker, hoverinfo: "skip", cliponaxis: false, name, showlegend: name !== undefined && axis === "y" });
      const [x, y] = [shown.map((p) => p[0] / clock), shown.map((p) => p[1])];
      if (field.over.length === 0) return [];
      return [mark(field.over.map(() => end), field.over, { symbol: "triangle-left", size: 11, color: color("over") }, "coupler over its rating"),
        ...[["card", 5], ["over", 2.2, "where and when"]].map(([paint, width, name]) => mark(x, y, { symbol: "diamond-open", size: 11, color: color(paint), line: { width } }, name))];
    }
    const scale = () => color("ramp").split(" ").map((paint, i, all) => [i / (all.length - 1), paint]);
    function mapTraces() {
      const panel = (field, given_field, axis, bar) => {
        const z = places.map((p) => field.row(p - 1).map((f) => (f === null ? null : 100 * share(by.get(p), f))));
        const open = z.map((row, r) => row.map((s, i) => (s !== null && field.open(r, i) ? 1 : null)));
        const text = z.map((row, r) => row.map((s, i) => (s === null ? "" : open[r][i] ? "open: it passes its slack" : percent(s / 100) + " of its rating")));
        const forces = z.map((row, r) => row.map((s, i) => (s === null ? "" : force(field.force(r, i)))));
        const x = field.times.map((t) => t / clock);
        const heat = { type: "heatmap", x, y: places, z, text, customdata: forces, colorscale: scale(), zmid: 0, zmin: -most, zmax: most, yaxis: axis, showscale: bar,
          colorbar: { title: { text: "buff \u2190 share of the rating \u2192 draft", side: "bottom" }, tickvals: ticks, ticktext: ticks.map((v) => Math.abs(v) + " %"), orientation: "h", yref: "container", y: 0, yanchor: "bottom", thickness: 12, outlinewidth: 0, len: 0.8 }, hoverongaps: false,
          hovertemplate: "coupler %{y}, %{x:.4g} " + clockName + "<br>%{customdata}<br>%{text}<extra>" + (bar ? "" : "elastic rod") + "</extra>" };
        const made = [heat];
        if (open.some((row) => row.includes(1))) made.push({ type: "heatmap", x, y: places, z: open, yaxis: axis, showscale: false, hoverinfo: "skip",
          colorscale: [[0, color("slack")], [1, color("slack")]] });
        made.push(...marks(given_field, x[x.length - 1], axis));
        const cells = z.length * x.length;
        const passes = z.some((row) => row.some((s) => Math.abs(s) > OVER));
        if (!passes || z.length < 2 || cells > 120000) return made;
        return made.concat({ type: "contour", x, y: places, z: z.map((row) => row.map((s) => (s === null ? 0 : Math.abs(s)))), yaxis: axis, showscale: false, showlegend: false, hoverinfo: "skip",
          contours: { start: OVER, end: OVER, size: 1, coloring: "none" }, line: { color: color("text"), width: 1, smoothing: 0 } });
      };
      // One scale for all figures of a report.
      const most = 100 * scene.most;
      const stride = [1, 2, 5, 10, 20, 25, 50, 100, 200, 500, 1000].find((s) => most / s < (narrow() ? 3 : 5)) || most;
      const ticks = Array.from({ length: 2 * Math.floor(most / stride) + 1 }, (_, i) => (i - Math.floor(most / stride)) * stride);
      return panel(wave, scene.wave, "y", true).concat(rod ? panel(rod, scene.rod, "y2", false) : []);
    }
    function mapLayout() {
      const made = layout(rod ? 620 : 420, timeAxis, "coupler, from the head", { shapes: cursor() });
      Object.assign(made.yaxis, { range: [count + 0.5, 0.5], domain: rod ? [0.55, 1] : [0, 1], showgrid: false });
      made.xaxis.showgrid = false;
      if (rod) made.xaxis.anchor = "y2";
      if (rod) made.yaxis2 = Object.assign({}, made.yaxis, { domain: [0, 0.45], title: { text: "elastic rod", standoff: 8 } });
      made.margin.b = 110;
      return aligned(made);
    }

    // --- drawing and acting ------------------------------------------------------------------------------------------------
    function describe() {
      said.textContent = facts(by.get(state.coupler)).join("; ") + ".";
    }
    function drawHistory() {
      const [at, b] = [timed(), scene.broken_coupler];
      over_time.hidden = !at || gone();
      absent.hidden = !over_time.hidden || !wave;
      absent.textContent = at ? "Coupler " + b + " breaks at t = 0 and has no force after that."
        : "Forces over time are in this page for the break of coupler " + b + " only, the worst of these breaks.";
      if (!over_time.hidden) Plotly.react(over_time, historyTraces(), historyLayout(), config);
    }
    function draw() {
      const when = state.brk === null ? scene.when : ", when coupler " + broken() + " breaks";
      lead.textContent = "Forces along the train" + (scene.several && state.brk === null ? ": the largest over all breaks" : when);
      of_one.textContent = timed() ? "Force over time" + when : "Largest forces of one coupler" + (state.brk === null ? "" : when);
      pointing.textContent = "Point at a coupler for its forces; " + (document.body.dataset.click || "click it, or choose it below, " + (timed() ? "to see its force over time" : "to read them")) + ".";
      running.hidden = by_place.hidden = !timed();
      Plotly.react(along, alongTraces(), alongLayout(), config);
      if (!wave) return drawHistory();
      drawHistory();
      if (timed()) Plotly.react(map, mapTraces(), mapLayout(), config);
      show(state.column);
    }
    function show(column) {
      state.column = column;
      slider.value = column;
      const at = time(wave.times[column]);
      shown.textContent = at;
      slider.setAttribute("aria-valuetext", at);
      const [draft, buff] = timed() ? instant() : [[], []];
      Plotly.restyle(along, { y: [draft, buff] }, [WAVE, WAVE + 1]);
      if (!timed()) return;
      if (!over_time.hidden) Plotly.relayout(over_time, { shapes: cursor() });
      Plotly.relayout(map, { shapes: cursor() });
    }
    function choose(coupler) {
      if (!by.has(coupler)) return;
      state.coupler = coupler;
      select.value = coupler;
      describe();
      drawHistory();
    }
    function stop() {
      clearInterval(state.timer);
      state.timer = null;
      play.textContent = "Play";
    }
    // The whole horizon in some twelve seconds.
    function start() {
      const stride = Math.max(1, Math.round(wave.times.length / 240));
      if (state.fresh || state.column >= wave.times.length - 1) state.column = 0;
      state.fresh = false;
      play.textContent = "Pause";
      state.timer = setInterval(() => {
        show(Math.min(state.column + stride, wave.times.length - 1));
        if (state.column >= wave.times.length - 1) stop();
      }, 50);
    }
    // What the reader chooses; a page may take a click on a coupler for something else.
    function pick(coupler) {
      state.picked = true;
      choose(coupler);
    }
    const clicked = (coupler) => place.dispatchEvent(new CustomEvent("coupler", { detail: coupler, bubbles: true, cancelable: true }));
    draw();
    choose(state.coupler);
    brk.addEventListener("change", () => {
      state.brk = brk.value === "" ? null : Number(brk.value);
      stop();
      // A page with the program behind it computes that break.
      if (wave && !timed() && !clicked(broken())) return;
      draw();
      describe();
    });
    select.addEventListener("change", () => pick(Number(select.value)));
    along.on("plotly_click", (event) => { if (clicked(event.points[0].x)) pick(event.points[0].x); });
    if (wave) {
      play.addEventListener("click", () => (state.timer === null ? start() : stop()));
      slider.addEventListener("input", () => { stop(); state.fresh = false; show(Number(slider.value)); });
      map.on("plotly_click", (event) => {
        const point = event.points[0];
        pick(point.y);
        stop();
        state.fresh = false;
        show(Math.round((point.x * clock - scene.wave.from_s) / scene.wave.step_s));
      });
    }
    const plain = (div, text) => { div.setAttribute("role", "img"); div.setAttribute("aria-label", text); };
    plain(along, "Largest draft and buff of every coupler along the train, the ratings, and the forces at the instant of the slider");
    if (wave) {
      plain(over_time, "Force in the chosen coupler over time, with its ratings");
      plain(map, "Force in every coupler by place and time");
    }
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", draw);
    endings.push(() => {
      clearInterval(state.timer);
      dark.removeEventListener("change", draw);
      [along, over_time, map].forEach((plot) => Plotly.purge(plot));
    });
    for (const kind of wave ? ["envelope", "wave", "force"] : ["envelope"]) {
      document.querySelectorAll('figure[data-scenario="' + number + '"][data-kind="' + kind + '"]').forEach((f) => f.classList.add("replaced"));
    }
  }

  // Draws scenes into the places that the page has for them; what was drawn before ends.
  async function drawFigures(scenes) {
    if (!scenes.some((scene) => scene) || !("DecompressionStream" in window)) return;
    if (!Plotly) await unpackLibrary();
    if (!Plotly) return;
    endings.splice(0).forEach((end) => end());
    document.querySelectorAll(".live").forEach((place) => {
      const number = Number(place.dataset.scenario);
      if (scenes[number]) figures(scenes[number], number, place, scenes.length > 1);
    });
  }
  // What is folded is printed open.
  addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((d) => { d.open = true; }));
  window.drawFigures = drawFigures;
  drawFigures(JSON.parse(document.getElementById("data").textContent)).then(() => { document.documentElement.dataset.drawn = "yes"; });
})();
