#!/usr/bin/env python3
"""Draws the block diagram of the machine (beside this script) and the drawing of slots and lanes (in models).

usage: platform/drawings.py
Each is written twice: NAME_light.svg for a white page, NAME_dark.svg for a black one.
"""
import pathlib
from xml.sax.saxutils import escape

ROOT = pathlib.Path(__file__).resolve().parent.parent
WIDTH = 960
FONT = "system-ui, -apple-system, 'Segoe UI', Helvetica, Arial, sans-serif"

PALETTES = {
    "light": {"text": "#1f2328", "faint": "#59636e", "line": "#59636e", "frame": "#afb8c1", "logic": "#ddf4ff",
              "memory": "#fff1d6", "bus": "#e6eaef", "host": "#dafbe1", "mark": "#ffd8b5", "page": "#ffffff"},
    "dark": {"text": "#e6edf3", "faint": "#9aa4af", "line": "#9aa4af", "frame": "#4a535e", "logic": "#12324f",
             "memory": "#45341a", "bus": "#2b323b", "host": "#173d24", "mark": "#6b3d16", "page": "#0d1117"},
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

    def rect(self, x, y, width, height, fill, line="line", dashes="none", radius=4):
        self.add("rect", x=x, y=y, width=width, height=height, rx=radius, stroke=self.colors[line],
                 fill="none" if fill is None else self.colors[fill], stroke_dasharray=dashes)

    def frame(self, x, y, width, height, title):
        self.rect(x, y, width, height, None, "frame", radius=8)
        self.text(x + width - 12, y + 20, title, 14, anchor="end", weight="bold")

    def box(self, x, y, width, height, lines, fill="logic", cards=1, dashes="none"):
        """A box with a name, and further lines below it. Two cards: one of each side."""
        for card in reversed(range(cards)):
            self.rect(x + 5 * card, y - 5 * card, width, height, fill, dashes=dashes)
        top = y + height / 2 - 8 * (len(lines) - 1) + 4.5
        for number, line in enumerate(lines):
            self.text(x + width / 2, top + 16 * number, line, 12 if number else 13, "faint" if number else "text")

    def arrow(self, *points, both=False, ends=True):
        path = "M" + " L".join(f"{x} {y}" for x, y in points)
        attributes = {"marker_end": "url(#tip)"} if ends else {}
        if both:
            attributes["marker_start"] = "url(#tip)"
        self.add("path", d=path, fill="none", stroke=self.colors["line"], stroke_width=1.5, **attributes)

    def save(self, path):
        tip = (f'<marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="6" markerHeight="6" '
               f'orient="auto-start-reverse"><path d="M0 0 L8 4 L0 8 z" fill="{self.colors["line"]}"/></marker>')
        lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {self.height}" width="{WIDTH}" '
                 f'height="{self.height}" font-family="{FONT}">', f"<defs>{tip}</defs>", *self.items, "</svg>"]
        path.write_text("\n".join(lines) + "\n")


def draw_machine(palette):
    """The preset fpl2003."""
    d = Drawing(palette, 756)

    for side, x in (("left", 20), ("right", 190)):
        d.box(x, 16, 150, 44, [f"{side} camera", "640x480, 29.97 Hz"], "host")
        d.arrow((x + 75, 60), (x + 75, 84))
        d.box(x, 84, 150, 52, [f"{side} PXC200", "FIFO: 140 words"])
        d.arrow((x + 75, 136), (x + 75, 166))
    d.frame(380, 16, 560, 124, "host PC")
    d.box(400, 56, 150, 56, ["host memory", "tables, results"], "memory")
    d.arrow((550, 84), (586, 84), both=True)
    d.box(586, 56, 150, 56, ["CPU", "runs the driver"], "host")
    d.arrow((736, 84), (772, 84), both=True)
    d.box(772, 56, 150, 56, ["host bridge"])
    for x in (475, 847):
        d.arrow((x, 112), (x, 166), both=True)
    d.rect(20, 166, 920, 26, "bus")
    d.text(480, 184, "PCI bus: 32 bit, 33.333 MHz, 133 MB/s")

    d.frame(20, 222, 920, 524, "ADM-XRC-II board")
    d.arrow((165, 192), (165, 242), both=True)
    d.box(40, 242, 250, 54, ["PCI bridge (PLX 9656 class)", "64 posted words, 2 DMA channels"])
    d.arrow((116, 296), (116, 440), both=True)
    d.text(128, 318, "local bus: 32 bit, 40 MHz, 160 MB/s", 12, "faint", "start")

    d.frame(40, 330, 880, 276, "XC2V6000 FPGA: 40 MHz")
    d.box(56, 440, 124, 62, ["local bus port,", "registers,", "start and done"])
    d.box(196, 372, 94, 34, ["sequencer"])
    d.arrow((180, 456), (200, 456), (200, 406))
    d.arrow((256, 406), (256, 433))
    stages = [(210, ["LUT reader", "1 entry/cycle"]), (330, ["pixel reader", "1 pixel/cycle"]),
              (450, ["LoG filter", "7x7 kernel"]), (570, ["row buffer", "if line_buffer"])]
    for x, lines in stages:
        d.box(x, 438, 94, 50, lines, cards=2, dashes="4 3" if x == 570 else "none")
        d.arrow((x + 99, 460), (x + 119, 460))
    d.text(510, 420, "left and right: two of each", 12, "faint")
    d.box(690, 420, 94, 80, ["SAD array", "80 window", "modules"])
    d.arrow((784, 436), (800, 436), (800, 398), (812, 398))
    d.arrow((784, 460), (812, 460))
    d.box(812, 374, 96, 44, ["chain A", "select-min"])
    d.box(812, 438, 96, 44, ["tree B", "select-min"])
    d.arrow((908, 396), (914, 396), (914, 522), (908, 522))
    d.arrow((860, 482), (860, 506))
    d.box(812, 506, 96, 32, ["L-R check"])
    d.arrow((812, 522), (784, 522))
    d.box(690, 506, 94, 32, ["result packer"])
    d.arrow((690, 522), (664, 522))
    d.box(570, 506, 94, 32, ["result writer"])

    d.rect(56, 560, 848, 36, "bus")
    d.text(66, 582, "crossbar", anchor="start")
    for x, port, both in ((116, "host", True), (256, "left_lut, right_lut", False),
                          (376, "left_pixel, right_pixel", False), (617, "result", None)):
        bottom = (x, 558)
        if both is None:
            d.arrow((x, 538), bottom)
        elif both:
            d.arrow((x, 502), bottom, both=True)
        else:
            d.arrow(bottom, (x, 488))
        d.text(x + 8, 552, port, 12, "faint", "start")
    contents = ["left picture", "left picture", "right picture", "right picture", "disparities", "disparities",
                "left table", "right table"]
    for bank, content in enumerate(contents):
        x = 130 + 97 * bank
        d.box(x, 566, 86, 24, ["arbiter"])
        d.arrow((x + 43, 596), (x + 43, 630), both=True)
        d.box(x, 630, 86, 52, [f"bank{bank}", "512K x 32"], "memory")
        d.text(x + 43, 700, content, 12, "faint")
    d.text(76, 652, "ZBT SSRAM,", 12, "faint")
    d.text(76, 668, "40 MHz", 12, "faint")
    d.text(480, 730, "Each bank serves one word a cycle: 160 MB/s. Of two ports that request it, one stalls.", 13)
    return d


def draw_slots(palette):
    d = Drawing(palette, 640)
    cell = 22

    # The image.
    d.text(20, 28, "1. A strip, its columns and slots (here n = 3)", 14, anchor="start", weight="bold")
    left, top, columns, rows = 96, 48, 14, 7
    strip = range(2, 5)
    order = {(column, row): 3 * column + row - 1 for column in range(4) for row in strip}
    for row in range(rows):
        for column in range(columns):
            marked = column == 4 and row in strip
            fill = "mark" if marked else "logic" if row in strip else "page"
            d.rect(left + cell * column, top + cell * row, cell, cell, fill, "frame", radius=0)
            if (column, row) in order:
                d.text(left + cell * (column + 0.5), top + cell * row + 15, str(order[column, row]), 11)
    middle = top + cell * 3.5
    d.text(left - 8, middle - 6, "strip:", 12, anchor="end")
    d.text(left - 8, middle + 10, "n rows", 12, anchor="end")
    d.text(left + cell * 4.5, top + cell * rows + 18, "column: n slots, in the order 1, 2, 3, ..", 12, anchor="start")
    d.arrow((left + cell * 4.5, top + cell * rows + 8), (left + cell * 4.5, top + cell * 5 + 2))
    d.text(left, top + cell * rows + 38, "The next strip begins one row further down.", 12, "faint", "start")

    # The lane.
    d.text(500, 28, "2. A lane (left, right)", 14, anchor="start", weight="bold")
    d.box(500, 66, 88, 40, ["LUT port", "takes"])
    d.box(664, 66, 88, 40, ["pixel port", "handles"])
    d.box(830, 66, 100, 40, ["matcher", "consumes"])
    d.text(880, 126, "one slot of both", 12, "faint")
    d.text(880, 142, "lanes in a cycle", 12, "faint")
    d.arrow((544, 142), (544, 108))
    d.arrow((708, 142), (708, 108))
    d.box(500, 142, 88, 34, ["table bank"], "memory")
    d.box(664, 142, 88, 34, ["picture bank"], "memory")
    for x, numbers in ((592, (12, 11, 10)), (756, (9, 8, 7))):
        for place, number in enumerate(numbers):
            d.rect(x + cell * place, 75, cell, cell, "mark", "frame", radius=0)
            d.text(x + cell * (place + 0.5), 90, str(number), 11)
    d.arrow((500, 200), (824, 200), both=True)
    d.text(662, 218, "slots in the lane: at most lane_fifo_slots (16)", 12)
    d.text(500, 244, "A word read is usable read_latency cycles after its grant.", 12, "faint", "start")

    # The frame.
    d.text(20, 292, "3. The matcher consumes the columns of all strips, then the drain", 14, anchor="start", weight="bold")
    parts = [(20, 110, "if h > r", "bus"), (130, 220, "strip of row 0", "logic"), (350, 220, "strip of row 1", "logic"),
             (570, 60, "..", "logic"), (630, 180, "strip of row H-1", "logic"), (810, 120, "drain", "mark")]
    for x, width, name, fill in parts:
        d.rect(x, 308, width, 30, fill, "frame", radius=0)
        d.text(x + width / 2, 328, name, 12)
    d.text(20, 356, "lead strips, before the first row of results", 12, "faint", "start")
    d.text(930, 356, "C_d = D - 1 + r + h columns, without slots", 12, "faint", "end")
    results = [(250, 220, "results of row 0"), (470, 220, "results of row 1"), (690, 60, ".."), (750, 180, "results of row H-1")]
    for x, width, name in results:
        d.rect(x, 380, width, 30, "memory", "frame", radius=0)
        d.text(x + width / 2, 400, name, 12)
    d.arrow((130, 395), (250, 395), both=True)
    d.text(124, 399, "C_d columns", 12, anchor="end")
    d.text(20, 434, "The result of column u of a strip leaves C_d columns after column u of that strip.", 12, "faint", "start")

    # The group.
    d.text(20, 480, "4. Four columns are a group; they give one result word", 14, anchor="start", weight="bold")
    for column in range(8):
        fill = "mark" if 2 <= column < 6 else "logic"
        for k in range(3):
            d.rect(40 + cell * column, 498 + cell * k, cell, cell, fill, "frame", radius=0)
    d.text(40 + cell * 4, 584, "group", 12)
    d.arrow((222, 531), (270, 531))
    d.box(270, 505, 120, 52, ["SAD, select-min,", "L-R check"])
    d.arrow((390, 531), (430, 531))
    for place in range(4):
        d.rect(430 + 40 * place, 516, 40, 30, "memory", radius=0)
        d.text(450 + 40 * place, 536, f"d{3 - place}", 13)
    d.text(510, 566, "result word, 32 bit:", 12)
    d.text(510, 582, "lowest column in the lowest byte", 12)
    d.arrow((590, 531), (630, 531))
    for place in range(4):
        d.rect(630 + 24 * place, 516, 24, 30, "memory" if place > 1 else "page", radius=0)
    d.text(678, 566, "result queue:", 12)
    d.text(678, 582, "result_fifo_words (8)", 12)
    d.arrow((726, 531), (760, 531))
    d.box(760, 512, 80, 38, ["result port"])
    d.arrow((840, 531), (866, 531))
    d.box(866, 512, 74, 38, ["bank"], "memory")
    d.text(20, 620, "If the queue is full, the matcher waits; then the lanes fill up, and the LUT ports are blocked.", 12, "faint", "start")
    return d


def main():
    for palette in PALETTES:
        draw_machine(palette).save(ROOT / f"platform/machine_{palette}.svg")
        draw_slots(palette).save(ROOT / f"models/slots_{palette}.svg")


main()
