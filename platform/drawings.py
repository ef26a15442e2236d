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
    "light": {
        "text": "#1f2328", "faint": "#59636e", "line": "#59636e", "frame": "#afb8c1", "page": "#ffffff",
        "logic": "#ddf4ff", "memory": "#fff1d6", "bus": "#e6eaef", "host": "#dafbe1", "mark": "#ffd8b5",
    },
    "dark": {
        "text": "#e6edf3", "faint": "#9aa4af", "line": "#9aa4af", "frame": "#4a535e", "page": "#0d1117",
        "logic": "#12324f", "memory": "#45341a", "bus": "#2b323b", "host": "#173d24", "mark": "#6b3d16",
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

    def rect(self, x, y, width, height, fill, line="line", dashes="none", radius=4):
        self.add("rect", x=x, y=y, width=width, height=height, rx=radius, stroke=self.colors[line],
                 fill="none" if fill is None else self.colors[fill], stroke_dasharray=dashes)

    def cell(self, x, y, width, height, fill, text="", size=12):
        self.rect(x, y, width, height, fill, "frame", radius=0)
        if text:
            self.text(x + width / 2, y + height / 2 + 4, text, size)

    def frame(self, x, y, width, height, title):
        self.rect(x, y, width, height, None, "frame", radius=8)
        self.text(x + width - 12, y + 20, title, 14, anchor="end", weight="bold")

    def box(self, x, y, width, height, lines, fill="logic", cards=1, dashes="none"):
        """A box with a name, and further lines below it. Two cards: one of each side."""
        for card in reversed(range(cards)):
            self.rect(x + 5 * card, y - 5 * card, width, height, fill, dashes=dashes)
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
    d.note(128, 318, "local bus: 32 bit, 40 MHz, 160 MB/s")

    d.frame(40, 330, 880, 276, "XC2V6000 FPGA: 40 MHz")
    d.box(56, 440, 124, 62, ["local bus port,", "registers,", "start and done"])
    d.arrow((180, 456), (200, 456), (200, 406))
    d.box(196, 372, 94, 34, ["sequencer"])
    d.arrow((256, 406), (256, 433))
    stages = [(210, ["LUT reader", "1 entry/cycle"]), (330, ["pixel reader", "1 pixel/cycle"]),
              (450, ["LoG filter", "7x7 kernel"]), (570, ["row buffer", "if line_buffer"])]
    for x, lines in stages:
        d.box(x, 438, 94, 50, lines, cards=2, dashes="4 3" if x == 570 else "none")
        d.arrow((x + 99, 460), (x + 119, 460))
    d.note(510, 420, "left and right: two of each", "middle")
    d.box(690, 420, 94, 80, ["SAD array", "80 window", "modules"])
    d.arrow((784, 436), (800, 436), (800, 398), (812, 398))
    d.arrow((784, 460), (812, 460))
    d.box(812, 374, 96, 44, ["chain A", "select-min"])
    d.box(812, 438, 96, 44, ["tree B", "select-min"])
    d.arrow((908, 396), (914, 396), (914, 522), (908, 522))
    d.arrow((860, 482), (860, 506))
    d.box(812, 506, 96, 32, ["L-R check"])
    d.arrow((812, 522), (788, 522))
    d.box(686, 506, 102, 32, ["result packer"])
    d.arrow((686, 522), (668, 522))
    d.box(566, 506, 102, 32, ["result writer"])

    d.rect(56, 560, 848, 36, "bus")
    d.text(66, 582, "crossbar", anchor="start")
    d.arrow((116, 502), (116, 558), both=True)
    d.note(124, 552, "host")
    d.arrow((256, 558), (256, 488))
    d.note(264, 552, "left_lut, right_lut")
    d.arrow((376, 558), (376, 488))
    d.note(384, 552, "left_pixel, right_pixel")
    d.arrow((617, 538), (617, 558))
    d.note(625, 552, "result")
    contents = [*["left picture"] * 2, *["right picture"] * 2, *["disparities"] * 2, "left table",
                "right table"]
    for bank, content in enumerate(contents):
        x = 130 + 97 * bank
        d.box(x, 566, 86, 24, ["arbiter"])
        d.arrow((x + 43, 596), (x + 43, 630), both=True)
        d.box(x, 630, 86, 52, [f"bank{bank}", "512K x 32"], "memory")
        d.note(x + 43, 700, content, "middle")
    d.note(76, 652, "ZBT SSRAM,", "middle")
    d.note(76, 668, "40 MHz", "middle")
    d.text(480, 730, "Each bank serves one word a cycle: 160 MB/s. Of two ports that request it, one stalls.")
    return d


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
        draw_machine(palette).save(ROOT / f"platform/machine_{palette}.svg")
        draw_slots(palette).save(ROOT / f"models/slots_{palette}.svg")


main()
