/* sensor/settings/config_table.c: the table of all settings, and their defaults. */

#include "sensor/settings/config_private.h"

#include "terrain/woods/woods.h"

#define AT(member) SETTING_AT(Config, member)

static const Setting keys[] = {
    {"sensor.width_px", SETTING_INT, AT(sensor.width_px), 8, 8192, NULL, "px", "columns of the image"},
    {"sensor.height_px", SETTING_INT, AT(sensor.height_px), 8, 8192, NULL, "px", "rows of the image"},
    {"sensor.hfov_deg", SETTING_DOUBLE, AT(sensor.hfov_deg), 0.01, 120, NULL, "deg", "horizontal field of view"},
    {"sensor.rate_hz", SETTING_DOUBLE, AT(sensor.rate_hz), 0, 1000, NULL, "Hz",
     "frames per second; 0: 5 for a munition, 1 for an observer"},
    {"sensor.samples", SETTING_INT, AT(sensor.samples), 1, 16, NULL, "",
     "rays along each side of a pixel: N x N rays per pixel"},
    {"sensor.antialias", SETTING_TEXT, AT(sensor.antialias), 0, 0, "adaptive|off", "",
     "antialiasing; adaptive: more rays at edges and over small targets; off: the same number everywhere"},
    {"sensor.edge_samples", SETTING_INT, AT(sensor.edge_samples), 2, 16, NULL, "",
     "rays along each side of a pixel that differs from its neighbours; adaptive only"},
    {"sensor.target_samples", SETTING_INT, AT(sensor.target_samples), 8, 256, NULL, "",
     "rays along each side of the grid over a target below 16 px; adaptive only"},
    {"sensor.bands", SETTING_WORDS, AT(sensor.bands), 0, 0, NULL, "",
     "any of optical,mwir,lwir,radar, and further channels of etc/channels.csv in the place of one of these: swir"},
    {"sensor.optical", SETTING_TEXT, AT(sensor.optical), 0, 0, "rgb|pan|nir", "",
     "three visible channels, one panchromatic, or one of 0.7-1.1 um"},
    {"sensor.sky_samples", SETTING_INT, AT(sensor.sky_samples), 0, 4096, NULL, "",
     "directions of incident light sampled at each hit; 0: closed form by slope, with sky_visibility"},
    {"sensor.sky_visibility", SETTING_TEXT, AT(sensor.sky_visibility), 0, 0, "on|off", "",
     "contact shadows: entities occlude sky and ground near them"},
    {"sensor.gimbal_limit_deg", SETTING_DOUBLE, AT(sensor.gimbal_limit_deg), 0, 180, NULL, "deg",
     "largest angle off the body axis"},
    {"sensor.gimbal_rate_dps", SETTING_DOUBLE, AT(sensor.gimbal_rate_dps), 0.01, 10000, NULL, "deg/s",
     "largest slew rate"},
    {"sensor.gimbal_lag_s", SETTING_DOUBLE, AT(sensor.gimbal_lag_s), 0, 10, NULL, "s",
     "time constant of the tracking loop"},
    {"sensor.mount", SETTING_TEXT, AT(sensor.mount), 0, 0, NULL, "",
     "what the sensor is mounted on: auto (nose or roof), or a part of the host: primary turret, primary gun 2, the "
     "name of a node"},
    {"sensor.mount_x_m", SETTING_DOUBLE, AT(sensor.mount_x_m), -500, 500, NULL, "m",
     "forward offset from the body's origin or the part's pivot; unset: nose or roof, for a part 0"},
    {"sensor.mount_y_m", SETTING_DOUBLE, AT(sensor.mount_y_m), -500, 500, NULL, "m", "offset to the right"},
    {"sensor.mount_z_m", SETTING_DOUBLE, AT(sensor.mount_z_m), -500, 500, NULL, "m", "offset down"},
    {"sensor.mount_yaw_deg", SETTING_DOUBLE, AT(sensor.mount_yaw_deg), -180, 180, NULL, "deg",
     "gimbal axis: yaw, right of forward"},
    {"sensor.mount_pitch_deg", SETTING_DOUBLE, AT(sensor.mount_pitch_deg), -90, 90, NULL, "deg", "then pitch, up"},
    {"sensor.mount_roll_deg", SETTING_DOUBLE, AT(sensor.mount_roll_deg), -180, 180, NULL, "deg",
     "roll of the stabilised image against upright, right side down"},
    {"sensor.preset", SETTING_WORDS, AT(sensor.preset), 0, 0, NULL, "",
     "none, or rows of etc/sensors.csv, one per band, separated by commas, or a list: staring_lwir,staring_mwir,tv"},
    {"sensor.table", SETTING_PATH, AT(sensor.table), 0, 0, NULL, "",
     "a sensor's data sheet with FLIR92's entries (etc/sensors/example_flir2.sheet), which takes precedence over "
     "sensor.preset; or a .csv with the columns of etc/sensors.csv, whose rows sensor.preset may name"},
    {"sensor.lens_k1", SETTING_DOUBLE, AT(sensor.lens_k1), -1e6, 1e6, NULL, "",
     "radial distortion of all bands (Brown-Conrady, as OpenCV; tangents of angles off the axis); overrides the "
     "first preset"},
    {"sensor.lens_k2", SETTING_DOUBLE, AT(sensor.lens_k2), -1e9, 1e9, NULL, "", "radial distortion, fourth order"},
    {"sensor.lens_k3", SETTING_DOUBLE, AT(sensor.lens_k3), -1e12, 1e12, NULL, "", "radial distortion, sixth order"},
    {"sensor.lens_p1", SETTING_DOUBLE, AT(sensor.lens_p1), -1e3, 1e3, NULL, "", "tangential distortion p1"},
    {"sensor.lens_p2", SETTING_DOUBLE, AT(sensor.lens_p2), -1e3, 1e3, NULL, "", "tangential distortion p2"},
    {"sensor.lateral_r", SETTING_DOUBLE, AT(sensor.lateral_r), -0.02, 0.02, NULL, "",
     "lateral colour of rgb: magnification of R relative to G, minus 1; each channel is then traced by itself"},
    {"sensor.lateral_b", SETTING_DOUBLE, AT(sensor.lateral_b), -0.02, 0.02, NULL, "", "the same for B"},
    {"detector.bits", SETTING_INT, AT(detector.bits), 8, 16, NULL, "", "bits of the PNG images: 8 or 16"},
    {"detector.level", SETTING_TEXT, AT(detector.level), 0, 0, "auto|plateau|manual", "",
     "gain and level of display images; auto: set per frame (detector.agc_s), linear; plateau: plateau equalisation of mwir "
     "and lwir, as in thermal cameras; manual: as configured"},
    {"detector.plateau", SETTING_DOUBLE, AT(detector.plateau), 1e-6, 1, NULL, "",
     "detector.level plateau: share of the pixels that counts in a bin of 0.03 K; 1: histogram equalisation"},
    {"detector.gain", SETTING_DOUBLE, AT(detector.gain), 0.01, 100, NULL, "", "contrast gain about mid-level"},
    {"detector.offset", SETTING_DOUBLE, AT(detector.offset), -1, 1, NULL, "", "brightness offset, in full scales"},
    {"detector.noise_optical", SETTING_DOUBLE, AT(detector.noise_optical), 0, 1, NULL, "",
     "noise sigma as a share of the mean"},
    {"detector.netd_mwir_k", SETTING_DOUBLE, AT(detector.netd_mwir_k), 0, 10, NULL, "K",
     "noise equivalent temperature difference at 300 K"},
    {"detector.netd_lwir_k", SETTING_DOUBLE, AT(detector.netd_lwir_k), 0, 10, NULL, "K", "the same for lwir"},
    {"detector.mwir_low_k", SETTING_DOUBLE, AT(detector.mwir_low_k), 150, 2000, NULL, "K",
     "apparent temperature shown as black; manual level"},
    {"detector.mwir_high_k", SETTING_DOUBLE, AT(detector.mwir_high_k), 150, 2000, NULL, "K",
     "apparent temperature shown as white; manual level"},
    {"detector.lwir_low_k", SETTING_DOUBLE, AT(detector.lwir_low_k), 150, 2000, NULL, "K",
     "apparent temperature shown as black; manual level"},
    {"detector.lwir_high_k", SETTING_DOUBLE, AT(detector.lwir_high_k), 150, 2000, NULL, "K",
     "apparent temperature shown as white; manual level"},
    {"detector.optical_high_w_m2_sr", SETTING_DOUBLE, AT(detector.optical_high_w_m2_sr), 1e-3, 1e4, NULL, "W/(m2 sr)",
     "radiance shown as white; manual level"},
    {"detector.agc_s", SETTING_DOUBLE, AT(detector.agc_s), 0, 1000, NULL, "s",
     "time constant of the automatic level, from the first frame rendered; a tenth of it applies where the image "
     "would be nearly black or white; 0: gain and level set per frame"},
    {"detector.noise", SETTING_DOUBLE, AT(detector.noise), 0, 100, NULL, "", "factor on all noise; 0: none"},
    {"detector.f_number", SETTING_DOUBLE, AT(detector.f_number), 0.5, 100, NULL, "", "overrides the preset"},
    {"detector.obscuration", SETTING_DOUBLE, AT(detector.obscuration), 0, 0.95, NULL, "",
     "central obscuration, share of the aperture's diameter; overrides the preset"},
    {"detector.integration_ms", SETTING_DOUBLE, AT(detector.integration_ms), 1e-6, 1e4, NULL, "ms",
     "integration time; overrides the preset"},
    {"detector.jitter_px", SETTING_DOUBLE, AT(detector.jitter_px), 0, 10, NULL, "px",
     "rms line-of-sight jitter per axis within the integration time; overrides the preset"},
    {"detector.bad_share", SETTING_DOUBLE, AT(detector.bad_share), 0, 0.2, NULL, "",
     "share of defective pixels; overrides the preset"},
    {"detector.ac_per_line", SETTING_DOUBLE, AT(detector.ac_per_line), 0, 100, NULL, "",
     "cut-off frequency of the AC coupling times line time; overrides the preset"},
    {"detector.line_noise", SETTING_DOUBLE, AT(detector.line_noise), 0, 100, NULL, "",
     "rms of noise along lines relative to that of a pixel; overrides the preset"},
    {"detector.smear", SETTING_BOOL, AT(detector.smear), 0, 1, NULL, "",
     "motion within the integration time and between lines; with a preset"},
    {"detector.raw", SETTING_BOOL, AT(detector.raw), 0, 1, NULL, "", "write files of raw counts; with a preset"},
    {"radar.bin_m", SETTING_DOUBLE, AT(radar.bin_m), 0.01, 100, NULL, "m", "range bin of the range profile"},
    {"radar.bins", SETTING_INT, AT(radar.bins), 16, 65536, NULL, "", "number of range bins, centred on the aim point"},
    {"radar.lobe_deg", SETTING_DOUBLE, AT(radar.lobe_deg), 0.2, 30, NULL, "deg",
     "rms half width of the scattering lobe"},
    {"radar.preset", SETTING_TEXT, AT(radar.preset), 0, 0, NULL, "",
     "none, or a row of etc/radars.csv: a radar with phase on the sensor's axis, whose range profiles, maps of range and Doppler "
     "and detections are products"},
    {"radar.table", SETTING_PATH, AT(radar.table), 0, 0, NULL, "",
     "a .csv with the columns of etc/radars.csv, whose rows radar.preset names in place of those"},
    {"radar.ground", SETTING_BOOL, AT(radar.ground), 0, 1, NULL, "",
     "that radar's echoes of ground and plants; with a preset"},
    {"radar.ground_bounce", SETTING_BOOL, AT(radar.ground_bounce), 0, 1, NULL, "",
     "reflections of that radar's waves by the ground near entities, on the way in and out; with a preset"},
    {"radar.chaff_dipoles", SETTING_DOUBLE, AT(radar.chaff_dipoles), 0, 1e10, NULL, "",
     "dipoles in resonance with that radar in a cloud of chaff (type 8.*.*.1 or .3); 0: chaff is not seen"},
    {"radar.warp_mm", SETTING_DOUBLE, AT(radar.warp_mm), 0, 20, NULL, "mm",
     "unevenness of entities' surfaces for that radar, rms over 0.5 m: models are flatter than real sheet metal; 0: unchanged"},
    {"radar.given", SETTING_PATH, AT(radar.given), 0, 0, NULL, "",
     "CSV file of signatures for that radar, measured or from another program, that replace those of models; empty: none"},
    {"radar.library", SETTING_PATH, AT(radar.library), 0, 0, NULL, "",
     "folder of targets' signatures for that radar (`pitviper rcs MODEL --library`), read and added to; it changes times, not bits"},
    {"radar.scan_deg", SETTING_DOUBLE, AT(radar.scan_deg), 0, 160, NULL, "deg",
     "sector that that radar's beam scans about the sensor's axis; 0: it stares"},
    {"radar.scan_step", SETTING_DOUBLE, AT(radar.scan_step), 0.05, 1, NULL, "",
     "between positions of the scanning beam, over its width at half power, one way"},
    {"exercise.port", SETTING_INT, AT(exercise.port), -1, 65535, NULL, "",
     "UDP port of the exercise; 0: any; -1: 3000, or any if nothing was sent to it"},
    {"exercise.exercise", SETTING_INT, AT(exercise.exercise), -2, 255, NULL, "",
     "exercise identifier; -1: the one with the most PDUs; -2: all, as one exercise"},
    {"exercise.utc", SETTING_TEXT, AT(exercise.utc), 0, 0, NULL, "",
     "UTC of the first PDU, for example 2026-06-21T10:00:00Z"},
    {"exercise.local_solar", SETTING_TEXT, AT(exercise.local_solar), 0, 0, NULL, "",
     "mean solar time of the first PDU at the exercise, in place of exercise.utc, for example 2026-06-21T10:00:00: the sun is "
     "highest within 17 minutes of 12:00"},
    {"exercise.host", SETTING_TEXT, AT(exercise.host), 0, 0, NULL, "",
     "entity that carries the sensor: site:application:entity; observer: a stand-off sensor; munition: munitions as "
     "they appear, guided ones first, one after the other"},
    {"exercise.aim", SETTING_TEXT, AT(exercise.aim), 0, 0, NULL, "",
     "site:application:entity that the sensor points at"},
    {"exercise.from_s", SETTING_TEXT, AT(exercise.from), 0, 0, NULL, "s",
     "first exercise time to render; +12: 12 s after the start of the recording, -5: 5 s before its end"},
    {"exercise.to_s", SETTING_TEXT, AT(exercise.to), 0, 0, NULL, "s",
     "last exercise time to render, in the same forms"},
    {"exercise.listen_s", SETTING_DOUBLE, AT(exercise.listen_s), 0.05, 600, NULL, "s",
     "time from the first entity until host, terrain and time of day are chosen; run, replay --causal"},
    {"exercise.causal", SETTING_BOOL, AT(causal), 0, 1, NULL, "",
     "use only what had been received by the time of each frame"},
    {"network.address", SETTING_TEXT, AT(network.address), 0, 0, NULL, "",
     "numeric address of the exercise: multicast group, broadcast or host; empty: receive on all, send to "
     "255.255.255.255"},
    {"network.interface", SETTING_TEXT, AT(network.interface), 0, 0, NULL, "",
     "network interface, for example eth0; empty: the system's choice"},
    {"network.ttl", SETTING_INT, AT(network.ttl), 0, 255, NULL, "", "multicast hops; 0: this machine only"},
    {"network.queue_mb", SETTING_INT, AT(network.queue_mb), 1, 1024, NULL, "MiB",
     "receive queue while a frame is rendered; PDUs beyond it are lost and counted"},
    {"node.site", SETTING_INT, AT(node.site), 1, 65533, NULL, "",
     "site of this node; its own PDUs, by site and application, are ignored when received"},
    {"node.application", SETTING_INT, AT(node.application), 1, 65533, NULL, "", "application of this node"},
    {"publish.dis", SETTING_TEXT, AT(publish.dis), 0, 0, "off|sensor|truth", "",
     "Data PDUs per frame and band: off; sensor: what a seeker could measure; truth: with ids and ranges"},
    {"publish.files", SETTING_BOOL, AT(publish.files), 0, 1, NULL, "",
     "write image files; truth.jsonl and run.json are written without them, too"},
    {"publish.png", SETTING_BOOL, AT(publish.png), 0, 1, NULL, "", "write display images beside the EXR files"},
    {"publish.planes", SETTING_WORDS, AT(publish.planes), 0, 0, NULL, "",
     "truth planes to write: all, none, or any of range,entity,part,material,temperature,normal,emissivity,instance,cover"},
    {"publish.pairs", SETTING_TEXT, AT(publish.pairs), 0, 0, "off|target|all", "",
     "replay only: render each frame also without its target, or without any entity, and both without noise"},
    {"publish.coco", SETTING_BOOL, AT(publish.coco), 0, 1, NULL, "",
     "replay only: write coco.json, boxes and masks of visible targets"},
    {"publish.coco_min_pixels", SETTING_INT, AT(publish.coco_min_pixels), 1, 1000000, NULL, "px",
     "targets with fewer mask pixels are ignore regions of coco.json (iscrowd)"},
    {"publish.coco_min_visible", SETTING_DOUBLE, AT(publish.coco_min_visible), 0, 1, NULL, "",
     "targets with a smaller visible fraction are ignore regions of coco.json (iscrowd)"},
    {"publish.coco_min_snr", SETTING_DOUBLE, AT(publish.coco_min_snr), 0, 1000, NULL, "",
     "targets with a smaller snr in a band, whatever its sign, are ignore regions of that band's images in coco.json (iscrowd)"},
    {"publish.truth", SETTING_BOOL, AT(publish.truth), 0, 1, NULL, "",
     "write truth.jsonl and hash every frame; false, in `run` and `replay --speed X` only: neither is computed, and truth "
     "planes only if another product has them"},
    {"publish.latest", SETTING_BOOL, AT(publish.latest), 0, 1, NULL, "",
     "keep latest/BAND.png, the newest display of each band, replaced as a whole"},
    {"publish.video", SETTING_PATH, AT(publish.video), 0, 0, NULL, "",
     "a video file, all bands side by side (.mp4, .mkv, .ts); or a folder: per band a .ts with KLV and an .mp4; empty: "
     "none"},
    {"publish.video_codec", SETTING_TEXT, AT(publish.video_codec), 0, 0, "h264|h264-10|hevc-12|ffv1", "",
     "of videos and streams: 8 bits; 10 bits; 12 bits; 16 bits without loss, in .mkv files only"},
    {"publish.video_labels", SETTING_TEXT, AT(publish.video_labels), 0, 0, "off|bands|targets", "",
     "drawn into videos and streams, over the pixels: nothing; each band's name; that, and box and name of each visible target"},
    {"publish.stream", SETTING_TEXT, AT(publish.stream), 0, 0, NULL, "",
     "udp://HOST:PORT, numeric: MPEG-TS with KLV, the first band at PORT, each further one at a port higher by 2; empty: "
     "none"},
    {"publish.klv", SETTING_TEXT, AT(publish.klv), 0, 0, "async|sync|off", "",
     "MISB ST 0601 metadata in streams and .ts files: asynchronous, synchronous (stream type 0x15), or none"},
    {"publish.vmti", SETTING_TEXT, AT(publish.vmti), 0, 0, "atr|truth|off", "",
     "MISB ST 0903 targets in that metadata: detections received (publish.detections_port); truth, marked so; or none"},
    {"publish.klv_files", SETTING_BOOL, AT(publish.klv_files), 0, 1, NULL, "",
     "write the metadata also into BAND.klv, without video"},
    {"publish.memory", SETTING_TEXT, AT(publish.memory), 0, 0, NULL, "",
     "name of a shared-memory ring of frames for a recogniser on this machine, /dev/shm/NAME; empty: none"},
    {"publish.memory_planes", SETTING_TEXT, AT(publish.memory_planes), 0, 0, "float|counts", "",
     "planes of the ring: radiance, float; or raw counts of the bands with a sensor, 16 bits"},
    {"publish.memory_record", SETTING_TEXT, AT(publish.memory_record), 0, 0, "sensor|truth", "",
     "targets in the ring: sensor, none; truth, with ids and ranges"},
    {"publish.memory_slots", SETTING_INT, AT(publish.memory_slots), 2, 64, NULL, "",
     "frames that the ring holds; a reader slower than that loses frames"},
    {"publish.detections_port", SETTING_INT, AT(publish.detections_port), 0, 65535, NULL, "",
     "UDP port on loopback that receives a recogniser's detections, for answers.jsonl and metadata; 0: none"},
    {"record.path", SETTING_PATH, AT(record.path), 0, 0, NULL, "",
     "pcapng file to which `run` records all received datagrams; empty: none"},
    {"weather.atmosphere", SETTING_NAME_OR_PATH, AT(weather.atmosphere), 0, 0, NULL, "",
     "us1976, midlat_summer, or another folder of etc/atmosphere; or the path of such a folder, ./NAME"},
    {"weather.visibility_m", SETTING_DOUBLE, AT(weather.visibility_m), 100, 300000, NULL, "m", "meteorological range"},
    {"weather.air_temp_k", SETTING_DOUBLE, AT(weather.air_temp_k), 220, 330, NULL, "K",
     "at ground level at the terrain origin, with the atmosphere's lapse above; unset: the atmosphere's own"},
    {"weather.pressure_mbar", SETTING_DOUBLE, AT(weather.pressure_mbar), 300, 1100, NULL, "mbar",
     "air pressure, for the refraction of sunlight"},
    {"weather.wind_mps", SETTING_DOUBLE, AT(weather.wind_mps), 0, 60, NULL, "m/s",
     "wind speed; cools ground and vehicles, moves smoke"},
    {"weather.wind_from_deg", SETTING_DOUBLE, AT(weather.wind_from_deg), 0, 360, NULL, "deg",
     "direction the wind comes from, clockwise from north"},
    {"weather.day", SETTING_NAME_OR_PATH, AT(weather.day), 0, 0, NULL, "",
     "the weather's course: clear sky and air that warms and cools over the day (clear), the values here at all times "
     "(constant), or a weather file (EPW, TMY3, CSV)"},
    {"weather.air_range_k", SETTING_DOUBLE, AT(weather.air_range_k), 0, 60, NULL, "K",
     "warmest less coldest air of a clear day, whose mean is weather.air_temp_k"},
    {"weather.humidity_pct", SETTING_DOUBLE, AT(weather.humidity_pct), 0, 100, NULL, "%",
     "relative humidity at weather.air_temp_k, for what ground and leaves evaporate; the air's own bands are the "
     "atmosphere's"},
    {"weather.cloud", SETTING_DOUBLE, AT(weather.cloud), 0, 1, NULL, "",
     "mean share of the sky that clouds cover, which dim the sun and warm the sky"},
    {"weather.rain_mmh", SETTING_DOUBLE, AT(weather.rain_mmh), 0, 300, NULL, "mm/h",
     "rain rate; attenuates and scatters the waves of radar.preset, and wets the ground; the other bands do not show it: lower "
     "weather.visibility_m for them"},
    {"heat.vehicle_step_s", SETTING_DOUBLE, AT(heat.vehicle_step_s), 1, 600, NULL, "s",
     "longest step of the heat of vehicles, people and buildings"},
    {"heat.step_s", SETTING_DOUBLE, AT(heat.step_s), 60, 3600, NULL, "s", "time grid of the ground's heat"},
    {"heat.facets", SETTING_INT, AT(heat.facets), 3, 17, NULL, "",
     "slopes and azimuths of the ground's heat: a grid of so many a side, odd"},
    {"heat.shadow_m", SETTING_DOUBLE, AT(heat.shadow_m), 0, 1000, NULL, "m",
     "cells of the shadows that relief and plants cast over the day; 0: no shadow cools the ground"},
    {"heat.given", SETTING_PATH, AT(heat.given), 0, 0, NULL, "",
     "file of temperatures of parts over exercise time (CSV: entity, part, t_s, temp_k) that are shown instead of those worked "
     "out; empty: none"},
    {"heat.vehicles", SETTING_PATH, AT(heat.vehicles), 0, 0, NULL, "",
     "file of the temperatures of vehicles, people and buildings (CSV), read at the start where it is there, written at the end, "
     "for a node that starts again; empty: none"},
    {"heat.marks", SETTING_PATH, AT(heat.marks), 0, 0, NULL, "",
     "file of what stood, drove and burst (CSV): read at the start where it is there, written at the end, for a node that "
     "starts again; empty: none"},
    {"terrain.relief_m", SETTING_DOUBLE, AT(terrain.relief_m), 0, 200, NULL, "m",
     "rms height of the hills of synthetic terrain"},
    {"terrain.spacing_m", SETTING_DOUBLE, AT(terrain.spacing_m), 0, 1000, NULL, "m",
     "distance between elevation posts; 0: 4 for synthetic terrain, else that of the files"},
    {"terrain.store", SETTING_PATH, AT(terrain.store), 0, 0, NULL, "",
     "terrain store of `pitviper terrain import`, instead of elevation, cover and orthophoto; empty: none"},
    {"terrain.elevation", SETTING_PATHS, AT(terrain.elevation), 0, 0, NULL, "",
     "elevation files or folders, separated by commas, or a list; empty: synthetic terrain"},
    {"terrain.vertical", SETTING_TEXT, AT(terrain.vertical), 0, 0, "auto|geoid|ellipsoid", "",
     "vertical datum of the files; auto: from their CRS, else the geoid"},
    {"terrain.geoid", SETTING_PATH, AT(terrain.geoid), 0, 0, NULL, "", "geoid grid (.gtx); empty: EGM96 of proj-data"},
    {"terrain.cover", SETTING_PATHS, AT(terrain.cover), 0, 0, NULL, "",
     "land cover files or folders; empty: derived from slope and height"},
    {"terrain.cover_table", SETTING_NAME_OR_PATH, AT(terrain.cover_table), 0, 0, NULL, "",
     "worldcover, nlcd, fbfm40, dynamicworld, corine or a CSV of code, surface; empty: detected from the codes"},
    {"terrain.cover_band", SETTING_INT, AT(terrain.cover_band), 0, 1000, NULL, "",
     "band of the cover files; 0: 4 for LANDFIRE landscape files (8 bands), else 1"},
    {"terrain.orthophoto", SETTING_PATHS, AT(terrain.orthophoto), 0, 0, NULL, "", "orthophoto files or folders"},
    {"terrain.sources_from", SETTING_PATHS, AT(terrain.sources_from), 0, 0, NULL, "",
     "folders where files may lie that others name (VRT); empty: in the folder of the file that names them alone"},
    {"terrain.ground", SETTING_TEXT, AT(terrain.ground), 0, 0, "auto|clamp|trust|fit", "",
     "ground clamping; clamp: place land entities on the terrain; trust: leave them at their reported heights; fit: "
     "fit the terrain "
     "to them; auto: clamp on real terrain; fit synthetic terrain and clamp the entities whose positions are "
     "inconsistent with it"},
    {"terrain.detail", SETTING_TEXT, AT(terrain.detail), 0, 0, "on|off", "",
     "noise of the ground within each surface class (etc/ground_detail.csv); off: classes of one value"},
    {"terrain.woods", SETTING_TEXT, AT(terrain.woods), 0, 0, "on|off", "",
     "trees, bushes, hedges and low plants, by canopy layers, marked trunks or surface classes; off: bare ground"},
    {"terrain.woods_trees", SETTING_INT, AT(terrain.woods_trees), 0, woods_most_trees, NULL, "",
     "most trees, bushes and hedges; beyond, those farthest from the aim are left out"},
    {"terrain.woods_half_m", SETTING_DOUBLE, AT(terrain.woods_half_m), 0, 50000, NULL, "m",
     "half width of the square about the aim in which plants stand; below 50: the extent of the entities and 4 km "
     "about it"},
    {"terrain.woods_leaves", SETTING_TEXT, AT(terrain.woods_leaves), 0, 0, "on|off", "",
     "leaves of deciduous trees; off: bare, as in winter"},
    {"terrain.woods_sway", SETTING_DOUBLE, AT(terrain.woods_sway), 0, 5, NULL, "",
     "amplitude of the sway of plants in the wind of weather.wind_mps: 1 realistic, 0 none"},
    {"terrain.woods_level1_px", SETTING_DOUBLE, AT(terrain.woods_level1_px), 0, 1000, NULL, "px",
     "plants lower than this in the image are traced with fewer, larger leaves; 0: none, all in full detail"},
    {"terrain.woods_low_m", SETTING_DOUBLE, AT(terrain.woods_low_m), 0, 1000, NULL, "m",
     "distance from the sensor within which grass, reeds, crops and stones stand; 0: none"},
    {"observer.range_m", SETTING_DOUBLE, AT(observer.range_m), 10, 100000, NULL, "m",
     "ground distance of the stand-off observer from its aim point"},
    {"observer.height_m", SETTING_DOUBLE, AT(observer.height_m), 1, 20000, NULL, "m",
     "height of the stand-off observer above its aim point"},
    {"observer.rate_dps", SETTING_DOUBLE, AT(observer.rate_dps), -60, 60, NULL, "deg/s",
     "angular rate of the stand-off observer's orbit, clockwise from above"},
    {"models.catalog", SETTING_PATH, AT(models.catalog), 0, 0, NULL, "",
     "rows that take precedence over etc/catalog.csv: which model an entity type gets"},
    {"models.materials", SETTING_PATH, AT(models.materials), 0, 0, NULL, "",
     "rows that take precedence over etc/materials.csv"},
    {"models.sag_m", SETTING_DOUBLE, AT(models.sag_m), 1e-5, 0.1, NULL, "m",
     "chord error: largest distance of a facet from the curved surface of a built-in shape"},
    {"entities.timeout_s", SETTING_DOUBLE, AT(entities.timeout_s), 0.1, 1e5, NULL, "s",
     "an entity without a report for this long is removed"},
    {"entities.timeout_land_v7_s", SETTING_DOUBLE, AT(entities.timeout_land_v7_s), 0.1, 1e5, NULL, "s",
     "the same for land entities of DIS version 7"},
    {"entities.extrapolation_limit_s", SETTING_DOUBLE, AT(entities.extrapolation_limit_s), 0.01, 1e4, NULL, "s",
     "longest extrapolation by dead reckoning"},
    {"entities.capacity", SETTING_INT, AT(entities.capacity), 1, 1000000, NULL, "",
     "most entities in the table; beyond, the sender with the most entities loses its farthest and stalest"},
    {"entities.shown", SETTING_INT, AT(entities.shown), 1, 1000000, NULL, "",
     "most entities in a frame: those whose reports lie nearest the host's"},
    {"entities.new_per_s", SETTING_INT, AT(entities.new_per_s), 1, 1000000, NULL, "1/s",
     "most entities that one sender may add, in a second and at once; those beyond are counted"},
    {"quality.budget", SETTING_TEXT, AT(quality.budget), 0, 0, "off|on", "",
     "each frame's estimate of its own error, in truth.jsonl; changes no image"},
    {"quality.radiance_rmse_percent", SETTING_DOUBLE, AT(quality.radiance_rmse_percent), 0.01, 1000, NULL, "%",
     "largest sampling error, rms relative to the band's mean: selects sensor.samples, edge_samples, "
     "target_samples, antialias"},
    {"quality.temperature_rms_k", SETTING_DOUBLE, AT(quality.temperature_rms_k), 1e-3, 1000, NULL, "K",
     "the same as apparent temperature, for mwir and lwir"},
    {"quality.frame_ms", SETTING_DOUBLE, AT(quality.frame_ms), 0.01, 1e6, NULL, "ms",
     "time available for the rays of a frame, from the table's times and quality.machine_factor"},
    {"quality.machine_factor", SETTING_DOUBLE, AT(quality.machine_factor), 0.001, 1000, NULL, "",
     "time on this machine relative to that in the table; `run` measures it when it is not given"},
    {"quality.table", SETTING_PATH, AT(quality.table), 0, 0, NULL, "",
     "sampling settings with their errors and times, from `pitviper bench quality --table FILE`; empty: "
     "etc/quality.csv"},
    {"seed", SETTING_LONG, AT(seed), 0, 2147483647, NULL, "", "seed of all random numbers"},
};
enum { key_count = sizeof keys / sizeof keys[0] };
_Static_assert((int)key_count <= (int)config_keys_max, "Config.given is too small");
const SettingTable config_table = {
    .module = "config", .row = keys, .count = key_count, .all_keys = "`pitviper check --default`"};

Config config_default(void)
{
    Config c = {0};
    c.sensor.width_px = 720;
    c.sensor.height_px = 486;
    c.sensor.hfov_deg = 6;
    c.sensor.samples = 1;
    c.sensor.edge_samples = 4;
    c.sensor.target_samples = 48; /* error of a sunlit crescent below 1 %: tests/render/test_small_targets.c */
    c.sensor.gimbal_limit_deg = 45;
    c.sensor.gimbal_rate_dps = 60;
    c.sensor.gimbal_lag_s = 0.03;
    strcpy(c.sensor.bands, "optical,mwir,lwir,radar");
    strcpy(c.sensor.optical, "rgb");
    strcpy(c.sensor.sky_visibility, "on");
    strcpy(c.sensor.antialias, "adaptive");
    strcpy(c.sensor.mount, "auto");
    c.sensor.mount_x_m = c.sensor.mount_y_m = c.sensor.mount_z_m = NAN;
    strcpy(c.detector.level, "auto");
    c.detector.plateau = 0.002;
    c.detector.agc_s = 2; /* without a lag the display flickers: tests/system/test_level.sh */
    c.detector.bits = 8;
    c.detector.gain = 1;
    c.detector.noise_optical = 0.005;
    c.detector.netd_mwir_k = 0.03; /* staring arrays of public data sheets: 20 .. 50 mK */
    c.detector.netd_lwir_k = 0.05;
    c.detector.mwir_low_k = 270;
    c.detector.mwir_high_k = 340;
    c.detector.lwir_low_k = 270;
    c.detector.lwir_high_k = 330;
    c.detector.optical_high_w_m2_sr = 40;
    strcpy(c.sensor.preset, "none");
    c.sensor.lens_k1 = c.sensor.lens_k2 = c.sensor.lens_k3 = c.sensor.lens_p1 = c.sensor.lens_p2 = NAN;
    c.sensor.lateral_r = c.sensor.lateral_b = NAN;
    c.detector.noise = 1;
    c.detector.f_number = c.detector.obscuration = c.detector.integration_ms = c.detector.jitter_px = NAN;
    c.detector.bad_share = c.detector.ac_per_line = c.detector.line_noise = NAN;
    c.detector.smear = true;
    c.detector.raw = true;
    c.radar.bin_m = 0.3; /* 500 MHz of bandwidth */
    c.radar.bins = 512;
    c.radar.lobe_deg = 3;
    strcpy(c.radar.preset, "none");
    c.radar.ground = true;
    c.radar.ground_bounce = true;
    c.radar.warp_mm = 1;
    c.radar.chaff_dipoles = 1e6; /* of 5.1 million fibres in a cartridge, cut for several bands */
    c.radar.scan_step = 0.5;
    c.exercise.port = -1;
    c.exercise.exercise = -1;
    c.exercise.listen_s = 2;
    c.network.ttl = 1;
    c.network.queue_mb = 256; /* a million Entity States; pages are touched only when needed */
    c.node.site = 4711;
    c.node.application = 1;
    strcpy(c.publish.dis, "off");
    strcpy(c.publish.pairs, "off");
    strcpy(c.publish.planes, "all");
    c.publish.files = true;
    c.publish.truth = true;
    c.publish.png = true;
    c.publish.coco_min_pixels = 5; /* of 4 no class can be told */
    c.publish.coco_min_snr = 0.1;  /* in the dark: 3e-6 W/(m2 sr), ten of the display's 255 steps */
    strcpy(c.publish.video_codec, "h264");
    strcpy(c.publish.video_labels, "off");
    strcpy(c.publish.klv, "async");
    strcpy(c.publish.vmti, "atr");
    strcpy(c.publish.memory_planes, "float");
    strcpy(c.publish.memory_record, "sensor");
    c.publish.memory_slots = 4;
    strcpy(c.weather.atmosphere, "us1976");
    c.weather.visibility_m = 23000;
    c.weather.air_temp_k = NAN;
    c.weather.pressure_mbar = 1013.25;
    c.weather.wind_mps = 3;
    c.weather.wind_from_deg = 270;
    c.terrain.relief_m = 15;
    strcpy(c.weather.day, "clear");
    c.weather.air_range_k = 10;
    c.weather.humidity_pct = 60;
    c.heat.step_s = 600;
    c.heat.vehicle_step_s = 30;
    c.heat.facets = 7;
    c.heat.shadow_m = 16;
    strcpy(c.terrain.vertical, "auto");
    strcpy(c.terrain.ground, "auto");
    strcpy(c.terrain.detail, "on");
    strcpy(c.terrain.woods, "on");
    strcpy(c.terrain.woods_leaves, "on");
    c.terrain.woods_trees = 300000;
    c.terrain.woods_low_m = 60;
    c.observer.range_m = 600;
    c.observer.height_m = 250;
    c.observer.rate_dps = 2;
    c.models.sag_m = 0.002;
    c.entities.timeout_s = 12;
    c.entities.timeout_land_v7_s = 132;
    c.entities.extrapolation_limit_s = 12;
    c.entities.capacity = 100000;
    c.entities.shown = 2000;
    c.entities.new_per_s = 65536; /* as many as a sender has ids */
    strcpy(c.quality.budget, "on");
    c.quality.radiance_rmse_percent = c.quality.temperature_rms_k = c.quality.frame_ms = NAN;
    c.quality.machine_factor = 1;
    c.seed = 1;
    return c;
}
