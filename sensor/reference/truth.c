/* sensor/reference/truth.c: fields of truth.jsonl, and the list of all products. */
#include "sensor/reference/reference.h"

#include "sensor/reference/words.h"

const Reference reference_products = {
    .topic = "products",
    .file  = "OUT/",
    .title = "what a run leaves in the folder that --out names",
    .about =
        "    truth.jsonl                      help truth     targets: where, how bright; a line a frame\n"
        "    run.json                         help run.json  the run: settings, hashes, choices, counters, times\n"
        "    frames/BAND/NNNNNN.exr           help exr       radiance of every pixel\n"
        "    frames/truth/NNNNNN.exr          help exr       range, entity, part, material, temperature, normal\n"
        "    frames/BAND/NNNNNN.png           help png       what a display shows; without --no-png\n"
        "    frames/truth/NNNNNN.png          help png       the truth for people\n"
        "    raw/BAND/NNNNNN.png              help raw       counts of the detector; with sensor.preset or "
        "sensor.table\n"
        "    profiles/radar/NNNNNN.csv        help profile   radar power over range\n"
        "    pairs.jsonl, pairs/              help pairs     each frame without its target, without noise; --pairs\n"
        "    coco.json                        help coco      boxes and masks; --coco\n"
        "    manifest.jsonl, V/variant.json   help manifest  of --sweep: a line a variant; V/ is a folder of "
        "this kind\n"
        "    manifest.html, V/thumbnail.png   help sheet     of --sweep: their pictures\n"
        "    V/settings.yaml, V/log.txt                      of --sweep: its settings for --config; what the run said\n"
        "    (on the network)                 help data-pdu  what the seeker sees, as DIS; --set publish.dis=sensor\n"
        "    (standard output)                help pdus      Entity State PDUs of a log; pitviper inspect --pdus tsv\n"
        "    CASE/record/                     help regress-record  of pitviper regress: how it should be\n"
        "\n"
        "NNNNNN is the frame's number, six digits, from 0: frames lie on whole multiples of 1/rate of "
        "exercise time, and\n"
        "are counted from the first within the host's life, whatever --from says. With several hosts each has its own\n"
        "OUT/SITE-APPLICATION-ENTITY/, or OUT/observer/, of this shape. A file appears whole or not at all;\n"
        "truth.jsonl, pairs.jsonl and manifest.jsonl grow by a line at a time.\n"
        "\n"
        "Frames of reference:\n"
        "\n"
        "    ecef    Earth-centred, Earth-fixed, WGS 84, m: the world coordinates of DIS\n"
        "    ENU     east, north, up at the place that is named\n"
        "    body    of an entity: x forward, y right, z down\n"
        "    camera  x right, y down, z along the boresight\n"
        "    image   column right, row down, in pixels; the first pixel's centre is (0.5, 0.5), so that it "
        "reaches from\n"
        "            (0, 0) to (1, 1). Boxes in whole pixels count from 0 and end before their last two numbers\n"
        "\n"
        "A value that was not computed is absent, never 0. Pixels of the truth planes name entities and parts from\n"
        "1, because 0 is none; all other indices count from 0. Times are exercise time, s, unless UTC is said.",
};

static const ReferenceField fields[] = {
    {"frame", "integer", "", "from 0", "", "number of the frame, as in the names of its files"},
    {"time_s", "number", "s", "exercise time", "", "instant of the frame"},
    {"frame_sha256", "string", "", "", "when hashes are not asked for",
     "SHA-256 of all planes before they are encoded"},
    {"host", "object", "", "", "", "the entity that carries the sensor"},
    {"host.entity", "string", "", "site:application:entity", "", "id, or `observer`: an eye that is no entity"},
    {"host.marking", "string", "", "", "when the host is an observer", "its marking, at most 11 characters"},
    {"host.ecef_m", "list of 3 numbers", "m", "ecef", "", "place of the eye"},
    {"host.lat_deg", "number", "deg", "WGS 84, geodetic", "", "latitude of the eye, north positive"},
    {"host.lon_deg", "number", "deg", "WGS 84", "", "longitude of the eye, east positive"},
    {"host.height_m", "number", "m", "above the WGS 84 ellipsoid", "", "height of the eye"},
    {"host.psi_deg", "number", "deg", "ecef to body, as in an Entity State", "",
     "first Euler angle of the host's body, about z; of an observer: of the camera"},
    {"host.theta_deg", "number", "deg", "ecef to body", "", "second Euler angle, about y"},
    {"host.phi_deg", "number", "deg", "ecef to body", "", "third Euler angle, about x"},
    {"host.speed_mps", "number", "m/s", "over the rotating Earth", "", "speed of the host"},
    {"sun", "object", "", "", "", "where the sun stands"},
    {"sun.azimuth_deg", "number", "deg", "ENU at the eye, from north over east", "", "0 .. 360"},
    {"sun.elevation_deg", "number", "deg", "ENU at the eye", "",
     "above the horizontal, with refraction; below: negative"},
    {"sensors", "list of objects", "", "from 0", "", "one: the bands look through the same optics at the same instant"},
    {"sensors[].name", "string", "", "", "", "`seeker`"},
    {"sensors[].bands", "list of strings", "", "", "", "which of optical, mwir, lwir, radar were made"},
    {"sensors[].width_px", "integer", "px", "", "", "columns"},
    {"sensors[].height_px", "integer", "px", "", "", "rows"},
    {"sensors[].hfov_deg", "number", "deg", "", "", "field of view, of all columns"},
    {"sensors[].vfov_deg", "number", "deg", "", "", "field of view, of all rows"},
    {"sensors[].distortion", "list of 5 numbers", "", "k1, k2, p1, p2, k3 as OpenCV has them",
     "without a lens (sensor.lens_*)", "Brown-Conrady coefficients of tangents of angles; boxes and masks follow"},
    {"sensors[].lateral_colour", "list of 2 numbers", "", "red, blue", "without (sensor.lateral_*)",
     "magnification over green's, less 1"},
    {"sensors[].ecef_from_cam", "list of 9 numbers", "", "row after row; its columns are the camera's x, y, z in ecef",
     "",
     "rotation: ecef = R camera"},
    {"sensors[].gimbal_at_limit", "boolean", "", "", "", "the aim is beyond sensor.gimbal_limit_deg"},
    {"sensors[].scene_rate_px_s", "list of 2 numbers", "px/s", "image: column, row", "",
     "how a thing at rest moves over the middle of the picture"},
    {"targets", "list of objects", "", "by the entity's place in the frame's table", "",
     "every entity in the field of view but the host, hidden ones too"},
    {"targets[].entity", "string", "", "site:application:entity", "", "its id"},
    {"targets[].marking", "string", "", "", "", "its marking, at most 11 characters"},
    {"targets[].type", "string", "", "kind.domain.country.category.subcategory.specific.extra", "", "its entity type"},
    {"targets[].class", "string", "", "", "", "tank, apc, truck ...: its category in coco.json, by its entity type"},
    {"targets[].plane_value", "integer", "", "from 1; 0: none", "", "its value in plane `entity` of the truth EXR"},
    {"targets[].model", "string", "", "", "", "the model that stands for it, a row of etc/catalog.csv"},
    {"targets[].range_m", "number", "m", "", "", "from the eye to the middle of its model"},
    {"targets[].closing_mps", "number", "m/s", "", "", "how fast range_m shrinks"},
    {"targets[].aspect_deg", "number", "deg", "its body; clockwise from above", "",
     "where the eye is, seen from it: 0 nose on, 90 from its right, 0 .. 360"},
    {"targets[].depression_deg", "number", "deg", "ENU at the eye", "",
     "how far below the horizontal it is: -los_el_deg"},
    {"targets[].los_az_deg", "number", "deg", "ENU at the eye, from north over east", "", "line of sight, 0 .. 360"},
    {"targets[].los_el_deg", "number", "deg", "ENU at the eye", "", "line of sight above the horizontal"},
    {"targets[].los_rate_dps", "list of 2 numbers", "deg/s", "camera right, camera up; inertial space", "",
     "rate of the line of sight: what proportional navigation steers by"},
    {"targets[].boresight_error_deg", "list of 2 numbers", "deg", "camera right, camera up", "",
     "line of sight from the boresight"},
    {"targets[].pixels", "number", "px", "", "", "area seen, parts of pixels too; 0: hidden"},
    {"targets[].visible_fraction", "number", "", "0 .. 1", "when no sample met it",
     "share of its area in the picture that is not hidden"},
    {"targets[].box_px", "list of 4 integers", "px", "image: left, top, right, bottom; from 0, the last two beyond it",
     "when it has no pixel of its own", "box of its visible pixels"},
    {"targets[].amodal_box_px", "list of 4 numbers", "px", "image: left, top, right, bottom", "",
     "box of all its vertices, hidden or not, not cut by the picture's edge"},
    {"targets[].occluded_by", "string", "", "site:application:entity, or `ground`", "when nothing hides 1 % of it",
     "what hides most of it"},
    {"targets[].age_s", "number", "s", "", "", "since its last Entity State"},
    {"targets[].position_error_m", "number", "m", "", "", "how far dead reckoning was off when it came"},
    {"targets[].bands", "object", "", "", "", "how it stands out, by band; empty: it is hidden"},
    {"targets[].bands.BAND", "object", "", "", "when the band was not made or it is hidden", "its signal in one band"},
    {"targets[].bands.BAND.contrast_k", "number", "K, apparent", "", "in optical and radar; without a background",
     "mean of its pixels less mean of a ring of its own area about it"},
    {"targets[].bands.BAND.dt_rss_k", "number", "K, apparent", "", "in optical and radar; without a background",
     "root of contrast_k squared and the variance over it"},
    {"targets[].bands.BAND.contrast", "number", "", "", "in mwir and lwir; without a background",
     "the same difference over the ring's mean"},
    {"targets[].bands.BAND.snr", "number", "", "", "without a background, or without clutter and noise",
     "contrast over the ring's standard deviation and the detector's noise together"},
    {"targets[].bands.BAND.veil_transmittance", "number", "", "0 .. 1", "in radar",
     "what smoke and dust before it let through; 1: none"},
    {"targets[].bands.BAND.intensity_w_sr", "number", "W/sr", "in-band, at the aperture", "in radar",
     "its radiance by the area that it fills"},
    {"targets[].bands.BAND.intensity_error_w_sr", "number", "W/sr", "",
     "in radar, of a target that is not small, with quality.budget off", "rms of the sampling in it"},
    {"error", "object", "", "", "with quality.budget off", "the frame's own estimate of how wrong it is"},
    {"error.BAND", "object", "", "", "when the band was not made", "rms over the picture"},
    {"error.BAND.sampling", "number", "", "share of the band's mean", "", "too few rays a pixel"},
    {"error.BAND.level_of_detail", "number", "", "share of the band's mean", "", "ground and models in coarser form"},
    {"error.BAND.table", "number", "", "share of the band's mean", "", "tables of air and Planck's law"},
    {"error.BAND.dead_reckoning", "number", "", "share of the band's mean", "", "entities not where they are shown"},
    {"error.BAND.total", "number", "", "share of the band's mean", "", "all of these together"},
    {"error.BAND.sampling_k", "number", "K, apparent", "", "in optical and radar", "the same in temperature"},
    {"error.BAND.level_of_detail_k", "number", "K, apparent", "", "in optical and radar", "the same in temperature"},
    {"error.BAND.table_k", "number", "K, apparent", "", "in optical and radar", "the same in temperature"},
    {"error.BAND.dead_reckoning_k", "number", "K, apparent", "", "in optical and radar", "the same in temperature"},
    {"error.BAND.total_k", "number", "K, apparent", "", "in optical and radar", "the same in temperature"},
};

static const ReferenceWord words[] = {REFERENCE_WORD_BAND};

const Reference reference_truth = {
    .topic = "truth",
    .file  = "truth.jsonl",
    .title = "targets in the picture, where, and how bright: a line of JSON a frame",
    .about = "JSON Lines: each line is one object. A frame is in it as soon as it is made.",
    .field = REFERENCE_FIELDS(fields),
    .word  = REFERENCE_FIELDS(words),
    .python =
        "import json\n"
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
