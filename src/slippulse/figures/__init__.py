"""One module a figure: ``table(data, measured, settings)`` collects what is drawn, ``plot(table)`` draws it."""
