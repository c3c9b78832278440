/* sensor/reference/reference_network.c: Data PDUs sent by a node, of frames and of streams; the table of PDUs of
 * inspect. */
#include "sensor/reference/reference.h"

static const ReferenceField data_fields[] = {
    {"fixed 600001", "u32", "", "from 0", "", "number of the frame"},
    {"fixed 600002", "u32", "", "0 optical, 1 mwir, 2 lwir, 3 radar", "", "band"},
    {"fixed 600003", "u32", "", "1 sensor, 2 truth", "", "kind: what a seeker could measure, or truth (publish.dis)"},
    {"fixed 600004", "u16[2]", "px", "columns, rows", "", "size of the image"},
    {"fixed 600005", "f32", "rad", "", "", "horizontal field of view"},
    {"fixed 600006", "f32", "rad", "", "", "vertical field of view"},
    {"fixed 600007", "u32", "", "", "", "targets in this PDU"},
    {"fixed 600008", "u32", "", "", "", "targets left out because the PDU was full, the smallest"},
    {"variable 600101+0", "f64", "s", "exercise time", "", "instant of the frame"},
    {"variable 600102+0", "f64[3]", "m", "ecef", "", "position of the sensor"},
    {"variable 600103+0", "f64[3]", "rad",
     "psi, theta, phi as in an Entity State; x along the boresight, y right, z down", "", "attitude of the camera"},
    {"variable 600104+0", "u16[4]", "", "site, application, entity, 0", "", "the host; 0:0:0: an observer"},
    {"variable 600201+0", "u16[4]", "px", "image: left, top, right, bottom; from 0, the last two beyond it", "",
     "bounding box of its visible pixels"},
    {"variable 600201+8", "f32", "px", "", "", "area"},
    {"variable 600201+12", "f32", "rad", "camera right", "", "boresight error"},
    {"variable 600201+16", "f32", "rad", "camera up", "", "boresight error"},
    {"variable 600201+20", "f32", "K in mwir and lwir; ratio in optical and radar", "", "", "contrast"},
    {"variable 600201+24", "f32", "", "", "", "signal-to-noise ratio"},
    {"variable 600201+28", "f32", "m", "", "", "range; NaN except in radar"},
    {"variable 600201+32", "f32", "m/s", "", "", "closing speed; NaN except in radar"},
    {"variable 600202+0", "u16[4]", "", "site, application, entity, 0", "", "its id"},
    {"variable 600202+8", "u16[4]", "px", "image: left, top, right, bottom; from 0, the last two beyond it", "",
     "bounding box of its visible pixels; 0 0 0 0: occluded"},
    {"variable 600202+16", "f32", "px", "", "", "visible area"},
    {"variable 600202+20", "f32", "", "0 .. 1", "", "visible fraction"},
    {"variable 600202+24", "f32", "m", "", "", "range"},
    {"variable 600202+28", "f32", "m/s", "", "", "closing speed"},
    {"variable 600202+32", "f32", "rad", "", "", "aspect, 0 nose on"},
    {"variable 600202+36", "f32", "rad", "ENU at the sensor, from north over east", "", "azimuth of the line of sight"},
    {"variable 600202+40", "f32", "rad", "ENU at the sensor", "", "elevation of the line of sight"},
    {"variable 600202+44", "f32", "rad", "camera right", "", "boresight error"},
    {"variable 600202+48", "f32", "rad", "camera up", "", "boresight error"},
    {"variable 600202+52", "f32", "", "", "", "signal-to-noise ratio"},
};

const Reference reference_data_pdu = {
    .topic = "data-pdu",
    .file = "Data PDU",
    .title = "what the seeker sees, as Data PDUs (type 20), one per frame and band",
    .about =
        "Sent by `pitviper run`, and by `pitviper replay --speed X`, with --set publish.dis=sensor (datum 600201 per\n"
        "visible target) or truth (datum 600202 per target in the field of view), the largest first. A replay sends\n"
        "the octets that the node sent which made the recording, with the time stamps of the recorded hour. From node.site:node.application:0 to all (0xFFFF),\n"
        "request 0, at most 1400 octets. The ids of the datums are experimental: defined by this program, not\n"
        "registered.",
    .notation = "Field: `fixed ID`, a fixed datum of 32 bits; `variable ID+OFFSET`, octets within a variable datum. "
                "Type:\n"
                "big-endian; u16, u32: unsigned; f32, f64: IEEE 754; [n]: array of n. NaN: not computed.",
    .field = REFERENCE_FIELDS(data_fields),
    .python =
        "import socket, struct\n"
        "listen = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)\n"
        "listen.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)\n"
        "listen.bind(('', 3000))               # a multicast group: add IP_ADD_MEMBERSHIP\n"
        "while True:\n"
        "    pdu = listen.recv(65536)\n"
        "    if len(pdu) < 40 or pdu[2] != 20: continue\n"
        "    fixed, variable = struct.unpack('>II', pdu[32:40])\n"
        "    datum, at = dict(struct.unpack('>II', pdu[40 + 8 * i:48 + 8 * i]) for i in range(fixed)), 40 + 8 * fixed\n"
        "    if 600001 not in datum: continue      # of another program\n"
        "    for _ in range(variable):\n"
        "        kind, bits = struct.unpack('>II', pdu[at:at + 8])\n"
        "        value, at = pdu[at + 8:at + 8 + bits // 8], at + 8 + (bits + 63) // 64 * 8\n"
        "        if kind == 600202:\n"
        "            site, application, entity = struct.unpack('>3H', value[:6])\n"
        "            range_m, closing_mps = struct.unpack('>2f', value[24:32])\n"
        "            print(datum[600001], datum[600002], (site, application, entity), range_m, flush=True)\n",
};

static const ReferenceField stream_fields[] = {
    {"fixed 600002", "u32", "", "0 optical, 1 mwir, 2 lwir, 3 radar", "", "band"},
    {"fixed 600003", "u32", "", "3 stream", "", "kind"},
    {"fixed 600004", "u16[2]", "px", "columns, rows", "", "size of the image"},
    {"fixed 600005", "f32", "rad", "", "", "horizontal field of view"},
    {"fixed 600006", "f32", "rad", "", "", "vertical field of view"},
    {"fixed 600009", "u32", "", "1 H.264, 8 bits; 2 H.264, 10 bits; 3 HEVC, 12 bits; 4 FFV1, 16 bits", "",
     "codec (publish.video_codec)"},
    {"fixed 600010", "u32", "", "0 none, 1 asynchronous, 2 synchronous", "", "MISB ST 0601 metadata (publish.klv)"},
    {"fixed 600011", "u32", "", "0 none, 1 detections of a recogniser, 2 truth", "",
     "MISB ST 0903 targets in them (publish.vmti)"},
    {"variable 600101+0", "f64", "s", "exercise time", "", "instant of the frame that it is sent with"},
    {"variable 600104+0", "u16[4]", "", "site, application, entity, 0", "", "the host; 0:0:0: an observer"},
    {"variable 600301+0", "text", "", "ASCII, udp://HOST:PORT", "", "address of the stream"},
};

const Reference reference_stream_pdu = {
    .topic = "stream-pdu",
    .file = "Stream PDU",
    .title = "where the video streams are, as Data PDUs (type 20), one per band every 5 s of exercise time",
    .about =
        "Sent with those of data-pdu where publish.stream is set: before the first frame's, and before those of the "
        "first\n"
        "frame of each 5 s of exercise time. Without datum 600001; else as those. The streams are MPEG-TS over UDP.",
    .notation = "Field and type: as in data-pdu; text: one octet per character, as many as the datum has.",
    .field = REFERENCE_FIELDS(stream_fields),
    .python =
        "import socket, struct\n"
        "listen = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)\n"
        "listen.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)\n"
        "listen.bind(('', 3000))               # a multicast group: add IP_ADD_MEMBERSHIP\n"
        "while True:\n"
        "    pdu = listen.recv(65536)\n"
        "    if len(pdu) < 40 or pdu[2] != 20: continue\n"
        "    fixed, variable = struct.unpack('>II', pdu[32:40])\n"
        "    datum, at = dict(struct.unpack('>II', pdu[40 + 8 * i:48 + 8 * i]) for i in range(fixed)), 40 + 8 * fixed\n"
        "    if datum.get(600003) != 3: continue   # a frame's, or of another program\n"
        "    for _ in range(variable):\n"
        "        kind, bits = struct.unpack('>II', pdu[at:at + 8])\n"
        "        value, at = pdu[at + 8:at + 8 + bits // 8], at + 8 + (bits + 63) // 64 * 8\n"
        "        if kind == 600301: print(datum[600002], value.decode('ascii'), flush=True)\n",
};

static const ReferenceField radar_fields[] = {
    {"fixed 600001", "u32", "", "from 0", "", "number of the frame"},
    {"fixed 600003", "u32", "", "4 radar", "", "kind"},
    {"fixed 600012", "u32", "", "", "", "detections in this PDU"},
    {"fixed 600013", "u32", "", "", "", "detections of the frame in none of its PDUs, the weakest"},
    {"fixed 600014", "u16[2]", "", "from 0, of how many", "", "number of this PDU among those of the frame"},
    {"variable 600101+0", "f64", "s", "exercise time", "", "instant of the frame, the middle of the interval"},
    {"variable 600102+0", "f64[3]", "m", "ecef", "", "position of the antenna"},
    {"variable 600103+0", "f64[3]", "rad",
     "psi, theta, phi as in an Entity State; x along the boresight, y right, z down", "", "attitude of the antenna"},
    {"variable 600104+0", "u16[4]", "", "site, application, entity, 0", "", "the host; 0:0:0: an observer"},
    {"variable 600401+0", "f64", "Hz", "", "", "centre frequency"},
    {"variable 600401+8", "f64", "m", "from the antenna", "", "middle of the range window"},
    {"variable 600401+16", "f32", "Hz", "", "", "bandwidth"},
    {"variable 600401+20", "f32", "m/s", "above 0: receding", "", "range rate in the middle of the map"},
    {"variable 600401+24", "f32", "m", "", "", "length of the range window"},
    {"variable 600401+28", "f32", "m/s", "", "", "span of range rates; others fold over into it"},
    {"variable 600402+0", "f32", "m", "from the antenna", "", "range"},
    {"variable 600402+4", "f32", "m/s", "above 0: receding", "", "range rate"},
    {"variable 600402+8", "f32", "rad", "from the boresight, right positive", "", "azimuth"},
    {"variable 600402+12", "f32", "rad", "from the boresight, up positive", "", "elevation"},
    {"variable 600402+16", "f32", "dB", "", "", "signal-to-noise ratio, over the noise and clutter about it"},
    {"variable 600402+20", "f32", "dB over 1 m2", "", "", "cross section, as one point where it was found"},
};

const Reference reference_radar_pdu = {
    .topic = "radar-pdu",
    .file = "Radar PDU",
    .title = "what the radar on the sensor's axis detected, as Data PDUs (type 20)",
    .about =
        "Sent with those of data-pdu where radar.preset is set, behind the frame's bands: the 128 strongest detections,\n"
        "strongest first, 32 a PDU; one PDU where there is none. The values are those of radar.detections in "
        "truth.jsonl.\n"
        "Without datum 600002; else as those.",
    .notation = "Field and type: as in data-pdu. 600402 is there once a detection.",
    .field = REFERENCE_FIELDS(radar_fields),
    .python =
        "import math, socket, struct\n"
        "listen = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)\n"
        "listen.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)\n"
        "listen.bind(('', 3000))               # a multicast group: add IP_ADD_MEMBERSHIP\n"
        "while True:\n"
        "    pdu = listen.recv(65536)\n"
        "    if len(pdu) < 40 or pdu[2] != 20: continue\n"
        "    fixed, variable = struct.unpack('>II', pdu[32:40])\n"
        "    datum, at = dict(struct.unpack('>II', pdu[40 + 8 * i:48 + 8 * i]) for i in range(fixed)), 40 + 8 * fixed\n"
        "    if datum.get(600003) != 4: continue   # a band's or a stream's, or of another program\n"
        "    for _ in range(variable):\n"
        "        kind, bits = struct.unpack('>II', pdu[at:at + 8])\n"
        "        value, at = pdu[at + 8:at + 8 + bits // 8], at + 8 + (bits + 63) // 64 * 8\n"
        "        if kind == 600402:\n"
        "            range_m, rate_mps, az_rad, el_rad, snr_db, dbsm = struct.unpack('>6f', value)\n"
        "            print(datum[600001], range_m, rate_mps, math.degrees(az_rad), snr_db, dbsm, flush=True)\n",
};

static const ReferenceField pdu_fields[] = {
    {"frame.number", "integer", "", "from 1", "", "packet of the capture"},
    {"dis.proto_ver", "integer", "", "", "", "version of DIS: 5, 6, 7"},
    {"dis.exer_id", "integer", "", "", "", "exercise"},
    {"dis.timestamp", "number", "s", "past the hour", "", "time stamp as tshark divides it, 1.7 us ahead at most"},
    {"dis.pdu_length", "integer", "octets", "", "", "of the PDU"},
    {"dis.entity_id_site", "integer", "", "", "", "id"},
    {"dis.entity_id_application", "integer", "", "", "", "id"},
    {"dis.entity_id_entity", "integer", "", "", "", "id"},
    {"dis.force_id", "integer", "", "", "", "0 other, 1 friendly, 2 opposing, 3 neutral"},
    {"dis.num_articulation_params", "integer", "", "", "", "variable parameter records"},
    {"dis.entity_linear_velocity.x", "number", "m/s", "ecef, or body by the algorithm", "", "velocity"},
    {"dis.entity_linear_velocity.y", "number", "m/s", "as x", "", "velocity"},
    {"dis.entity_linear_velocity.z", "number", "m/s", "as x", "", "velocity"},
    {"dis.entity_location.x", "number", "m", "ecef", "", "position"},
    {"dis.entity_location.y", "number", "m", "ecef", "", "position"},
    {"dis.entity_location.z", "number", "m", "ecef", "", "position"},
    {"dis.entity_orientation.psi", "number", "rad", "ecef to body", "", "first Euler angle, about z"},
    {"dis.entity_orientation.theta", "number", "rad", "ecef to body", "", "second, about y"},
    {"dis.entity_orientation.phi", "number", "rad", "ecef to body", "", "third, about x"},
    {"dis.appearance", "hexadecimal", "", "bit 0 is the lowest", "", "appearance bits, 0x and 8 digits"},
    {"dis.entity_linear_acceleration.x", "number", "m/s2", "ecef, or body by the algorithm", "", "acceleration"},
    {"dis.entity_linear_acceleration.y", "number", "m/s2", "as x", "", "acceleration"},
    {"dis.entity_linear_acceleration.z", "number", "m/s2", "as x", "", "acceleration"},
    {"dis.entity_angular_velocity.x", "number", "rad/s", "body", "", "angular velocity"},
    {"dis.entity_angular_velocity.y", "number", "rad/s", "body", "", "angular velocity"},
    {"dis.entity_angular_velocity.z", "number", "rad/s", "body", "", "angular velocity"},
    {"dis.entity_marking", "text", "", "", "", "marking; what is not printable is escaped"},
    {"dis.entityKind", "integer", "", "", "without --full", "entity type"},
    {"dis.entityDomain", "integer", "", "", "without --full", "entity type"},
    {"dis.country", "integer", "", "", "without --full", "entity type"},
    {"dis.category", "integer", "", "", "without --full", "entity type"},
    {"dis.subcategory", "integer", "", "", "without --full", "entity type"},
    {"dis.specific", "integer", "", "", "without --full", "entity type"},
    {"dis.extra", "integer", "", "", "without --full", "entity type"},
    {"dis.dead_reckoning_algorithm", "integer", "", "", "without --full", "1 static .. 9; 0 other"},
    {"dis.dead_reckoning_other_parameters", "hexadecimal", "", "", "without --full", "15 octets, 30 digits"},
    {"dis.capabilities", "integer", "", "", "without --full", "capabilities"},
    {"alternative_type", "text", "", "kind.domain.country.category.subcategory.specific.extra", "without --full",
     "alternative entity type"},
    {"articulation", "text", "rad, rad/s or m by the parameter", "change:attached:parameter:value; ...",
     "without --full", "articulation parameters; prefixed attached: for attached parts, record: for other records"},
};

const Reference reference_pdus = {
    .topic = "pdus",
    .file = "PDU table",
    .title = "every Entity State PDU of a log: `pitviper inspect LOG --pdus tsv [--full]`",
    .about = "Tab-separated lines on standard output, a header first; columns and formats of `tshark -T fields`.",
    .notation = "Field: column.",
    .field = REFERENCE_FIELDS(pdu_fields),
    .python = "import csv, sys\n"
              "for row in csv.DictReader(sys.stdin, delimiter='\\t', quoting=csv.QUOTE_NONE):\n"
              "    entity = tuple(int(row['dis.entity_id_' + part]) for part in ('site', 'application', 'entity'))\n"
              "    p_ecef = [float(row['dis.entity_location.' + axis]) for axis in 'xyz']\n"
              "    print(float(row['dis.timestamp']), entity, row['dis.entity_marking'], p_ecef)\n"
              "# pitviper inspect LOG --pdus tsv | python3 this.py\n",
};
