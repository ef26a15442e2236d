"""The figures of a sweep."""

import command  # first: it says what is wrong if matplotlib is missing
import bars
import lines
import pareto
from points import BANKS_USED, UNITS_USED, Unusable


def of_key(key, what, **looks):
    """A figure of rates over a key of the board."""
    heading = f"Frame rate{' and area' if looks else ''} against {what}"
    return lambda points, options: lines.of_key(points, options, key, heading, **looks)


def banks(points, options):
    if not points.varies(BANKS_USED):
        raise Unusable(f"all points use {points.column(BANKS_USED)[0]} banks")
    allocation = [key for key in points.varied if key.startswith("allocation.")]
    heading = "Frame rate against the banks that the allocation uses"
    return lines.draw(points, options, heading, BANKS_USED, allocation, lines.rate_panels(points), best=True)


# In the order of drawing.
FIGURES = {
    "window": of_key("matcher.window", "the size of the window"),
    "disparities": of_key("matcher.disparities", "the disparities", with_area=True),
    "rows": of_key("matcher.rows", "the rows of results at once", with_area=True),
    "units": of_key("matcher.units", "the number of modules", with_area=True, x=UNITS_USED),
    "banks": banks,
    "states": bars.states,
    "stalls": bars.stalls,
    "use": bars.use,
    "pareto": pareto.draw,
}


def main(description, *names):
    """Runs a script that draws these figures, by default all. description: for --help."""
    chosen = {name: FIGURES[name] for name in names or FIGURES}
    command.main(description, chosen, pareto.check if "pareto" in chosen else None)
