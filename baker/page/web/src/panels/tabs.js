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
