#!/usr/bin/env python3
"""Packets of ST 0601, and of ST 0903 by itself, as JSON lines: klv_decode.py FILE.klv... [--reader NAME]... [--lax]

The values come from readers that are not Pitviper's: PyPI klvdata (ST 0601, also the octets of tag 74), stanag4609 and
tstrans (ST 0601 and ST 0903). Each line: {"octets": N, "tags": [...], READER: {...}}. A walk over tags and lengths
here, strict, is a second judge of the structure only: keys, lengths, checksums, first and last tag, no tag twice. With
--lax, for packets of others, a wrong checksum or what a reader refuses is noted in the line: {"wrong": [...]}.

Exit 0: all packets accepted; 1: one was not, said on standard error; 77: no reader is installed.
"""
import datetime, json, math, sys

UAS = bytes.fromhex("060e2b34020b01010e01030101000000")
VMTI = bytes.fromhex("060e2b34020b01010e01030306000000")


class Bad(Exception):
    pass


# ---- the walk -------------------------------------------------------------------------------------

def ber_length(data, at):
    if at >= len(data):
        raise Bad("ends in a length")
    first, at = data[at], at + 1
    if first < 128:
        return first, at
    count = first & 127
    if count == 0 or count > 4 or at + count > len(data):
        raise Bad("length of %d octets" % count)
    value = int.from_bytes(data[at:at + count], "big")
    if value < 128 or value >> (8 * (count - 1)) == 0:
        raise Bad("length not in its shortest form")
    return value, at + count


def ber_oid(data, at):
    value, first = 0, at
    while True:
        if at >= len(data):
            raise Bad("ends in a tag")
        if at == first and data[at] == 0x80:
            raise Bad("tag not in its shortest form")
        value = value << 7 | data[at] & 127
        at += 1
        if data[at - 1] < 128:
            return value, at


def local_set(data):
    """[(tag, octets)], all of the data."""
    items, at = [], 0
    while at < len(data):
        tag, at = ber_oid(data, at)
        length, at = ber_length(data, at)
        if at + length > len(data):
            raise Bad("tag %d: %d octets are not there" % (tag, length))
        items.append((tag, data[at:at + length]))
        at += length
    tags = [tag for tag, _ in items]
    if len(set(tags)) != len(tags):
        raise Bad("a tag twice: %s" % tags)
    return items


def checksum(data):
    return sum(octet << (8 * ((i + 1) % 2)) for i, octet in enumerate(data)) & 0xFFFF


def packets(data, wrong=None):
    """(key, whole packet, items of its local set). wrong: a list for what is no reason to stop; None: it is one."""
    at = 0
    while at < len(data):
        key = data[at:at + 16]
        if key not in (UAS, VMTI):
            raise Bad("octet %d: no key of ST 0601 or ST 0903" % at)
        length, value = ber_length(data, at + 16)
        if value + length > len(data):
            raise Bad("octet %d: a packet of %d octets is cut" % (at, length))
        whole, items = data[at:value + length], local_set(data[value:value + length])
        if [tag for tag, _ in items][:1] != [2] or items[-1][0] != 1:
            raise Bad("time stamp not first or checksum not last: %s" % [tag for tag, _ in items])
        if int.from_bytes(items[-1][1], "big") != checksum(whole[:-2]):
            if wrong is None:
                raise Bad("octet %d: wrong checksum" % at)
            wrong.append("checksum")
        yield key, whole, items
        at = value + length


# ---- readers: (name, function of a whole packet -> dict) -------------------------------------------

def plain(value):
    """As JSON has it."""
    if isinstance(value, (bytes, bytearray, memoryview)):
        return bytes(value).hex()
    if isinstance(value, datetime.datetime):
        if value.tzinfo is None:
            value = value.replace(tzinfo=datetime.timezone.utc)
        epoch = datetime.datetime(1970, 1, 1, tzinfo=datetime.timezone.utc)
        return (value - epoch) // datetime.timedelta(microseconds=1)
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, int):
        return int(value)
    if hasattr(value, "value") and not hasattr(value, "__dataclass_fields__"):
        return plain(value.value)
    if hasattr(value, "__dataclass_fields__"):
        names = [f for f in value.__dataclass_fields__ if f not in ("raw", "local_set", "item")]
        return {f: plain(getattr(value, f)) for f in names}
    try:
        return float(value)
    except (TypeError, ValueError):
        return str(value)


def read_klvdata():
    import klvdata
    # klvdata 0.0.3 fails on every packet with tag 74 (a class that cannot be created) or tag 104 (read as two octets,
    # linear): without these classes it takes the octets as they are
    for tag in b"\x4a", b"\x68":
        klvdata.misb0601.UASLocalMetadataSet.parsers.pop(tag, None)

    def read(key, whole):
        if key != UAS:
            return None
        found = list(klvdata.StreamParser(whole))
        if len(found) != 1 or not hasattr(found[0], "items"):
            raise Bad("klvdata: %s" % found)
        out = {}
        for tag, element in found[0].items.items():
            value = element.value
            out[str(tag[0])] = plain(getattr(value, "value", value))
        return out
    return read


def vmti_of_stanag4609(vmti):
    fields = {str(f.tag): plain(f.value) for f in vmti.fields if f.tag < 100}
    for item in vmti.local_set.items:
        if item.tag == 7:  # frame number: not in the sixth edition, so its octets
            fields["7"] = int.from_bytes(item.value, "big")
    return {"fields": fields,
            "targets": [{"id": t.target_id, **{str(f.tag): plain(f.value) for f in t.fields}} for t in vmti.targets],
            "algorithms": [plain(a) for a in vmti.algorithms], "ontologies": [plain(o) for o in vmti.ontologies]}


def read_stanag4609():
    from stanag4609.st0601 import decode_uas_local_set
    from stanag4609.st0903 import decode_vmti_local_set

    def read(key, whole):
        if key == VMTI:
            return {"vmti": vmti_of_stanag4609(decode_vmti_local_set(whole))}
        uas = decode_uas_local_set(whole)
        out = {str(f.item.tag): plain(f.value) for f in uas.fields if f.item.tag != 74}
        for tag, octets in local_set(whole[ber_length(whole, 16)[1]:]):
            if tag == 74:
                out["vmti"] = vmti_of_stanag4609(decode_vmti_local_set(octets, standalone=False))
        return out
    return read


def read_tstrans():
    from tstrans import klv

    def read(key, whole):
        if key == VMTI:
            return {"vmti": plain(klv.decode_vmti(whole[ber_length(whole, 16)[1]:], strict=False))}
        uas = klv.decode_uas_datalink(whole, strict=True)
        out = {k: v for k, v in plain(uas).items() if v not in (None, [], "")}
        if uas.vmti is not None:
            out["vmti"] = plain(klv.decode_vmti(uas.vmti, strict=True))
        return out
    return read


READERS = {"klvdata": read_klvdata, "stanag4609": read_stanag4609, "tstrans": read_tstrans}


def readers(names=None):
    """Of those installed."""
    found = {}
    for name in names or READERS:
        try:
            found[name] = READERS[name]()
        except ImportError:
            print("klv_decode: no %s (pip install %s)" % (name, name), file=sys.stderr)
    return found


def decode(data, found, lax=False):
    """A dict for each packet. Raises Bad."""
    wrong = [] if lax else None
    for number, (key, whole, items) in enumerate(packets(data, wrong)):
        out = {"octets": len(whole), "set": "0601" if key == UAS else "0903", "tags": [tag for tag, _ in items]}
        for name, read in found.items():
            try:
                out[name] = read(key, whole)
            except Exception as error:
                text = "%s: %s: %s" % (name, type(error).__name__, error)
                if not lax:
                    raise Bad("packet %d: %s; %s" % (number, text, whole.hex()))
                wrong.append(text)
        if wrong:
            out["wrong"] = wrong[:]
            wrong.clear()
        yield out


def main(arguments):
    names = [arguments[i + 1] for i, a in enumerate(arguments) if a == "--reader"]
    files = [a for i, a in enumerate(arguments) if a[:2] != "--" and (i == 0 or arguments[i - 1] != "--reader")]
    found = readers(names)
    if not found:
        return 77
    for path in files:
        try:
            for out in decode(open(path, "rb").read(), found, "--lax" in arguments):
                print(json.dumps(out))
        except Bad as error:
            print("klv_decode: %s: %s" % (path, error), file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
