// SPDX-License-Identifier: MIT
// The menu on a phone, the theme, and the search.
const $ = (id) => document.getElementById(id);
const { up } = document.currentScript.dataset;

$('menu-button').addEventListener('click', () => {
  const isOpen = document.body.classList.toggle('menu-open');
  $('menu-button').setAttribute('aria-expanded', isOpen);
});
$('theme').addEventListener('click', () => {
  const root = document.documentElement;
  const isDark = root.dataset.theme ? root.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  root.dataset.theme = isDark ? 'light' : 'dark';
  try {
    localStorage.spherechainTheme = root.dataset.theme;
  } catch {} // a browser may refuse storage to files
});

let index = null; // a promise, once somebody searches
function load() {
  return (index ??= new Promise((done, fail) => {
    const script = document.createElement('script');
    script.src = `${up}search.js`;
    script.onerror = fail;
    script.onload = () => {
      const tokenize = (text) => text.split(/[\s\p{Z}\p{P}`|<>=+]+/u).flatMap((word) => (word.includes('_') ? [word, ...word.split('_')] : [word]));
      const search = new MiniSearch({ fields: ['heading', 'title', 'text'], storeFields: ['place', 'heading', 'title', 'text'], tokenize });
      search.addAll(SECTIONS.map(([place, title, heading, text], id) => ({ id, place, title, heading, text })));
      done(search);
    };
    document.head.append(script);
  }));
}

const escape = (text) => text.replace(/[&<>"]/g, (c) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' })[c]);
function snippet(text, terms) {
  const words = terms.map((term) => term.replace(/[.*+?^${}()|[\]\\]/g, '\\$&')).join('|');
  const at = Math.max(0, text.search(new RegExp(words, 'i')) - 50);
  const part = (at > 0 ? '… ' : '') + text.slice(at, at + 150);
  return escape(part).replace(new RegExp(words, 'gi'), '<mark>$&</mark>');
}

const input = $('search'), results = $('results');
async function find() {
  const query = input.value.trim();
  const search = await load();
  if (query !== input.value.trim()) return;
  results.hidden = query === '';
  const matches = (fuzzy) => search.search(query, { prefix: true, fuzzy, combineWith: 'AND', boost: { heading: 4, title: 3 } });
  let hits = query ? matches(false) : [];
  if (query && hits.length === 0) hits = matches((term) => (term.length > 4 ? 0.2 : 0)); // a slip of the pen
  results.innerHTML = hits
    .slice(0, 12)
    .map(({ place, title, heading, text, terms }) => `<li><a href="${up}${place}"><b>${escape(heading || title)}</b> <i>${heading ? escape(title) : ''}</i><span>${snippet(text, terms)}</span></a></li>`)
    .join('');
  if (query && hits.length === 0) results.innerHTML = '<li class="none">Nothing is found.</li>';
}
input.addEventListener('focus', load);
input.addEventListener('input', find);
document.addEventListener('keydown', (event) => {
  const links = [...results.querySelectorAll('a')];
  const at = links.indexOf(document.activeElement);
  if (event.key === '/' && !/^(INPUT|TEXTAREA)$/.test(document.activeElement.tagName)) input.focus();
  else if (event.key === 'Escape') results.hidden = true;
  else if (event.key === 'ArrowDown' && !results.hidden) links[Math.min(at + 1, links.length - 1)]?.focus();
  else if (event.key === 'ArrowUp' && !results.hidden && at >= 0) (links[at - 1] ?? input).focus();
  else if (event.key === 'Enter' && document.activeElement === input) links[0]?.click();
  else return;
  event.preventDefault();
});
document.addEventListener('click', (event) => {
  if (!event.target.closest('.search') || event.target.closest('#results a')) results.hidden = true;
});
