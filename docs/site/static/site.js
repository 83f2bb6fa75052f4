// The button for light and dark, where the theme's own script did not run (it takes the class no-js away).
document.addEventListener('DOMContentLoaded', () => {
  const page = document.documentElement;
  if (!page.classList.contains('no-js')) return;
  page.classList.remove('no-js');
  const themes = ['auto', 'light', 'dark'];
  for (const button of document.querySelectorAll('.theme-toggle')) {
    button.addEventListener('click', () => {
      const next = themes[(themes.indexOf(document.body.dataset.theme) + 1) % themes.length];
      document.body.dataset.theme = next;
      localStorage.setItem('theme', next);
    });
  }
});
