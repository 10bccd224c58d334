// States one after another, to go back and forth in. A run of changes of one `kind` in short time is one step.
export class History {
  constructor(state) {
    Object.assign(this, { states: [state], at: 0, kind: null, time: 0, listeners: [] });
  }
  get now() {
    return this.states[this.at];
  }
  get canUndo() {
    return this.at > 0;
  }
  get canRedo() {
    return this.at + 1 < this.states.length;
  }
  push(state, kind = null, time = 0) {
    const goesOn = kind !== null && kind === this.kind && time - this.time < 1000 && this.at > 0;
    this.states.splice(this.at + (goesOn ? 0 : 1));
    this.states.push(state);
    this.at = this.states.length - 1;
    Object.assign(this, { kind, time });
    this.tell();
  }
  // Takes the place of the state that is shown; what was taken back is gone.
  replace(state) {
    this.states.splice(this.at);
    this.states.push(state);
    this.kind = null;
    this.tell();
  }
  step(by) {
    this.at = Math.min(Math.max(this.at + by, 0), this.states.length - 1);
    this.kind = null;
    this.tell();
  }
  tell() {
    for (const listener of this.listeners) listener();
  }
}

// How many states a key goes: -1 to undo, 1 to redo, else 0.
export function stepOf({ key, ctrlKey, metaKey, shiftKey }) {
  if (!ctrlKey && !metaKey) return 0;
  return { z: shiftKey ? 1 : -1, y: 1 }[key.toLowerCase()] ?? 0;
}
