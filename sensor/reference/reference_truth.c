/* sensor/reference/reference_truth.c: fields of truth.jsonl, and the list of all products. */
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

static const ReferenceField fields[] = {
    {"frame", "integer", "", "from 0", "", "number of the frame, as in the names of its files"},
    {"time_s", "number", "s", "exercise time", "", "instant of the frame"},
    {"frame_sha256", "string", "", "", "when hashes are not requested",
     "SHA-256 of all planes before they are encoded"},
    {"host", "object", "", "", "", "the entity that carries the sensor"},
    {"host.entity", "string", "", "site:application:entity", "",
     "id, or `observer`: a sensor position that is no "
     "entity"},
    {"host.marking", "string", "", "", "when the host is an observer", "its marking, at most 11 characters"},
    {"host.ecef_m", "list of 3 numbers", "m", "ecef", "", "position of the sensor"},
    {"host.lat_deg", "number", "deg", "WGS 84, geodetic", "", "latitude of the sensor, north positive"},
    {"host.lon_deg", "number", "deg", "WGS 84", "", "longitude of the sensor, east positive"},
    {"host.height_m", "number", "m", "above the WGS 84 ellipsoid", "", "height of the sensor"},
    {"host.psi_deg", "number", "deg", "ecef to body, as in an Entity State", "",
     "first Euler angle of the host's body, about z; of an observer: of the camera"},
    {"host.theta_deg", "number", "deg", "ecef to body", "", "second Euler angle, about y"},
    {"host.phi_deg", "number", "deg", "ecef to body", "", "third Euler angle, about x"},
    {"host.speed_mps", "number", "m/s", "relative to the rotating Earth", "", "speed of the host"},
    {"sun", "object", "", "", "", "direction of the sun"},
    {"sun.azimuth_deg", "number", "deg", "ENU at the sensor, from north over east", "", "0 .. 360"},
    {"sun.elevation_deg", "number", "deg", "ENU at the sensor", "", "above the horizontal, with refraction"},
    {"sensors", "list of objects", "", "from 0", "", "one: all bands share the optics and the instant"},
    {"sensors[].name", "string", "", "", "", "`seeker`"},
    {"sensors[].bands", "list of strings", "", "", "", "which of optical, mwir, lwir, radar were rendered"},
    {"sensors[].width_px", "integer", "px", "", "", "columns"},
    {"sensors[].height_px", "integer", "px", "", "", "rows"},
    {"sensors[].hfov_deg", "number", "deg", "", "", "horizontal field of view"},
    {"sensors[].vfov_deg", "number", "deg", "", "", "vertical field of view"},
    {"sensors[].distortion", "list of 5 numbers", "", "k1, k2, p1, p2, k3 as OpenCV has them",
     "without a lens (sensor.lens_*)", "Brown-Conrady coefficients of tangents of angles; boxes and masks follow"},
    {"sensors[].lateral_colour", "list of 2 numbers", "", "red, blue", "without (sensor.lateral_*)",
     "magnification relative to green, minus 1"},
    {"sensors[].ecef_from_cam", "list of 9 numbers", "", "row by row; its columns are the camera's x, y, z in ecef", "",
     "rotation: ecef = R camera"},
    {"sensors[].gimbal_at_limit", "boolean", "", "", "", "the aim point is beyond sensor.gimbal_limit_deg"},
    {"sensors[].scene_rate_px_s", "list of 2 numbers", "px/s", "image: column, row", "",
     "image motion of a stationary object at the image centre"},
    {"targets", "list of objects", "", "in the order of the frame's entity table", "",
     "every entity in the field of view except the host, occluded ones too"},
    {"targets[].entity", "string", "", "site:application:entity", "", "its id"},
    {"targets[].marking", "string", "", "", "", "its marking, at most 11 characters"},
    {"targets[].type", "string", "", "kind.domain.country.category.subcategory.specific.extra", "", "its entity type"},
    {"targets[].class", "string", "", "", "", "tank, apc, truck ...: its category in coco.json, by its entity type"},
    {"targets[].plane_value", "integer", "", "from 1; 0: none", "", "its value in plane `entity` of the truth EXR"},
    {"targets[].model", "string", "", "", "", "its model, a row of etc/catalog.csv"},
    {"targets[].range_m", "number", "m", "", "", "from the sensor to the centre of its model"},
    {"targets[].closing_mps", "number", "m/s", "", "", "closing speed: -d(range_m)/dt"},
    {"targets[].aspect_deg", "number", "deg", "its body; clockwise from above", "",
     "direction of the sensor from the target: 0 nose on, 90 from its right, 0 .. 360"},
    {"targets[].depression_deg", "number", "deg", "ENU at the sensor", "", "angle below the horizontal: -los_el_deg"},
    {"targets[].los_az_deg", "number", "deg", "ENU at the sensor, from north over east", "", "line of sight, 0 .. 360"},
    {"targets[].los_el_deg", "number", "deg", "ENU at the sensor", "", "line of sight above the horizontal"},
    {"targets[].los_rate_dps", "list of 2 numbers", "deg/s", "camera right, camera up; inertial space", "",
     "rate of the line of sight, as used by proportional navigation"},
    {"targets[].boresight_error_deg", "list of 2 numbers", "deg", "camera right, camera up", "",
     "line of sight from the boresight"},
    {"targets[].pixels", "number", "px", "", "", "visible area with fractions of pixels; 0: occluded"},
    {"targets[].visible_fraction", "number", "", "0 .. 1", "when no sample hit it",
     "share of its projected area that is not occluded"},
    {"targets[].foliage_fraction", "number", "", "0 .. 1", "with terrain.woods off; when no sample hit it",
     "share of its projected area that plants hide"},
    {"targets[].box_px", "list of 4 integers", "px", "image: left, top, right, bottom; from 0, the last two beyond it",
     "when it has no pixel of its own", "bounding box of its visible pixels"},
    {"targets[].amodal_box_px", "list of 4 numbers", "px", "image: left, top, right, bottom", "",
     "bounding box of all its vertices, occluded or not, not cropped by the image"},
    {"targets[].occluded_by", "string", "", "site:application:entity, `ground`, or `trees`",
     "when less than 1 % of it is "
     "occluded",
     "what occludes most of it"},
    {"targets[].dt_k", "number", "K", "", "without thermal history",
     "mean temperature of its surface, by area, less "
     "that of open ground where it is"},
    {"targets[].patch_temp_k", "list of numbers", "K", "in the order of `pitviper heat MODEL`",
     "without thermal history", "temperature of each patch of its surface, also of those that are not seen"},
    {"targets[].age_s", "number", "s", "", "", "since its last Entity State"},
    {"targets[].position_error_m", "number", "m", "", "", "error of dead reckoning when it was received"},
    {"targets[].error_px", "number", "px", "", "when it is occluded; with quality.budget off",
     "its own error of position: rms displacement on the image by dead reckoning, facets and the ground"},
    {"targets[].bands", "object", "", "", "", "signal by band; empty: it is occluded"},
    {"targets[].bands.BAND", "object", "", "", "when the band was not rendered or it is occluded",
     "its signal in one "
     "band"},
    {"targets[].bands.BAND.contrast_k", "number", "K, apparent", "", "in optical and radar; without a background",
     "mean of its pixels minus mean of a ring of equal area around it"},
    {"targets[].bands.BAND.dt_rss_k", "number", "K, apparent", "", "in optical and radar; without a background",
     "root of contrast_k squared plus the variance over the target"},
    {"targets[].bands.BAND.contrast", "number", "", "", "in mwir and lwir; without a background",
     "the same difference divided by the mean of the ring"},
    {"targets[].bands.BAND.snr", "number", "", "",
     "without a background (not in optical); with a contrast, but neither clutter nor noise",
     "contrast divided by the rms sum of the ring's standard deviation and the detector's noise; in optical at least 5e-5 "
     "W/(m2 sr) of it without a sensor: a dark image shows nothing. Optical, where nothing surrounds it: its mean over the noise"},
    {"targets[].bands.BAND.veil_transmittance", "number", "", "0 .. 1", "in radar",
     "path transmittance of smoke and dust in front of it; 1: none"},
    {"targets[].bands.BAND.intensity_w_sr", "number", "W/sr", "in-band, at the aperture", "in radar",
     "its radiance times its area"},
    {"targets[].bands.BAND.intensity_error_w_sr", "number", "W/sr", "",
     "in radar, of a target that is not small, with quality.budget off", "rms sampling error of intensity_w_sr"},
    {"targets[].bands.BAND.error_rms_k", "number", "K, apparent", "", "in optical and radar; with quality.budget off",
     "its own error: rms over its pixels, by that displacement, heat and tables"},
    {"targets[].bands.BAND.error_median_k", "number", "K, apparent", "",
     "in optical and radar; with quality.budget off", "the same, median of its pixels' expected errors"},
    {"error", "object", "", "", "with quality.budget off", "the frame's estimate of its own error"},
    {"error.BAND", "object", "", "",
     "when the band was not rendered; of the pseudo-radar, whose mean is that of a few mirrors",
     "rms over the image: that of the brightest pixels, if these may be off"},
    {"error.BAND.median_k", "number", "K, apparent", "", "in optical",
     "median of the pixels' expected errors: half of them are better"},
    {"error.BAND.beyond_1k", "number", "share of the image", "0 .. 1", "in optical",
     "pixels that are expected to be off by more than 1 K"},
    {"error.BAND.sampling", "number", "", "share of the band's mean", "", "finite number of rays per pixel"},
    {"error.BAND.level_of_detail", "number", "", "share of the band's mean", "",
     "level of detail of ground and "
     "models"},
    {"error.BAND.table", "number", "", "share of the band's mean", "",
     "interpolation in tables of the atmosphere and "
     "Planck's law"},
    {"error.BAND.heat", "number", "", "share of the band's mean", "",
     "steps, elements and facets of the heat of ground and "
     "parts; 0 in optical"},
    {"error.BAND.dead_reckoning", "number", "", "share of the band's mean", "",
     "position errors of dead-reckoned "
     "entities"},
    {"error.BAND.total", "number", "", "share of the band's mean", "", "total of these"},
    {"error.BAND.sampling_k", "number", "K, apparent", "", "in optical", "the same in temperature"},
    {"error.BAND.level_of_detail_k", "number", "K, apparent", "", "in optical", "the same in temperature"},
    {"error.BAND.table_k", "number", "K, apparent", "", "in optical", "the same in temperature"},
    {"error.BAND.heat_k", "number", "K, apparent", "", "in optical", "the same in temperature"},
    {"error.BAND.dead_reckoning_k", "number", "K, apparent", "", "in optical", "the same in temperature"},
    {"error.BAND.total_k", "number", "K, apparent", "", "in optical", "the same in temperature"},
    {"error.range_doppler", "object", "", "", "with radar.preset none",
     "the same of the radar's map, rms over the cells of its sum channel"},
    {"error.range_doppler.sampling", "number", "", "share of the cells' rms", "", "grid of ray tubes on entities"},
    {"error.range_doppler.level_of_detail", "number", "", "share of the cells' rms", "",
     "scattering centres in place of what the tubes hit"},
    {"error.range_doppler.table", "number", "", "share of the cells' rms", "",
     "gridding of echoes over delay and Doppler"},
    {"error.range_doppler.dead_reckoning", "number", "", "share of the cells' rms", "",
     "position errors of dead-reckoned entities along the line of sight: of the cells' magnitudes"},
    {"error.range_doppler.total", "number", "", "share of the cells' rms", "", "total of these"},
    {"error.range_doppler.sampling_db", "number", "dB", "", "without an entity in sight, or of given signatures alone",
     "the same of an entity's cross section, and of a detection's: one standard deviation"},
    {"error.range_doppler.level_of_detail_db", "number", "dB", "", "likewise", "likewise"},
    {"error.range_doppler.table_db", "number", "dB", "", "likewise", "likewise"},
    {"error.range_doppler.total_db", "number", "dB", "", "likewise", "likewise, of these three"},
    {"radar", "object", "", "", "with radar.preset none",
     "what the radar on the sensor's axis measured, and the truth of it"},
    {"radar.preset", "string", "", "", "", "row of etc/radars.csv or radar.table"},
    {"radar.waveform", "object", "", "", "", "its times, and what they limit (etc/reference/radar_waveforms.md)"},
    {"radar.waveform.kind", "string", "", "", "", "lfm, stepped, pulse_doppler or fmcw"},
    {"radar.waveform.pulse_us", "number", "us", "", "", "length of a pulse; of fmcw of a sweep"},
    {"radar.waveform.sample_us", "number", "us", "", "", "from one frequency of a profile to the next; 0: at once"},
    {"radar.waveform.profile_ms", "number", "ms", "", "", "over which a range profile is taken"},
    {"radar.waveform.row_ms", "number", "ms", "", "", "from one profile to the next"},
    {"radar.waveform.interval_ms", "number", "ms", "", "", "coherent interval, about the frame's time"},
    {"radar.waveform.window_m", "number", "m", "", "", "width of the range window"},
    {"radar.waveform.unambiguous_m", "number", "m", "", "", "range by which echoes fold over"},
    {"radar.waveform.blind_mps", "number", "m/s", "", "",
     "range rates apart by it look alike; its multiples from the ground are blind "
     "speeds"},
    {"radar.waveform.coupling_s", "number", "s", "", "",
     "an echo appears farther by it times its range rate over the reference's"},
    {"radar.waveform.smear_s", "number", "s", "", "", "and is smeared in range over it times the same rate"},
    {"radar.waveform.beat_hz_m", "number", "Hz/m", "", "", "beat frequency of lfm, deramped, and fmcw; else 0"},
    {"radar.reference_m", "number", "m", "from the sensor", "",
     "middle of the range window: the aim, else the ground ahead"},
    {"radar.reference_rate_mps", "number", "m/s", "above 0: receding", "", "range rate in the middle of the map"},
    {"radar.ground_rate_mps", "number", "m/s", "above 0: receding", "", "of still ground on the axis"},
    {"radar.notch_mps", "number", "m/s", "", "",
     "detections so near to the ground's range rate in their direction count as ground"},
    {"radar.air_db", "number", "dB", "one way", "", "loss by gases, rain and fog over that range"},
    {"radar.noise_dbw", "number", "dB over 1 W", "", "", "thermal noise in a cell of the map"},
    {"radar.saturated", "integer", "", "", "", "I and Q values at the end of the converter's range"},
    {"radar.ground_cells", "integer", "", "", "", "scatterers of the ground within main lobe and window"},
    {"radar.ground_hidden", "integer", "", "", "", "of these, hidden by relief or entities"},
    {"radar.plants", "integer", "", "", "", "plants within main lobe and window, which return from their crowns"},
    {"radar.chaff", "integer", "", "", "", "clouds of chaff within beam and window"},
    {"radar.rain_1_m", "number", "m2/m3", "", "", "backscatter of the rain by its volume; 0: none falls"},
    {"radar.map_sha256", "string", "", "", "", "SHA-256 of the map of all channels, before it is rounded for a file"},
    {"radar.scan", "object", "", "", "with radar.scan_deg 0", "how the beam scanned"},
    {"radar.scan.positions", "integer", "", "", "",
     "of the beam, an odd number; the middle one is the frame's interval"},
    {"radar.scan.step_deg", "number", "deg", "", "", "between positions, left to right, about the camera's rows axis"},
    {"radar.scan.interval_s", "number", "s", "", "", "from one position to the next"},
    {"radar.scan.beam_deg", "number", "deg", "", "", "width of the two-way beam at half power"},
    {"radar.scan.noise_dbw", "number", "dB over 1 W", "", "", "thermal noise in a cell of the real-beam image"},
    {"radar.scan.sharpened_share", "number", "", "0 .. 1", "",
     "of the sharpened image's cells where Doppler is finer than the beam"},
    {"radar.scan.sha256", "string", "", "", "",
     "SHA-256 of both images over range and azimuth, before they are rounded for a file"},
    {"radar.detections", "list of objects", "", "strongest first, at most 256", "",
     "peaks over the threshold of constant false "
     "alarms"},
    {"radar.detections[].range_m", "number", "m", "from the sensor", "", "between cells"},
    {"radar.detections[].range_rate_mps", "number", "m/s", "above 0: receding", "",
     "between cells; folds over at half of the map"},
    {"radar.detections[].az_deg", "number", "deg", "camera, right positive", "", "by monopulse"},
    {"radar.detections[].el_deg", "number", "deg", "camera, up positive", "", "by monopulse"},
    {"radar.detections[].snr_db", "number", "dB", "", "", "over the noise and clutter about it"},
    {"radar.detections[].rcs_dbsm", "number", "dB over 1 m2", "", "",
     "by the radar equation, as one point where it was found"},
    {"radar.detections[].moving", "boolean", "", "", "", "clear of the ground's range rate by more than notch_mps"},
    {"radar.detections_in_all", "integer", "", "", "", "how many passed the threshold"},
    {"radar.targets", "list of objects", "", "", "", "truth of each entity near beam and window, in order of ids"},
    {"radar.targets[].entity", "string", "", "site:application:entity", "", "id"},
    {"radar.targets[].range_m", "number", "m", "from the sensor", "", "to the origin of its model"},
    {"radar.targets[].range_rate_mps", "number", "m/s", "above 0: receding", "", "of that origin"},
    {"radar.targets[].appears_m", "number", "m", "from the sensor", "",
     "range at which the profile has that origin: folded over, and "
     "coupled to its range rate"},
    {"radar.targets[].az_deg", "number", "deg", "camera, right positive", "", "direction of that origin"},
    {"radar.targets[].el_deg", "number", "deg", "camera, up positive", "", "likewise"},
    {"radar.targets[].signature", "string", "", "model, given", "", "by its model, or by a signature of radar.given"},
    {"radar.targets[].visible_fraction", "number", "", "0 .. 1", "",
     "share of its scattering centres' power in sight: those centres "
     "alone return"},
    {"radar.targets[].rcs_dbsm", "object", "", "", "",
     "cross section at the centre frequency, as if wholly in sight, without the ground"},
    {"radar.targets[].rcs_dbsm.hh", "number", "dB over 1 m2", "received, transmitted", "when it is 0",
     "h along the camera's columns"},
    {"radar.targets[].rcs_dbsm.vv", "number", "dB over 1 m2", "", "when it is 0", "v along its rows"},
    {"radar.targets[].rcs_dbsm.hv", "number", "dB over 1 m2", "", "when it is 0", "received h, transmitted v"},
    {"radar.targets[].rcs_error_db", "object", "", "", "of a given signature",
     "estimated standard deviation of these, by the grid of ray "
     "tubes alone: not by the model or physical optics"},
    {"radar.targets[].rcs_error_db.hh", "number", "dB", "", "when it scatters nothing back", "of HH"},
    {"radar.targets[].rcs_error_db.vv", "number", "dB", "", "when it scatters nothing back", "of VV"},
    {"radar.targets[].rcs_error_db.hv", "number", "dB", "", "when it scatters nothing back", "of HV"},
    {"radar.targets[].map_error_db", "number", "dB", "", "of a given signature",
     "error of its cells of the map, over its power in them: by "
     "ray tubes and by scattering centres"},
    {"radar.targets[].snr_db", "number", "dB", "", "when none of it is in sight",
     "by the radar equation, of its centres in sight in "
     "one cell, over the thermal noise of a cell"},
    {"radar.targets[].centres", "integer", "", "", "", "scattering centres that it was summed from"},
    {"radar.targets[].ground_bounce", "object", "", "", "where the ground near it mirrors too little, or out of sight",
     "what the ground near it mirrors; as if wholly in sight"},
    {"radar.targets[].ground_bounce.coherence", "number", "", "0.001 .. 1", "",
     "share of the amplitude that the ground mirrors, roughness included; the larger of both polarisations"},
    {"radar.targets[].ground_bounce.rcs_dbsm", "object", "", "", "",
     "cross section by all paths together, the direct one included"},
    {"radar.targets[].ground_bounce.rcs_dbsm.hh", "number", "dB over 1 m2", "", "when it is 0", "likewise"},
    {"radar.targets[].ground_bounce.rcs_dbsm.vv", "number", "dB over 1 m2", "", "when it is 0", "likewise"},
    {"radar.targets[].ground_bounce.rcs_dbsm.hv", "number", "dB over 1 m2", "", "when it is 0", "likewise"},
    {"radar.targets[].ground_bounce.once_dbsm", "object", "", "", "",
     "by the ground one way alone, both ways round together"},
    {"radar.targets[].ground_bounce.once_dbsm.hh", "number", "dB over 1 m2", "", "when it is 0", "likewise"},
    {"radar.targets[].ground_bounce.once_dbsm.vv", "number", "dB over 1 m2", "", "when it is 0", "likewise"},
    {"radar.targets[].ground_bounce.once_dbsm.hv", "number", "dB over 1 m2", "", "when it is 0", "likewise"},
    {"radar.targets[].ground_bounce.twice_dbsm", "object", "", "", "", "by the ground both ways alone"},
    {"radar.targets[].ground_bounce.twice_dbsm.hh", "number", "dB over 1 m2", "", "when it is 0", "likewise"},
    {"radar.targets[].ground_bounce.twice_dbsm.vv", "number", "dB over 1 m2", "", "when it is 0", "likewise"},
    {"radar.targets[].ground_bounce.twice_dbsm.hv", "number", "dB over 1 m2", "", "when it is 0", "likewise"},
    {"radar.targets[].strongest", "list of objects", "", "strongest first, at most 8", "",
     "the strongest of them, by the mean of HH and "
     "VV"},
    {"radar.targets[].strongest[].rcs_hh_dbsm", "number", "dB over 1 m2", "", "when it returns nothing so",
     "its cross section"},
    {"radar.targets[].strongest[].rcs_vv_dbsm", "number", "dB over 1 m2", "", "when it returns nothing so",
     "its cross section"},
    {"radar.targets[].strongest[].body_m", "list of 3 numbers", "m", "body", "",
     "middle of its path's first and last mirror"},
    {"radar.targets[].strongest[].bounces", "integer", "", "0: an edge", "", "mirrors on its path"},
    {"radar.targets[].strongest[].visible", "boolean", "", "", "", "nothing else is in its way"},
    {"radar.targets[].strongest[].part", "string", "", "", "of a given signature",
     "part of the model with the last mirror"},
    {"latency_ms", "object", "", "", "in a replay at full speed",
     "when each step of the frame was done; of a run and of replay --speed X"},
    {"latency_ms.arrival_to_pose", "number", "ms", "", "before the first datagram",
     "from the arrival of the newest datagram that the frame used until the sensor's pose was sampled"},
    {"latency_ms.pose_to_render", "number", "ms", "", "", "from then until rendering began"},
    {"latency_ms.render", "number", "ms", "", "", "rendering, with the truth of targets where it is requested"},
    {"latency_ms.display", "number", "ms", "after the end of rendering",
     "when no consumer takes displays, or not done two frames later", "displays made: the detector, gain and level"},
    {"latency_ms.consumers", "object", "", "", "", "by consumer of the frame"},
    {"latency_ms.consumers.CONSUMER", "number", "ms", "after the end of rendering",
     "when it was not given the frame, or not done two frames later", "the consumer was done with the frame"},
};

static const ReferenceWord words[] = {REFERENCE_WORD_BAND, REFERENCE_WORD_CONSUMER};

const Reference reference_truth = {
    .topic = "truth",
    .file = "truth.jsonl",
    .title = "targets in the image, their position and signal: a line of JSON per frame",
    .about =
        "JSON Lines: each line is one object. A line is appended when its frame is complete; with latency_ms, when\n"
        "all its consumers are done with the frame, at the latest two frames later.",
    .field = REFERENCE_FIELDS(fields),
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
