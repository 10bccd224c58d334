import { h } from '../base/dom.js';
import { length, number, percent, plural } from '../base/format.js';

// Where the asset comes from and what its bake reached: the figures people ask for first; with the method the whole report.

const table = (head, rows) =>
  h(
    'div',
    { class: 'scroll' },
    h(
      'table',
      {},
      head && h('thead', {}, h('tr', {}, head.map((name) => h('th', { scope: 'col' }, name)))),
      h('tbody', {}, rows.map((row) => h('tr', {}, row.map((cell, i) => h(i === 0 ? 'th' : 'td', i === 0 ? { scope: 'row' } : {}, cell))))),
    ),
  );

const words = (key) => key.replaceAll('_', ' ');
const isScalar = (value) => value === null || typeof value !== 'object';

function text(value) {
  if (value === null || value === undefined) return '–';
  if (typeof value === 'number') return number(value);
  if (!Array.isArray(value)) return `${value}`;
  if (value.length === 0) return 'none';
  const short = value.length <= 12 && value.every(isScalar);
  return short ? value.map(text).join(', ') : `${value.length} values`;
}

// Any JSON as tables: objects as rows, lists of objects as columns, long lists by their length.
function tree(value) {
  if (Array.isArray(value) && value.length > 0 && value.every((item) => !isScalar(item) && !Array.isArray(item))) {
    const keys = Object.keys(value[0]);
    const plain = keys.filter((key) => value.every((item) => isScalar(item[key]) || Array.isArray(item[key])));
    return table(plain.map(words), value.map((item) => plain.map((key) => text(item[key]))));
  }
  if (isScalar(value) || Array.isArray(value)) return h('p', {}, text(value));
  const entries = Object.entries(value);
  const nested = ([, item]) => !isScalar(item) && (!Array.isArray(item) || item.some((x) => !isScalar(x) && !Array.isArray(x)));
  const rows = entries.filter((entry) => !nested(entry)).map(([key, item]) => [words(key), text(item)]);
  return h(
    'div',
    {},
    rows.length > 0 && table(null, rows),
    entries.filter(nested).map(([key, item]) => h('section', {}, h('h4', {}, words(key)), tree(item))),
  );
}

const section = (title, content, kind = '') => h('section', { class: kind }, h('h3', {}, title), content);
const hash = (value) => (value ? h('code', { class: 'hash', title: value }, value) : '–');

// Text of a setting's value. Edits are many: the tab for them lists each.
function valueOf(key, value) {
  if (key === 'edits') return `${plural(value.spheres.length, 'sphere')}, ${plural(value.ignored_parts.length, 'ignored pair')}`;
  return text(isScalar(value) || Array.isArray(value) ? value : JSON.stringify(value));
}

// Only the paper's experiments turn these (docs/paper.md).
const OF_THE_PAPER = ['rays', 'delta', 'limb_step', 'spheres_per_level', 'refit', 'pivots'];
const shownSettings = (settings) => Object.fromEntries(Object.entries(settings ?? {}).filter(([key]) => !OF_THE_PAPER.includes(key)));

function provenance({ source, writer, format_version: version, settings, settings_sha256: settingsHash }) {
  const chosen = Object.entries(shownSettings(settings)).map(([key, value]) => [words(key), valueOf(key, value)]);
  return [
    section(
      'Provenance',
      table(null, [
        ['source', source.file],
        ['its sha256', hash(source.sha256)],
        ['its mesh', `${number(source.vertices)} vertices, ${number(source.triangles)} triangles`],
        ['written by', `${writer}, format ${version}`],
        ['settings sha256', hash(settingsHash)],
      ]),
    ),
    chosen.length > 0 && section('Settings', table(null, chosen), 'method'),
  ];
}

function fitTable({ grade, far_area: far, protrusion }) {
  return table(null, [
    ['grade', grade],
    ['skin within 2 % of the height of its sphere', percent(1 - far)],
    ['spheres stand out, mean, of the height', percent(protrusion)],
  ]);
}

function achieved({ inspect, report, height }) {
  const error = (name, fit) => fit && [name, length(fit.mean_abs_F, height), length(fit.max_abs_F, height)];
  const counts = [
    ['spheres', number(inspect.sphere_count)],
    ['chain entries', number(inspect.chain_entries)],
    ['ignored pairs', number(inspect.ignored_pairs)],
  ];
  const { phi1, phi1_adjusted: adjusted, phi2 } = inspect.fit ?? {};
  return [
    section('Counts', table(null, counts), 'method'),
    section(
      'Fit of the torso',
      table(['', 'mean |F|', 'max |F|'], [error('phi1', phi1), error("phi1'", adjusted), error('phi2', phi2)].filter(Boolean)),
      'method',
    ),
    report?.bind?.quality && section('Spheres on the skin', fitTable(report.bind.quality)),
    report?.counts?.why && section('Why this count', h('p', {}, report.counts.why), 'method'),
  ];
}

function stages(report) {
  if (!report?.stages) return null;
  const rows = report.stages.map(({ stage, seconds }) => [stage, `${number(Math.round(1e4 * seconds) / 10)} ms`]);
  if (report.total_seconds !== undefined) rows.push(['total', `${number(Math.round(1e4 * report.total_seconds) / 10)} ms`]);
  if (report.peak_memory_mb !== undefined) rows.push(['peak memory', `${Math.round(report.peak_memory_mb)} MB`]);
  return section('Stages', table(null, rows), 'method');
}

function missed(report) {
  const line = (what, list) => list?.length > 0 && h('p', { class: 'missed', role: 'alert' }, `${what} missed: ${list.map(text).join('; ')}`);
  return [line('Targets', report?.missed_targets), line('Edits', report?.edits?.missed)];
}

function wholeReport(report) {
  if (!report) return h('p', { class: 'note' }, 'No bake report in this page: give `view` the file that `bake --report` wrote.');
  const sections = Object.entries(report).filter(([, value]) => !isScalar(value));
  return section(
    'The whole report',
    sections.map(([key, value]) => h('details', {}, h('summary', {}, words(key)), tree(key === 'settings' ? shownSettings(value) : value))),
    'method',
  );
}

export function fillBakePanel(panel, model) {
  const { inspect, report } = model;
  panel.append(
    ...[...missed(report), achieved(model), stages(report), provenance(inspect), wholeReport(report)].flat().filter(Boolean),
  );
}
