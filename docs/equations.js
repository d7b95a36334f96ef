// Draws the blocks of code that are marked `math`, once KaTeX is there; without it they stay as text.
window.addEventListener("load", () => {
  if (typeof katex === "undefined") return;
  for (const code of document.querySelectorAll("code.language-math")) {
    const drawn = document.createElement("div");
    try {
      katex.render(code.textContent, drawn, { displayMode: true });
    } catch (error) {
      console.warn(error.message);
      continue;
    }
    code.parentElement.replaceWith(drawn);
  }
});
