"""Malicious run files whose pages refer to one page many times, so that a small file has millions of rows."""

import sqlite3
import struct
from contextlib import closing

PAGE_SIZE = 8192
# Types of interior pages; those of leaf pages are greater by 8.
TABLE_PAGE = 0x05
INDEX_PAGE = 0x02
MAX_REFERENCES = 900  # from one page to another


def pages_of(path):
    """Return the pages of a run file, and the root page of each table and index."""
    with closing(sqlite3.connect(path)) as db:
        roots = dict(db.execute("SELECT name, rootpage FROM sqlite_schema"))
    raw = path.read_bytes()
    return [bytearray(raw[at : at + PAGE_SIZE]) for at in range(0, len(raw), PAGE_SIZE)], roots


def write_pages(path, pages):
    """Write pages as a SQLite file, with their number in its header."""
    pages[0][28:32] = struct.pack(">I", len(pages))
    path.write_bytes(b"".join(pages))


def cell_offsets(page, head=0):
    """Return the offsets of the cells of a leaf page."""
    (n,) = struct.unpack_from(">H", page, head + 3)
    return struct.unpack_from(f">{n}H", page, head + 8)


def leaf_page(like, offsets):
    """Return a leaf page with the cells of another page at these offsets, which may be repeated."""
    page = bytearray(PAGE_SIZE)
    first = min(offsets)
    page[first:] = like[first:]
    struct.pack_into(f">BHHHB{len(offsets)}H", page, 0, 0x0D, 0, len(offsets), first, 0, *offsets)
    return page


def interior_page(kind, children, key, head=0):
    """Return an interior page with these children."""
    page = bytearray(PAGE_SIZE)
    n = len(children) - 1
    size = 4 + len(key)
    offsets = [PAGE_SIZE - size * (i + 1) for i in range(n)]
    for offset, child in zip(offsets, children, strict=False):
        page[offset : offset + size] = struct.pack(">I", child) + key
    struct.pack_into(f">BHHHBI{n}H", page, head, kind, 0, n, offsets[-1], 0, children[-1], *offsets)
    return page


def endless_schema(path):
    """Make the schema table practically endless, with copies of an existing index."""
    pages, _ = pages_of(path)
    first = pages[0]
    n = len(pages)
    offsets = cell_offsets(first, 100)
    with closing(sqlite3.connect(path)) as db:
        kinds = [kind for (kind,) in db.execute("SELECT type FROM sqlite_schema ORDER BY rowid")]
    index = offsets[kinds.index("index")]
    pages += [leaf_page(first, offsets), leaf_page(first, [index] * 500)]
    pages += [
        interior_page(TABLE_PAGE, [n + 2] * MAX_REFERENCES, b"\1"),
        interior_page(TABLE_PAGE, [n + 3] * MAX_REFERENCES, b"\1"),
    ]
    pages[0] = interior_page(TABLE_PAGE, [n + 1, n + 4], b"\1", head=100)
    pages[0][:100] = first[:100]
    write_pages(path, pages)


def endless_index(path):
    """Make the index of the table repeat the 6 robots of a generation endlessly."""
    pages, roots = pages_of(path)
    root = roots["sqlite_autoindex_records_1"] - 1
    n = len(pages)
    offset = cell_offsets(pages[root])[0]
    entry = bytes(pages[root][offset : offset + 1 + pages[root][offset]])
    full = leaf_page(pages[root], cell_offsets(pages[root])[:6] * 60)
    full[0] = 0x0A
    pages += [full, interior_page(INDEX_PAGE, [n + 1] * 400, entry), interior_page(INDEX_PAGE, [n + 2] * 400, entry)]
    pages[root] = interior_page(INDEX_PAGE, [n + 3] * 400, entry)
    write_pages(path, pages)
