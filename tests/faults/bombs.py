"""Malicious run files: pages that refer to one page many times, so that a small file has endless rows."""

import sqlite3
import struct
from contextlib import closing

PAGE = 8192
TABLE, INDEX = 0x05, 0x02  # types of interior pages; those of leaves are greater by 8
MAX_REFERENCES = 900  # from one page to another


def pages_of(path):
    """Return the pages of a run file, and the root page of each table and index."""
    with closing(sqlite3.connect(path)) as db:
        roots = dict(db.execute("SELECT name, rootpage FROM sqlite_schema"))
    raw = path.read_bytes()
    return [bytearray(raw[at : at + PAGE]) for at in range(0, len(raw), PAGE)], roots


def write(path, pages):
    pages[0][28:32] = struct.pack(">I", len(pages))
    path.write_bytes(b"".join(pages))


def cells(page, head=0):
    """Return the offsets of the cells of a leaf page."""
    (n,) = struct.unpack_from(">H", page, head + 3)
    return struct.unpack_from(f">{n}H", page, head + 8)


def leaf(like, places):
    """Return a leaf page with the cells of another page at these offsets, which may be repeated."""
    page, first = bytearray(PAGE), min(places)
    page[first:] = like[first:]
    struct.pack_into(f">BHHHB{len(places)}H", page, 0, 0x0D, 0, len(places), first, 0, *places)
    return page


def inner(kind, children, key, head=0):
    """Return an interior page with these children."""
    page, n, size = bytearray(PAGE), len(children) - 1, 4 + len(key)
    places = [PAGE - size * (i + 1) for i in range(n)]
    for place, child in zip(places, children, strict=False):
        page[place : place + size] = struct.pack(">I", child) + key
    struct.pack_into(f">BHHHBI{n}H", page, head, kind, 0, n, places[-1], 0, children[-1], *places)
    return page


def endless_schema(path):
    """Make the schema table of a file endless, with copies of an existing index."""
    pages, _ = pages_of(path)
    first, n = pages[0], len(pages)
    places = cells(first, 100)
    with closing(sqlite3.connect(path)) as db:
        kinds = [kind for (kind,) in db.execute("SELECT type FROM sqlite_schema ORDER BY rowid")]
    index = places[kinds.index("index")]
    pages += [leaf(first, places), leaf(first, [index] * 500)]
    pages += [inner(TABLE, [n + 2] * MAX_REFERENCES, b"\1"), inner(TABLE, [n + 3] * MAX_REFERENCES, b"\1")]
    pages[0] = inner(TABLE, [n + 1, n + 4], b"\1", head=100)
    pages[0][:100] = first[:100]
    write(path, pages)


def endless_index(path):
    """Make the index of the table repeat the 6 robots of a generation endlessly."""
    pages, roots = pages_of(path)
    root, n = roots["sqlite_autoindex_records_1"] - 1, len(pages)
    place = cells(pages[root])[0]
    entry = bytes(pages[root][place : place + 1 + pages[root][place]])
    full = leaf(pages[root], cells(pages[root])[:6] * 60)
    full[0] = 0x0A
    pages += [full, inner(INDEX, [n + 1] * 400, entry), inner(INDEX, [n + 2] * 400, entry)]
    pages[root] = inner(INDEX, [n + 3] * 400, entry)
    write(path, pages)
