// The user's choices, and listeners that are called when they change.
export function createStore(state) {
  const listeners = [];
  return {
    state,
    // Calls `listener(state)` now and whenever one of `keys` changes.
    watch(keys, listener) {
      listeners.push({ keys, listener });
      listener(state);
    },
    set(patch) {
      const changed = Object.keys(patch).filter((key) => !Object.is(state[key], patch[key]));
      Object.assign(state, patch);
      for (const { keys, listener } of listeners) {
        if (keys.some((key) => changed.includes(key))) listener(state);
      }
    },
    // Sets are replaced, not changed: a watcher sees a new value.
    toggle(key, item) {
      const next = new Set(state[key]);
      if (!next.delete(item)) next.add(item);
      this.set({ [key]: next });
    },
    // Spheres lie in the skin, which is see-through while they are shown.
    showSpheres(shown) {
      this.set({ spheres: shown, skinOpacity: shown ? 0.35 : 1 });
    },
    // Without the method nothing of it stays.
    showMethod(shown) {
      const rest = { patches: false, regions: false, pivots: false, numbers: false, sets: new Set(), pinned: null, pointed: null, alarm: null };
      this.set(shown ? { method: true } : { method: false, ...rest });
    },
  };
}
