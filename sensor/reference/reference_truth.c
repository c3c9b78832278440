/* sensor/reference/reference_truth.c: truth.jsonl, and the list of all products. */
#include "sensor/frame/record_fields.h"
#include "sensor/reference/reference.h"

const Reference reference_products = {
    .topic = "products",
    .file = "OUT/",
    .title = "files of a run, in the folder given by --out",
    .about =
        "    truth.jsonl                      help truth     targets: position, signal; a line per frame\n"
        "    run.json                         help run.json  the run: settings, hashes, choices, counters, times\n"
        "    frames/BAND/NNNNNN.exr           help exr       radiance per pixel\n"
        "    frames/truth/NNNNNN.exr          help exr       range, entity, part, material, temperature, normal;\n"
        "                                                    with terrain.woods: instance, cover\n"
        "    frames/BAND/NNNNNN.png           help png       display images; absent with --no-png\n"
        "    frames/truth/NNNNNN.png          help png       the truth for viewing\n"
        "    latest/BAND.png                  help png       the newest display image; --latest\n"
        "    raw/BAND/NNNNNN.png              help raw       counts of the detector; with sensor.preset or "
        "sensor.table\n"
        "    profiles/radar/NNNNNN.csv        help profile   pseudo-radar power over range\n"
        "    radar/NNNNNN.csv                 help radar     range profile of a radar with phase; radar.preset\n"
        "    radar/NNNNNN.exr, .png           help radar-map its map of range and Doppler\n"
        "    radar/NNNNNN_scan.exr, .png      help radar-scan its scan, real beam; radar.scan_deg\n"
        "    radar/NNNNNN_dbs.exr, .png       help radar-scan the same sharpened by Doppler\n"
        "    radar/NNNNNN_dbs.csv             help radar-azimuths  its resolution over azimuth\n"
        "    radar/NNNNNN_view.exr, _view_*.png help radar-scan both on the pixels of the bands\n"
        "    pairs.jsonl, pairs/              help pairs     each frame without its target, without noise; --pairs\n"
        "    coco.json                        help coco      boxes and masks; --coco\n"
        "    answers.jsonl                    help answers   a recogniser's detections; --set publish.detections_port=PORT\n"
        "    score.json                       help score.json  these against the truth; pitviper score OUT\n"
        "    manifest.jsonl, V/variant.json   help manifest  of --sweep: a line per variant; V/ is a folder of "
        "this kind\n"
        "    manifest.html, V/thumbnail.png   help sheet     of --sweep: thumbnails\n"
        "    V/settings.yaml, V/log.txt                      of --sweep: its settings for --config; messages\n"
        "    (on the network)                 help data-pdu  what the seeker sees, as DIS; --set publish.dis=sensor\n"
        "    (on the network)                 help stream-pdu  where its video streams are, with publish.stream\n"
        "    (on the network)                 help radar-pdu what a radar detected, with publish.dis and radar.preset\n"
        "    (standard output)                help pdus      Entity State PDUs of a log; pitviper inspect --pdus tsv\n"
        "    CASE/record/                     help regress-record  of pitviper regress: the baseline\n"
        "\n"
        "NNNNNN is the frame's number, six digits, from 0: frames are at whole multiples of 1/rate of "
        "exercise time,\n"
        "counted from the first within the lifetime of the host, whatever --from is. With several hosts each has its "
        "own\n"
        "OUT/SITE-APPLICATION-ENTITY/, or OUT/observer/, of this shape. Files are renamed into\n"
        "place when complete; truth.jsonl, pairs.jsonl and manifest.jsonl are appended line by line.\n"
        "\n"
        "Coordinate frames:\n"
        "\n"
        "    ecef    Earth-centred, Earth-fixed, WGS 84, m: the world coordinates of DIS\n"
        "    ENU     east, north, up at the stated position\n"
        "    body    of an entity: x forward, y right, z down\n"
        "    camera  x right, y down, z along the boresight\n"
        "    image   column right, row down, in pixels; the first pixel's centre is (0.5, 0.5), it covers "
        "(0, 0) to\n"
        "            (1, 1). Boxes in whole pixels count from 0; right and bottom are exclusive\n"
        "\n"
        "A value that was not computed is absent, never 0. In truth planes entities, parts and materials count\n"
        "from 1, 0 is none; all other indices count from 0. Times are exercise time, s, unless stated as UTC.",
};

static const ReferenceWord words[] = {REFERENCE_WORD_BAND, REFERENCE_WORD_CONSUMER};

const Reference reference_truth = {
    .topic = "truth",
    .file = "truth.jsonl",
    .title = "targets in the image, their position and signal: a line of JSON per frame",
    .about =
        "JSON Lines: each line is one object. A line is appended when its frame is complete; with latency_ms, when\n"
        "all its consumers are done with the frame, at the latest two frames later.",
    .table = &record_frame_fields,
    .word = REFERENCE_FIELDS(words),
    .python = "import json\n"
              "for line in open('truth.jsonl'):\n"
              "    frame = json.loads(line)\n"
              "    for target in frame['targets']:\n"
              "        if 'box_px' not in target:          # hidden: no pixel of its own\n"
              "            continue\n"
              "        left, top, right, bottom = target['box_px']\n"
              "        width, height = right - left, bottom - top\n"
              "        snr = target['bands'].get('lwir', {}).get('snr')    # absent: not computed\n"
              "        print(frame['frame'], target['entity'], target['range_m'], (width, height), snr)\n",
};
