// Before the first paint: light or dark, as chosen or as the system has it.
(() => {
  const {look, language} = JSON.parse(document.getElementById('frame-data').textContent);
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const show = () => {
    const chosen = look === 'auto' ? (dark.matches ? 'dark' : 'light') : look;
    document.documentElement.dataset.look = chosen;
  };
  document.documentElement.lang = language;
  dark.addEventListener('change', show);
  show();
})();
