// A link to a clip, and to one of its events: it holds after the library is checked again.

export const characterLink = ({ character }) => `clip.html#${new URLSearchParams({ character })}`;

export const clipLink = ({ character, clip }, event = null) =>
  `clip.html#${new URLSearchParams({ character, clip, ...(event === null ? {} : { event: `${event}` }) })}`;

export function readLink() {
  const words = new URLSearchParams(location.hash.slice(1));
  const event = Number.parseInt(words.get('event') ?? '', 10);
  return { character: words.get('character'), clip: words.get('clip'), event: Number.isNaN(event) ? null : event };
}
