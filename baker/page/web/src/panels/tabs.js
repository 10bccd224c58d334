import { h } from '../base/dom.js';

// The results' tabs. Tabs of the paper's method are shown only while the method is.
export function bindTabs(store) {
  const tabs = [...document.querySelectorAll('[role=tab]')];
  const choose = (tab) => {
    for (const other of tabs) {
      other.setAttribute('aria-selected', other === tab);
      other.tabIndex = other === tab ? 0 : -1;
      document.getElementById(other.getAttribute('aria-controls')).hidden = other !== tab;
    }
  };
  tabs.forEach((tab) => {
    tab.addEventListener('click', () => choose(tab));
    tab.addEventListener('keydown', (event) => {
      const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!by) return;
      event.stopPropagation();
      const shown = tabs.filter((other) => other.offsetParent !== null);
      const next = shown[(shown.indexOf(tab) + by + shown.length) % shown.length];
      choose(next);
      next.focus();
    });
  });
  store.watch(['method'], ({ method }) => {
    document.body.classList.toggle('with-method', method);
    const current = tabs.find((tab) => tab.getAttribute('aria-selected') === 'true');
    if (!method && current.classList.contains('method')) choose(tabs[0]);
  });
}

// Puts a tab before all others, which shows a clip's events or the like.
export function addTab(name) {
  const tabs = document.querySelector('[role=tablist]');
  const tab = h('button', { type: 'button', role: 'tab', id: 'tab-events', 'aria-controls': 'events', 'aria-selected': 'true' }, name);
  const panel = h('div', { role: 'tabpanel', id: 'events', 'aria-labelledby': 'tab-events' });
  for (const other of tabs.children) Object.assign(other, { tabIndex: -1 }).setAttribute('aria-selected', false);
  tabs.prepend(tab);
  tabs.after(panel);
  document.getElementById('contacts').hidden = true;
  document.getElementById('tab-contacts').textContent = 'This frame';
  return panel;
}
