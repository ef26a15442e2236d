"""The data inside a page of `report`."""

import base64
import json
import re
import struct

LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"
DATA = re.compile(r'(<script type="application/json" id="data">)(.*?)(</script>)', re.DOTALL)


def data_of(path):
    """The data of a page."""
    return json.loads(DATA.search(path.read_text()).group(2))


def with_data(path, data, out):
    """Writes the page `out`: the page at `path` with other data."""
    text = json.dumps(data).replace("<", "\\u003c")
    out.write_text(DATA.sub(lambda match: match[1] + text + match[3], path.read_text()))
    return out


def unpacked(column, rows):
    """The values of a column in one of the forms that sw/report/page/README.md describes."""
    if "constant" in column:
        return [column["constant"]] * rows
    if "float64" in column:
        return list(struct.unpack(f"<{rows}d", base64.b64decode(column["float64"])))
    letters = len(column["codes"]) // rows
    values = []
    for row in range(rows):
        code = 0
        for letter in column["codes"][letters * row : letters * (row + 1)]:
            code = 64 * code + LETTERS.index(letter)
        values.append(column["values"][code])
    return values
