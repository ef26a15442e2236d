#!/usr/bin/env python3
"""Draws slots and lanes, beside this script.

usage: models/drawings.py
Written are slots_light.svg for a white page and slots_dark.svg for a black one.
"""
import pathlib
from xml.sax.saxutils import escape

FOLDER = pathlib.Path(__file__).resolve().parent
WIDTH = 960
FONT = "system-ui, -apple-system, 'Segoe UI', Helvetica, Arial, sans-serif"

PALETTES = {
    "light": {
        "text": "#1f2328", "faint": "#59636e", "line": "#59636e", "frame": "#afb8c1", "page": "#ffffff",
        "logic": "#ddf4ff", "memory": "#fff1d6", "bus": "#e6eaef", "mark": "#ffd8b5",
    },
    "dark": {
        "text": "#e6edf3", "faint": "#9aa4af", "line": "#9aa4af", "frame": "#4a535e", "page": "#0d1117",
        "logic": "#12324f", "memory": "#45341a", "bus": "#2b323b", "mark": "#6b3d16",
    },
}


class Drawing:
    def __init__(self, palette, height):
        self.colors = PALETTES[palette]
        self.height = height
        self.items = []

    def add(self, tag, text=None, **attributes):
        words = " ".join(f'{name.replace("_", "-")}="{value}"' for name, value in attributes.items())
        self.items.append(f"<{tag} {words}/>" if text is None else f"<{tag} {words}>{escape(text)}</{tag}>")

    def text(self, x, y, text, size=13, color="text", anchor="middle", weight="normal"):
        self.add("text", text, x=x, y=y, font_size=size, fill=self.colors[color], text_anchor=anchor,
                 font_weight=weight)

    def title(self, x, y, text):
        self.text(x, y, text, 14, anchor="start", weight="bold")

    def note(self, x, y, text, anchor="start", color="faint"):
        self.text(x, y, text, 12, color, anchor)

    def rect(self, x, y, width, height, fill, line="line", radius=4):
        self.add("rect", x=x, y=y, width=width, height=height, rx=radius, stroke=self.colors[line],
                 fill=self.colors[fill])

    def cell(self, x, y, width, height, fill, text="", size=12):
        self.rect(x, y, width, height, fill, "frame", radius=0)
        if text:
            self.text(x + width / 2, y + height / 2 + 4, text, size)

    def box(self, x, y, width, height, lines, fill="logic"):
        """A box with a name, and further lines below it."""
        self.rect(x, y, width, height, fill)
        center = x + width / 2
        top = y + height / 2 - 8 * (len(lines) - 1) + 4.5
        self.text(center, top, lines[0])
        for number, line in enumerate(lines[1:], 1):
            self.note(center, top + 16 * number, line, "middle")

    def arrow(self, *points, both=False):
        tips = {"marker_end": "url(#tip)"}
        if both:
            tips["marker_start"] = "url(#tip)"
        self.add("path", d="M" + " L".join(f"{x} {y}" for x, y in points), fill="none",
                 stroke=self.colors["line"], stroke_width=1.5, **tips)

    def save(self, path):
        path.write_text("\n".join([
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {self.height}"',
            f' width="{WIDTH}" height="{self.height}" font-family="{FONT}">',
            '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="6" markerHeight="6"',
            f' orient="auto-start-reverse"><path d="M0 0 L8 4 L0 8 z" fill="{self.colors["line"]}"/>',
            "</marker></defs>", *self.items, "</svg>"]) + "\n")


def draw_strip(d):
    d.title(20, 28, "1. A strip, its columns and slots (here n = 3)")
    left, top, side, columns, rows, strip = 96, 48, 22, 14, 7, range(2, 5)
    for row in range(rows):
        for column in range(columns):
            fill = "page" if row not in strip else "mark" if column == 4 else "logic"
            slot = str(3 * column + row - 1) if row in strip and column < 4 else ""
            d.cell(left + side * column, top + side * row, side, side, fill, slot, 11)
    d.note(left - 8, top + side * 3.5 - 6, "strip:", "end", "text")
    d.note(left - 8, top + side * 3.5 + 10, "n rows", "end", "text")
    marked = left + side * 4.5
    d.arrow((marked, top + side * rows + 8), (marked, top + side * 5 + 2))
    d.note(marked, top + side * rows + 18, "column: n slots, in the order 1, 2, 3, ..", color="text")
    d.note(left, top + side * rows + 38, "The next strip begins one row further down.")


def draw_lane(d):
    d.title(500, 28, "2. A lane (left, right)")
    d.box(500, 66, 88, 40, ["LUT port", "takes"])
    d.box(664, 66, 88, 40, ["pixel port", "handles"])
    d.box(830, 66, 100, 40, ["matcher", "consumes"])
    d.note(880, 126, "one slot of both", "middle")
    d.note(880, 142, "lanes in a cycle", "middle")
    for x, bank in ((500, "table bank"), (664, "picture bank")):
        d.box(x, 142, 88, 34, [bank], "memory")
        d.arrow((x + 44, 142), (x + 44, 108))
    for x, slots in ((592, (12, 11, 10)), (756, (9, 8, 7))):
        for place, slot in enumerate(slots):
            d.cell(x + 22 * place, 75, 22, 22, "mark", str(slot), 11)
    d.arrow((500, 200), (824, 200), both=True)
    d.note(662, 218, "slots in the lane: at most lane_fifo_slots (16)", "middle", "text")
    d.note(500, 244, "A word read is usable read_latency cycles after its grant.")


def draw_frame(d):
    d.title(20, 292, "3. The matcher consumes the columns of all strips, then the drain")
    for x, width, name, fill in (
            (20, 110, "if h > r", "bus"), (130, 220, "strip of row 0", "logic"),
            (350, 220, "strip of row 1", "logic"), (570, 60, "..", "logic"),
            (630, 180, "strip of row H-1", "logic"), (810, 120, "drain", "mark")):
        d.cell(x, 308, width, 30, fill, name)
    d.note(20, 356, "lead strips, before the first row of results")
    d.note(930, 356, "C_d = D - 1 + r + h columns, without slots", "end")
    for x, width, name in ((250, 220, "results of row 0"), (470, 220, "results of row 1"), (690, 60, ".."),
                           (750, 180, "results of row H-1")):
        d.cell(x, 380, width, 30, "memory", name)
    d.arrow((130, 395), (250, 395), both=True)
    d.note(124, 399, "C_d columns", "end", "text")
    d.note(20, 434, "The result of column u of a strip leaves C_d columns after column u of that strip.")


def draw_group(d):
    d.title(20, 480, "4. Four columns are a group; they give one result word")
    for column in range(8):
        for k in range(3):
            d.cell(40 + 22 * column, 498 + 22 * k, 22, 22, "mark" if 2 <= column < 6 else "logic")
    d.note(128, 584, "group", "middle", "text")
    d.arrow((222, 531), (270, 531))
    d.box(270, 505, 120, 52, ["matching", "SAD .. L-R check"])
    d.arrow((390, 531), (430, 531))
    for place in range(4):
        d.cell(430 + 40 * place, 516, 40, 30, "memory", f"d{3 - place}", 13)
    d.note(510, 566, "result word, 32 bit:", "middle", "text")
    d.note(510, 582, "lowest column in the lowest byte", "middle", "text")
    d.arrow((590, 531), (630, 531))
    for place in range(4):
        d.cell(630 + 24 * place, 516, 24, 30, "memory" if place > 1 else "page")
    d.note(678, 566, "result queue:", "middle", "text")
    d.note(678, 582, "result_fifo_words (8)", "middle", "text")
    d.arrow((726, 531), (760, 531))
    d.box(760, 512, 80, 38, ["result port"])
    d.arrow((840, 531), (866, 531))
    d.box(866, 512, 74, 38, ["bank"], "memory")
    d.note(20, 620, "If the queue is full, the matcher waits; the lanes fill, and the LUT ports are blocked.")


def draw_slots(palette):
    d = Drawing(palette, 640)
    for draw in (draw_strip, draw_lane, draw_frame, draw_group):
        draw(d)
    return d


def main():
    for palette in PALETTES:
        draw_slots(palette).save(FOLDER / f"slots_{palette}.svg")


main()
