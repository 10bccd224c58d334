// SPDX-License-Identifier: MIT
// Turns an arm of the automatic rig about its shoulder. `palette`: 16 floats for each of the model's bones, by columns.
export function armDown(model, palette, side, degrees) {
  const bone = name => model.bones.findIndex(other => other.name === name);
  const m = model.bones[bone(`${side}_shoulder`)].inverseBind;
  const x = -(m[0] * m[12] + m[1] * m[13] + m[2] * m[14]);  // where the shoulder is
  const y = -(m[4] * m[12] + m[5] * m[13] + m[6] * m[14]);
  const angle = ((side === 'left' ? -1 : 1) * degrees * Math.PI) / 180, c = Math.cos(angle), s = Math.sin(angle);
  const turn = [c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, x - c * x + s * y, y - s * x - c * y, 0, 1];
  for (const joint of ['shoulder', 'elbow', 'wrist']) palette.set(turn, 16 * bone(`${side}_${joint}`));
}
