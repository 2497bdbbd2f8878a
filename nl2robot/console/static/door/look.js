// As /static/look.js, on pages that hand no data over: the look that this browser has chosen.
(() => {
  const chosen = /(?:^|; )look=(light|dark)/.exec(document.cookie)?.[1];
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const show = () => {
    document.documentElement.dataset.look = chosen ?? (dark.matches ? 'dark' : 'light');
  };
  dark.addEventListener('change', show);
  show();
})();
