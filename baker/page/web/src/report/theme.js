// Light or dark, as the system has it until the user says otherwise.
export function followTheme(button, changed = () => {}) {
  const root = document.documentElement;
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const set = (theme) => {
    root.dataset.theme = theme;
    changed();
  };
  const toggle = () => set(root.dataset.theme === 'dark' ? 'light' : 'dark');
  button.addEventListener('click', toggle);
  dark.addEventListener('change', () => set(dark.matches ? 'dark' : 'light'));
  set(dark.matches ? 'dark' : 'light');
  return toggle;
}
