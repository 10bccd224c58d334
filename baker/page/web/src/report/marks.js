import { insideText } from '../model/contacts.js';

// Events that a person has accepted in this browser, until they are exported. A key is an event's: where, which parts, when.

const STORE = 'spherechain-accepted';

const read = () => {
  try {
    return new Set(JSON.parse(localStorage.getItem(STORE)) ?? []);
  } catch {
    return new Set(); // no storage for files, or another's content
  }
};
let marks = read();

const key = ({ character, clip }, { parts, deepest }) => JSON.stringify([character, clip, parts, deepest]);

export const isAccepted = (row, event) => event.state === 'accepted' || marks.has(key(row, event));

export function toggleAccepted(row, event) {
  const k = key(row, event);
  if (!marks.delete(k)) marks.add(k);
  try {
    localStorage.setItem(STORE, JSON.stringify([...marks]));
  } catch {
    // Kept for this page only.
  }
}

// Another tab of the report has changed them.
export const onMarks = (listener) =>
  addEventListener('storage', () => {
    marks = read();
    listener();
  });

export const percent = (share) => `${share.toFixed(1)} %`;
export const kindText = (event) => (event.class === 'inside' ? `${insideText(event)}, ` : event.class === 'deep_fold' ? 'deep fold, ' : '');

const FAULTS = ['deep_fold', 'penetration', 'inside']; // the worst last
export const rankOf = (event) => FAULTS.indexOf(event.class);
export const isFault = (event) => rankOf(event) >= 0;

// Writes the file that `check --baseline` reads.
export function baseline(rows) {
  const events = rows.flatMap((row) =>
    (row.events ?? [])
      .filter((event) => isFault(event) && event.state !== 'resolved')
      .map((event) => ({
        character: row.character,
        clip: row.clip,
        parts: event.parts,
        class: event.class,
        from_seconds: event.from / row.fps,
        to_seconds: event.to / row.fps,
        depth_mm: event.depth_mm,
        state: isAccepted(row, event) ? 'accepted' : 'known',
      })),
  );
  return { spherechain_baseline: events };
}

export function download(name, text) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], { type: 'application/json' }));
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}
