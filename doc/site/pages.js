// SPDX-License-Identifier: LGPL-2.1-or-later
// Formulas by KaTeX, and the search in index.js: sections that have all words, those
// that have them in their titles first. Both work from a file system, too.
const root = document.currentScript.dataset.root;

for (const place of document.querySelectorAll(".tex"))
  katex.render(place.textContent, place, {
    displayMode: place.classList.contains("display"),
    throwOnError: false,
  });

const field = document.getElementById("search");
const found = document.getElementById("found");

function worth(section, words) {
  const title = section.title.toLowerCase();
  const text = section.text.toLowerCase();
  if (!words.every((word) => title.includes(word) || text.includes(word)))
    return 0;
  return words.reduce(
    (sum, word) => sum + (title.includes(word) ? 20 : 0) + Math.min(9, text.split(word).length),
    1
  );
}

function search() {
  const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
  const best = words.length
    ? sections
        .map((section) => [worth(section, words), section])
        .filter(([size]) => size > 0)
        .sort(([a], [b]) => b - a)
        .slice(0, 15)
    : [];
  found.replaceChildren(
    ...best.map(([, section]) => {
      const link = document.createElement("a");
      link.href = `${root}/${section.location}`;
      link.textContent = section.title;
      const page = document.createElement("small");
      page.textContent = section.page;
      const item = document.createElement("li");
      item.append(link, " ", page);
      return item;
    })
  );
  if (words.length && !best.length) found.textContent = "Nothing found.";
}

field.addEventListener("input", search);
