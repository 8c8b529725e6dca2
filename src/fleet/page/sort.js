// The table stands sorted and complete without this; here its headings become buttons, and a search field appears.
(() => {
  const table = document.getElementById("trains");
  if (!table) return;
  const body = table.tBodies[0];
  const heads = [...table.tHead.rows[0].cells];
  const rows = [...body.rows].map((row) => ({ row, text: row.textContent.toLowerCase() }));
  // A cell sorts by its number where it has one; an empty number comes last in either order.
  const key = (row, column) => {
    const cell = row.cells[column];
    const number = cell.dataset.n ?? (cell.classList.contains("number") ? cell.textContent : undefined);
    if (number === undefined) return cell.textContent.trim();
    return number === "" ? null : Number(number);
  };
  const before = (a, b) =>
    typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b), undefined, { numeric: true });
  const sort = (column, sign) => {
    const keyed = rows.map((entry) => [key(entry.row, column), entry]);
    keyed.sort(([a], [b]) => (a === null ? (b === null ? 0 : 1) : b === null ? -1 : sign * before(a, b)));
    body.append(...keyed.map(([, entry]) => entry.row));
  };
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const now = head.getAttribute("aria-sort");
      const next = now ? (now === "ascending" ? "descending" : "ascending") : head.dataset.first;
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", next);
      sort(column, next === "ascending" ? 1 : -1);
    });
  });
  const filter = document.getElementById("filter");
  const [search, only, count] = ["search", "only", "count"].map((id) => document.getElementById(id));
  const show = () => {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const { row, text } of rows) {
      row.hidden = (only.checked && !row.classList.contains("over")) || !words.every((word) => text.includes(word));
      shown += row.hidden ? 0 : 1;
    }
    count.textContent = `${shown} of ${rows.length} shown`;
  };
  search.addEventListener("input", show);
  only.addEventListener("change", show);
  filter.hidden = false;
  show();
  // A link to a train opens what is said of it.
  const open = () => {
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (target && target.tagName === "DETAILS") target.open = true;
  };
  addEventListener("hashchange", open);
  // What is folded is printed open.
  addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((d) => { d.open = true; }));
  open();
})();
