// Accessibility. A table that scrolls sideways can be reached and scrolled by the keyboard.
document.addEventListener("DOMContentLoaded", () => {
  const boxes = ".pst-scrollable-table-container, .output.text_html";
  for (const box of document.querySelectorAll(boxes)) {
    if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
  }
  // The theme gives these buttons a sign and no name.
  for (const button of document.querySelectorAll("nav summary")) {
    button.setAttribute("aria-label", "Show or hide the pages below");
  }
});
