// In place of the runtime, where the page is built without it.
export const load = null;
