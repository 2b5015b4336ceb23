// Before the page's own script: keeps its errors, and gives frames that come as timers do and whose clock lags behind that of the keys, as on a busy machine.
"use strict";
window.seen_errors = [];
for (const kind of ["error", "unhandledrejection", "securitypolicyviolation"]) {
  window.addEventListener(kind, e => window.seen_errors.push(kind + " " + (e.message || e.violatedDirective || e.reason)));
}
window.requestAnimationFrame = draw => setTimeout(() => draw(performance.now() - 100), 16);
