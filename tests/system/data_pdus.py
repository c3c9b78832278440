"""Data PDUs as sensor/publish/dis/consume_dis.h describes them, read from recordings: used by test_replay_publishes.sh, test_five_records.sh
and test_live_radar.sh.

    data_pdus.py receive ADDRESS PORT FILE     datagrams to ADDRESS:PORT into FILE, a line of hex each, until a line
                                               comes in on standard input, or that is closed; says when it listens
    data_pdus.py same LIVE.pcapng FILE LEAST   the Data PDUs of FILE against those of the recording, by frame and band
    data_pdus.py radar LIVE.pcapng TRUTH LEAST a radar's detections in the recording against those of truth.jsonl, of at
                                               least so many frames
"""
import collections, json, math, select, socket, struct, sys, time

def datagrams(path):
    """UDP payloads of a pcapng written by Pitviper, over IPv4."""
    data, at, link = open(path, "rb").read(), 0, 0
    while at + 12 <= len(data):
        kind, size = struct.unpack_from("<II", data, at)
        if kind == 1: link, = struct.unpack_from("<H", data, at + 8)
        if kind == 6:
            kept, = struct.unpack_from("<I", data, at + 20)
            packet = data[at + 28:at + 28 + kept][{1: 14, 101: 0, 228: 0, 113: 16}[link]:]
            if packet[0] >> 4 == 4 and packet[9] == 17: yield packet[(packet[0] & 15) * 4 + 8:]
        at += size

def data_pdus(payloads): return [p for p in payloads if len(p) >= 40 and p[2] == 20 and p[3] == 5]

def datums(pdu):
    """{id: value} of the fixed datums, and [(id, octets)] of the variable ones."""
    fixed, variable = struct.unpack(">II", pdu[32:40])
    values, at, records = dict(struct.unpack(">II", pdu[40 + 8 * i:48 + 8 * i]) for i in range(fixed)), 40 + 8 * fixed, []
    for _ in range(variable):
        number, bits = struct.unpack(">II", pdu[at:at + 8])
        records.append((number, pdu[at + 8:at + 8 + bits // 8]))
        at += 8 + (bits + 63) // 64 * 8
    assert at == len(pdu), "it does not end where its records do"
    return values, records

def receive(address, port, path):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear, open(path, "w") as to:
        ear.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 21)
        ear.bind((address, int(port)))
        print("listening", flush=True)
        end = time.monotonic() + 300  # s: of slow builds, too
        while time.monotonic() < end:
            ready, _, _ = select.select([ear, sys.stdin], [], [], 0.2)
            if ear in ready: to.write(ear.recv(65536).hex() + "\n")
            elif sys.stdin in ready: break

def stream(pdu):
    values, records = datums(pdu)
    text = dict(records)[600301].decode("ascii")
    return values[600002], values[600003], values[600004], values[600009], values[600010], values[600011], text

def same(live_path, path, least):
    live, replayed = data_pdus(datagrams(live_path)), data_pdus(bytes.fromhex(line) for line in open(path))
    frames = [collections.Counter(), collections.Counter()]
    octets = [{}, {}]
    told = [[], []]
    for k, pdus in enumerate((live, replayed)):
        for pdu in pdus:
            values, _ = datums(pdu)
            if 600001 not in values: told[k].append(stream(pdu)); continue
            which = values[600001], values.get(600002, ("radar", values.get(600014)))
            frames[k][which] += 1
            octets[k][which] = pdu
    both = octets[0].keys() & octets[1].keys()
    assert len(both) >= int(least), f"only {len(both)} of {len(octets[0])} PDUs of the node are among {len(octets[1])} of the replay"
    assert octets[0].keys() <= octets[1].keys(), f"the replay lacks {sorted(octets[0].keys() - octets[1].keys(), key=str)}"
    assert max(frames[1].values()) == 1, "a frame is sent twice"
    for key in sorted(both, key=str):
        a, b = octets[0][key], octets[1][key]
        first = next((i for i in range(min(len(a), len(b))) if a[i] != b[i]), min(len(a), len(b)))
        assert a == b, f"frame and band {key}: octet {first} of {len(a)} differs"
    assert any(struct.unpack(">I", p[32:36])[0] and dict([d for d in datums(p)[1]]).get(600202) for p in octets[1].values()), "no target in any"
    assert set(told[0]) == set(told[1]), f"streams: {told}"
    print(len(both), "PDUs are the same;", len(told[0]), "and", len(told[1]), "announcements")
    for each in sorted(set(told[1])): print("stream", *each)

def radar(live_path, truth_path, least):
    frames, found, seen = {f["frame"]: f for f in map(json.loads, open(truth_path))}, {}, set()
    for pdu in data_pdus(datagrams(live_path)):
        values, records = datums(pdu)
        if values.get(600003) != 4 or values[600001] not in frames or pdu in seen: continue
        seen.add(pdu)  # a node receives its own once more
        assert len(pdu) <= 1400 and 600002 not in values and sorted(values) == [600001, 600003, 600012, 600013, 600014]
        one = [struct.unpack(">6f", octets) for number, octets in records if number == 600402]
        assert values[600012] == len(one) <= 32
        head = struct.unpack(">2d4f", dict(records)[600401])
        assert dict(records)[600101] == struct.pack(">d", frames[values[600001]]["time_s"])
        found.setdefault(values[600001], []).append((values[600014] >> 16, values[600014] & 65535, values[600013], head, one))
    compared = 0
    for number, pdus in found.items():
        pdus.sort(key=lambda pdu: pdu[0])
        truth = frames[number]["radar"]
        want, many = truth["detections"], len(pdus)
        assert [p[:2] for p in pdus] == [(k, many) for k in range(many)], f"frame {number}: PDUs {[p[:2] for p in pdus]}"
        got = [d for p in pdus for d in p[4]]
        assert len(got) == min(len(want), 128), f"frame {number}: {len(got)} detections of {len(want)}"
        for p in pdus:
            assert p[2] == truth["detections_in_all"] - len(got)
            assert abs(p[3][1] - truth["reference_m"]) < 1e-9 and abs(p[3][3] - truth["reference_rate_mps"]) < 1e-4
        for d, w in zip(got, want):
            rows = (w["range_m"], w["range_rate_mps"], math.radians(w["az_deg"]), math.radians(w["el_deg"]), w["snr_db"], w["rcs_dbsm"])
            assert all(abs(a - b) <= 1e-6 * max(1, abs(b)) for a, b in zip(d, rows)), f"frame {number}: {d}, not {rows}"
            compared += 1
    assert len(found) >= int(least) and compared >= int(least), f"{len(found)} frames, {compared} detections"
    print(len(found), "frames,", compared, "detections are those of truth.jsonl")

if __name__ == "__main__":
    {"receive": receive, "same": same, "radar": radar}[sys.argv[1]](*sys.argv[2:])
