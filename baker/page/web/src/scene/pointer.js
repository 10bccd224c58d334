// Which sphere the pointer is at; a click keeps it. Skin is seen through.

// The nearest of `ids` that a ray meets, or null.
function pick(ray, ids, sphereOf) {
  let best = null;
  let nearest = Infinity;
  for (const id of ids) {
    const [x, y, z, r] = sphereOf(id);
    const { origin: o, direction: d } = ray;
    const length = d.length();
    const along = ((x - o.x) * d.x + (y - o.y) * d.y + (z - o.z) * d.z) / length;
    const away = (x - o.x) ** 2 + (y - o.y) ** 2 + (z - o.z) ** 2 - along * along;
    const reach = along - Math.sqrt(Math.max(r * r - away, 0));
    if (away < r * r && along > 0 && reach < nearest) {
      nearest = reach;
      best = id;
    }
  }
  return best;
}

export function followPointer(canvas, store, model, stage, visible) {
  let last = null; // where the pointer is, null while it is elsewhere or drags
  let pressed = null;
  const under = ({ clientX, clientY }) => {
    const { frame, radius } = store.state;
    return pick(stage.ray(clientX, clientY), visible, (id) => model.sphere(frame, id, radius));
  };
  const point = () => store.set({ pointed: (last && under(last)) ?? store.state.pinned });

  canvas.addEventListener('pointermove', (event) => {
    if (event.buttons !== 0 || event.pointerType === 'touch') return;
    last = event;
    point();
  });
  canvas.addEventListener('pointerleave', () => {
    last = null;
    point();
  });
  canvas.addEventListener('pointerdown', (event) => (pressed = event));
  canvas.addEventListener('pointerup', (event) => {
    const still = pressed && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) < 5;
    pressed = null;
    if (!still || event.button !== 0) return;
    const id = under(event);
    store.set({ pinned: id, pointed: id });
  });
  store.watch(['frame', 'spheres', 'sets', 'radius'], () => last && point());
}
