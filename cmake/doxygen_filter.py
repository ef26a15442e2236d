#!/usr/bin/python3
"""Doxygen's input filter: the comments of a header in the form that Doxygen reads.

usage: doxygen_filter.py HEADER
A comment above declarations describes all of them up to the next blank line, comment line, access specifier
or line that begins with `}`. A comment behind a declaration, or behind the `{` of its body, describes that
one, without the comment above unless it is the first. A comment above a namespace describes the file.
Comments in functions stay as they are. Each line keeps its number.
"""
import re
import sys

SCOPE = re.compile(r"\s*(template\b.*>\s*)?(class|struct|enum|union|namespace)\b[^()=;]*\{$")
ENUMERATOR = re.compile(r"\s*k[A-Z]\w*( = [^;]*)?,?$")

# What TLM-2.0 and C++ define, and what therefore has no comment in the headers.
KNOWN = {
    "b_transport": "Blocking transport of TLM-2.0.",
    "nb_transport_fw": "Non-blocking transport of TLM-2.0, from the initiator to the target.",
    "nb_transport_bw": "Non-blocking transport of TLM-2.0, from the target to the initiator.",
    "transport_dbg": "Debug transport of TLM-2.0.",
    "get_direct_mem_ptr": "Request of TLM-2.0 for a direct memory interface.",
    "invalidate_direct_mem_ptr": "Withdrawal of direct memory interfaces of TLM-2.0.",
    "operator==": "Whether all values are equal.",
    "operator!=": "Whether a value differs.",
}


def last_line(lines, begin):
    """The last line of a declaration with its body, or the one that opens its scope; and whether it does."""
    code, depth = "", 0
    for at in range(begin, len(lines)):
        code += lines[at].split("//")[0].rstrip()
        if SCOPE.match(code):
            return at, True
        depth = sum(code.count(sign) for sign in "({") - sum(code.count(sign) for sign in ")}")
        ends = ";" if re.match(r"[^(]* =", code) else ";}"
        if depth == 0 and (code.endswith(tuple(ends)) or ENUMERATOR.match(code)):
            break
    return at, False


def describe(comment):
    """The text of a comment line; what would be a command or a link of Doxygen is escaped."""
    return re.sub(r"([\\@#])", r"\\\1", comment.strip()[2:])


def filtered(lines):
    above = range(0)  # the lines of the comment above
    comment = []  # its text
    is_first = True  # no declaration has followed it yet
    at = 0
    while at < len(lines):
        begin, text = at, lines[at].strip()
        at += 1
        if text.startswith("//"):
            while lines[at].strip().startswith("//"):
                at += 1
            above, is_first = range(begin, at), True
            comment = [describe(line) for line in lines[begin:at]]
            continue
        if not text or text[0] in "#}" or re.match(r"(public|protected|private):", text):
            above = range(0)
            continue
        end, opens = last_line(lines, begin)
        at = end + 1
        is_namespace = opens and re.match(r"\s*namespace\b", lines[begin])
        commented = end if "//" in lines[end] or not re.search(r"{ *//", lines[begin]) else begin
        source, _, behind = lines[commented].partition("//")
        behind = re.sub(r"^ NOLINT:?", "", describe("//" + behind))
        while behind and at < len(lines) and re.match(rf" {{{len(source)}}}//", lines[at]):
            behind += describe(lines[at])
            lines[at] = ""
            at += 1
        name = re.search(r"(\w+|operator[!=]=)\(", lines[begin])
        if is_namespace and above and not lines[above[0] - 1]:
            lines[above[0] - 1] = "/// @file"
        if is_first and (not is_namespace or above and lines[above[0] - 1] == "/// @file"):
            for line, text in zip(above, comment):
                lines[line] = "///" + text
        elif above and not behind and not opens:
            behind = " ".join(comment)
        elif not above and not behind and name and name[1] in KNOWN:
            behind = " " + KNOWN[name[1]]
        lines[commented] = source
        if behind and not is_namespace:
            lines[begin] = f"/**{behind} */ {lines[begin]}"
        is_first = False
        if opens or lines[end].strip().startswith("}"):
            above = range(0)
    return lines


print("\n".join(filtered(open(sys.argv[1], encoding="utf-8").read().split("\n"))))
