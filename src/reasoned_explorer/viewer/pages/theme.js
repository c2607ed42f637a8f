// Runs before the page is drawn, so that a chosen light or dark does not flash the other one first.
(() => {
  try {
    const theme = localStorage.getItem("rex-theme");
    if (theme === "light" || theme === "dark") document.documentElement.dataset.theme = theme;
  } catch { /* no storage: the system's choice holds */ }
})();
