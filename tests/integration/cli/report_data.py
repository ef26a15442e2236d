"""The data inside a page of `report`: JSON, compressed by zlib, in base64."""

import base64
import json
import re
import zlib

DATA = re.compile(r'(<script type="text/plain" id="data">)(.*?)(</script>)')


def data_of(path):
    """The data of a page."""
    return json.loads(zlib.decompress(base64.b64decode(DATA.search(path.read_text()).group(2))))


def with_data(path, data, out):
    """Writes the page `out`: the page at `path` with other data."""
    text = base64.b64encode(zlib.compress(json.dumps(data).encode())).decode()
    out.write_text(DATA.sub(lambda match: match[1] + text + match[3], path.read_text()))
    return out
