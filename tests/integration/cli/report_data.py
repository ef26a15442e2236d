"""The data inside a page of `report`."""

import json
import re

DATA = re.compile(r'(<script type="application/json" id="data">)(.*?)(</script>)', re.DOTALL)


def data_of(path):
    """The data of a page."""
    return json.loads(DATA.search(path.read_text()).group(2))


def with_data(path, data, out):
    """Writes the page `out`: the page at `path` with other data."""
    text = json.dumps(data).replace("<", "\\u003c")
    out.write_text(DATA.sub(lambda match: match[1] + text + match[3], path.read_text()))
    return out
