#!/usr/bin/python3
"""All figures of a sweep that apply to it."""

import command
import plot_banks
import plot_disparities
import plot_pareto
import plot_rows
import plot_stalls
import plot_states
import plot_units
import plot_use
import plot_window

if __name__ == "__main__":
    command.main(__doc__, {
        "window": plot_window.draw,
        "disparities": plot_disparities.draw,
        "rows": plot_rows.draw,
        "units": plot_units.draw,
        "banks": plot_banks.draw,
        "states": plot_states.draw,
        "stalls": plot_stalls.draw,
        "use": plot_use.draw,
        "pareto": plot_pareto.draw,
    }, plot_pareto.check)
