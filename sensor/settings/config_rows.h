/* sensor/settings/config_rows.h: every setting, in the order of the hashed text: one entry of its section's list states
 * key, default, range, unit and help (pitviper_settings.h); member, table and default are made of it. */
#ifndef SENSOR_SETTINGS_CONFIG_ROWS_H
#define SENSOR_SETTINGS_CONFIG_ROWS_H

#include "pitviper_settings.h"

enum { config_paths_size = 4096 };

/* clang-format off */
#define CONFIG_ROWS(ROW) \
    CONFIG_SENSOR(ROW) CONFIG_DETECTOR(ROW) CONFIG_RADAR(ROW) CONFIG_EXERCISE(ROW) CONFIG_FLIGHT(ROW) CONFIG_NETWORK(ROW) \
    CONFIG_NODE(ROW) CONFIG_PUBLISH(ROW) CONFIG_PROJECTOR(ROW) CONFIG_RECORD(ROW) CONFIG_WEATHER(ROW) CONFIG_HEAT(ROW) \
    CONFIG_TERRAIN(ROW) \
    CONFIG_OBSERVER(ROW) CONFIG_MODELS(ROW) CONFIG_ENTITIES(ROW) CONFIG_QUALITY(ROW) CONFIG_CACHE(ROW) CONFIG_TOP(ROW)

#define CONFIG_SENSOR(ROW) \
    ROW(INT, sensor., width_px, 720, 8, 8192, "px", "columns of the image") \
    ROW(INT, sensor., height_px, 486, 8, 8192, "px", "rows of the image") \
    ROW(DOUBLE, sensor., hfov_deg, 6, 0.01, 120, "deg", "horizontal field of view") \
    ROW(DOUBLE, sensor., rate_hz, 0, 0, 1000, "Hz", "frames per second; 0: 5 for a munition, 1 for an observer") \
    ROW(INT, sensor., samples, 1, 1, 16, "", "rays along each side of a pixel: N x N rays per pixel") \
    ROW(CHOICE, sensor., antialias, ANTIALIAS_ADAPTIVE, Antialias, \
        (ANTIALIAS_ADAPTIVE, "adaptive")(ANTIALIAS_OFF, "off"), \
        "antialiasing; adaptive: more rays at edges and over small targets; off: the same number everywhere") \
    ROW(INT, sensor., edge_samples, 4, 2, 16, "", \
        "rays along each side of a pixel that differs from its neighbours; adaptive only") \
    /* error of a sunlit crescent below 1 %: tests/render/test_small_targets.c */ \
    ROW(INT, sensor., target_samples, 48, 8, 256, "", \
        "rays along each side of the grid over a target below 16 px; adaptive only") \
    ROW(WORDS, sensor., bands, "optical,mwir,lwir,radar", 64, \
        "any of optical,mwir,lwir,radar, and further channels of etc/channels.csv in the place of one of these: " \
        "swir") \
    ROW(CHOICE, sensor., optical, SENSOR_OPTICAL_RGB, SensorOptical, \
        (SENSOR_OPTICAL_RGB, "rgb")(SENSOR_OPTICAL_PAN, "pan")(SENSOR_OPTICAL_NIR, "nir"), \
        "three visible channels, one panchromatic, or one of 0.7-1.1 um") \
    ROW(INT, sensor., sky_samples, 0, 0, 4096, "", \
        "directions of incident light sampled at each hit; 0: closed form by slope, with sky_visibility") \
    ROW(SWITCH, sensor., sky_visibility, true, "on|off", "contact shadows: entities occlude sky and ground near them") \
    ROW(SWITCH, sensor., refraction, true, "on|off", "lines of sight bend in air; off: straight") \
    ROW(DOUBLE, sensor., gimbal_limit_deg, 45, 0, 180, "deg", "largest angle off the body axis") \
    ROW(DOUBLE, sensor., gimbal_rate_dps, 60, 0.01, 10000, "deg/s", "largest slew rate") \
    ROW(DOUBLE, sensor., gimbal_lag_s, 0.03, 0, 10, "s", "time constant of the tracking loop") \
    ROW(TEXT, sensor., aim_offset, "none", 40, "", \
        "where in the image the aim is: none, in the middle; drawn, by the seed for each host over four fifths of its " \
        "width and height; drawn W,H: over these shares; X,Y: shares right of the middle and below, -0.5 .. 0.5; X,Y deg") \
    ROW(DOUBLE, sensor., walk_deg, 0, 0, 20, "deg", \
        "rms of a slow walk of the line of sight about its aim, in each axis: hand-over errors, drift of a gimbal") \
    ROW(DOUBLE, sensor., walk_s, 10, 0.01, 1e5, "s", "time over which its correlation falls to 1/e") \
    ROW(TEXT, sensor., mount, "auto", 48, "", \
        "what the sensor is mounted on: auto (nose or roof), or a part of the host: primary turret, primary gun " \
        "2, the name of a node") \
    ROW(DOUBLE, sensor., mount_x_m, NAN, -500, 500, "m", \
        "forward offset from the body's origin or the part's pivot; unset: nose or roof, for a part 0") \
    ROW(DOUBLE, sensor., mount_y_m, NAN, -500, 500, "m", "offset to the right") \
    ROW(DOUBLE, sensor., mount_z_m, NAN, -500, 500, "m", "offset down") \
    ROW(DOUBLE, sensor., mount_yaw_deg, 0, -180, 180, "deg", "gimbal axis: yaw, right of forward") \
    ROW(DOUBLE, sensor., mount_pitch_deg, 0, -90, 90, "deg", "then pitch, up") \
    ROW(DOUBLE, sensor., mount_roll_deg, 0, -180, 180, "deg", \
        "roll of the stabilised image against upright, right side down") \
    ROW(WORDS, sensor., preset, "none", 96, \
        "none, or rows of etc/sensors.csv, one per band, separated by commas, or a list: " \
        "staring_lwir,staring_mwir,tv") \
    ROW(PATH, sensor., table, "", 1024, \
        "a sensor's data sheet with FLIR92's entries (etc/sensors/example_flir2.sheet), which takes precedence " \
        "over sensor.preset; or a .csv with the columns of etc/sensors.csv, whose rows sensor.preset may name") \
    ROW(DOUBLE, sensor., lens_k1, NAN, -1e6, 1e6, "", \
        "radial distortion of all bands (Brown-Conrady, as OpenCV; tangents of angles off the axis); overrides " \
        "the first preset") \
    ROW(DOUBLE, sensor., lens_k2, NAN, -1e9, 1e9, "", "radial distortion, fourth order") \
    ROW(DOUBLE, sensor., lens_k3, NAN, -1e12, 1e12, "", "radial distortion, sixth order") \
    ROW(DOUBLE, sensor., lens_p1, NAN, -1e3, 1e3, "", "tangential distortion p1") \
    ROW(DOUBLE, sensor., lens_p2, NAN, -1e3, 1e3, "", "tangential distortion p2") \
    ROW(DOUBLE, sensor., lateral_r, NAN, -0.02, 0.02, "", \
        "lateral colour of rgb: magnification of R relative to G, minus 1; each channel is then traced by itself") \
    ROW(DOUBLE, sensor., lateral_b, NAN, -0.02, 0.02, "", "the same for B")

#define CONFIG_DETECTOR(ROW) \
    ROW(INT, detector., bits, 8, 8, 16, "", "bits of the PNG images: 8 or 16") \
    ROW(CHOICE, detector., level, DISPLAY_LEVEL_AUTO, DisplayLevel, \
        (DISPLAY_LEVEL_AUTO, "auto")(DISPLAY_LEVEL_PLATEAU, "plateau")(DISPLAY_LEVEL_MANUAL, "manual"), \
        "gain and level of display images; auto: set per frame (detector.agc_s), linear; plateau: plateau " \
        "equalisation of mwir and lwir, as in thermal cameras; manual: as configured") \
    ROW(DOUBLE, detector., plateau, 0.002, 1e-6, 1, "", \
        "detector.level plateau: share of the pixels that counts in a bin of 0.03 K; 1: histogram equalisation") \
    ROW(DOUBLE, detector., gain, 1, 0.01, 100, "", "contrast gain about mid-level") \
    ROW(DOUBLE, detector., offset, 0, -1, 1, "", "brightness offset, in full scales") \
    ROW(DOUBLE, detector., noise_optical, 0.005, 0, 1, "", "noise sigma as a share of the mean") \
    /* staring arrays of public data sheets: 20 .. 50 mK */ \
    ROW(DOUBLE, detector., netd_mwir_k, 0.03, 0, 10, "K", \
        "noise equivalent temperature difference at 300 K") \
    ROW(DOUBLE, detector., netd_lwir_k, 0.05, 0, 10, "K", "the same for lwir") \
    ROW(DOUBLE, detector., mwir_low_k, 270, 150, 2000, "K", "apparent temperature shown as black; manual level") \
    ROW(DOUBLE, detector., mwir_high_k, 340, 150, 2000, "K", "apparent temperature shown as white; manual level") \
    ROW(DOUBLE, detector., lwir_low_k, 270, 150, 2000, "K", "apparent temperature shown as black; manual level") \
    ROW(DOUBLE, detector., lwir_high_k, 330, 150, 2000, "K", "apparent temperature shown as white; manual level") \
    ROW(DOUBLE, detector., optical_high_w_m2_sr, 40, 1e-3, 1e4, "W/(m2 sr)", "radiance shown as white; manual level") \
    /* without a lag the display flickers: tests/system/test_level.sh */ \
    ROW(DOUBLE, detector., agc_s, 2, 0, 1000, "s", \
        "time constant of the automatic level, from the first frame rendered; a tenth of it applies where the " \
        "image would be nearly black or white; 0: gain and level set per frame") \
    ROW(DOUBLE, detector., noise, 1, 0, 100, "", "factor on all noise; 0: none") \
    ROW(DOUBLE, detector., f_number, NAN, 0.5, 100, "", "overrides the preset") \
    ROW(DOUBLE, detector., obscuration, NAN, 0, 0.95, "", \
        "central obscuration, share of the aperture's diameter; overrides the preset") \
    ROW(DOUBLE, detector., integration_ms, NAN, 1e-6, 1e4, "ms", "integration time; overrides the preset") \
    ROW(DOUBLE, detector., jitter_px, NAN, 0, 10, "px", \
        "rms line-of-sight jitter per axis within the integration time; overrides the preset") \
    ROW(DOUBLE, detector., bad_share, NAN, 0, 0.2, "", "share of defective pixels; overrides the preset") \
    ROW(DOUBLE, detector., ac_per_line, NAN, 0, 100, "", \
        "cut-off frequency of the AC coupling times line time; overrides the preset") \
    ROW(DOUBLE, detector., line_noise, NAN, 0, 100, "", \
        "rms of noise along lines relative to that of a pixel; overrides the preset") \
    ROW(BOOL, detector., smear, true, "motion within the integration time and between lines; with a preset") \
    ROW(BOOL, detector., raw, true, "write files of raw counts; with a preset")

#define CONFIG_RADAR(ROW) \
    ROW(DOUBLE, radar., bin_m, 0.3, 0.01, 100, "m", "range bin of the range profile") /* 500 MHz of bandwidth */ \
    ROW(INT, radar., bins, 512, 16, 65536, "", "number of range bins, centred on the aim point") \
    ROW(DOUBLE, radar., lobe_deg, 3, 0.2, 30, "deg", "rms half width of the scattering lobe") \
    ROW(TEXT, radar., preset, "none", 32, "", \
        "none, or a row of etc/radars.csv: a radar with phase on the sensor's axis, whose range profiles, maps " \
        "of range and Doppler and detections are products") \
    ROW(PATH, radar., table, "", 1024, \
        "a .csv with the columns of etc/radars.csv, whose rows radar.preset names in place of those") \
    ROW(BOOL, radar., ground, true, "that radar's echoes of ground and plants; with a preset") \
    ROW(BOOL, radar., ground_bounce, true, \
        "reflections of that radar's waves by the ground near entities and before walls; with a preset") \
    ROW(BOOL, radar., scenery, true, \
        "that radar's echoes of buildings, works and clutter, where there are any; with a preset") \
    /* of 5.1 million fibres in a cartridge, cut for several bands */ \
    ROW(DOUBLE, radar., chaff_dipoles, 1e6, 0, 1e10, "", \
        "dipoles in resonance with that radar in a cloud of chaff (type 8.*.*.1 or .3); 0: chaff is not seen") \
    ROW(DOUBLE, radar., warp_mm, 1, 0, 20, "mm", \
        "unevenness of entities' surfaces for that radar, rms over 0.5 m: models are flatter than real sheet " \
        "metal; 0: unchanged") \
    ROW(PATH, radar., given, "", 256, \
        "CSV file of signatures for that radar, measured or from another program, that replace those of models; " \
        "empty: none") \
    ROW(PATH, radar., library, "", 1024, \
        "folder of targets' signatures for that radar (`pitviper rcs MODEL --library`), read and added to; it " \
        "changes times, not bits") \
    ROW(DOUBLE, radar., scan_deg, 0, 0, 160, "deg", \
        "sector that that radar's beam scans about the sensor's axis; 0: it stares") \
    ROW(DOUBLE, radar., scan_step, 0.5, 0.05, 1, "", \
        "between positions of the scanning beam, over its width at half power, one way")

#define CONFIG_EXERCISE(ROW) \
    ROW(INT, exercise., port, -1, -1, 65535, "", \
        "UDP port of the exercise; 0: any; -1: 3000, or any if nothing was sent to it") \
    ROW(INT, exercise., exercise, -1, -2, 255, "", \
        "exercise identifier; -1: the one with the most PDUs; -2: all, as one exercise") \
    ROW(TEXT, exercise., utc, "", 32, "", "UTC of the first PDU, for example 2026-06-21T10:00:00Z") \
    ROW(TEXT, exercise., local_solar, "", 32, "", \
        "mean solar time of the first PDU at the exercise, in place of exercise.utc, for example " \
        "2026-06-21T10:00:00: the sun is highest within 17 minutes of 12:00") \
    ROW(TEXT, exercise., host, "", 24, "", \
        "entity that carries the sensor: site:application:entity; observer: a stand-off sensor; munition: " \
        "munitions as they appear, guided ones first, one after the other") \
    ROW(TEXT, exercise., aim, "", 24, "", "site:application:entity that the sensor points at") \
    ROW(TEXT, exercise., from_s, "", 32, "s", \
        "first exercise time to render; +12: 12 s after the start of the recording, -5: 5 s before its end") \
    ROW(TEXT, exercise., to_s, "", 32, "s", "last exercise time to render, in the same forms") \
    ROW(DOUBLE, exercise., listen_s, 2, 0.05, 600, "s", \
        "time from the first entity until host, terrain and time of day are chosen; run, replay --causal") \
    ROW(BOOL, exercise., causal, false, "use only what had been received by the time of each frame") \
    ROW(TEXT, exercise., cigi, "", 72, "", \
        "HOST:PORT of a CIGI 3.3 host, numeric, that gives each frame's time and eye, and waits for it; recorded: that of " \
        "the recording, a live node's; empty: none") \
    ROW(INT, exercise., cigi_port, 8005, 1, 65535, "", "UDP port on which that host is listened to") \
    ROW(INT, exercise., cigi_view, 0, 0, 65535, "", "view of that host that is the eye") \
    ROW(PATH, exercise., cigi_types, "", 1024, \
        "table from that host's entity types to entity types and forces; empty: cigi_types.csv") \
    ROW(TEXT, exercise., head, "", 72, "", \
        "ADDRESS:PORT, numeric, on which a head tracker's poses turn the eye (etc/reference/head.md); of a replay: those " \
        "of its recording; empty: none")

#define CONFIG_FLIGHT(ROW) \
    ROW(TEXT, flight., missile, "", 31, "", \
        "row of etc/missiles.csv by which this node flies missiles of its own in the exercise; empty: none") \
    ROW(TEXT, flight., from, "", 64, "", \
        "where they are launched: the shooter, site:application:entity, or LAT,LON,HEIGHT in degrees and metres above " \
        "the ellipsoid") \
    ROW(DOUBLE, flight., at_s, NAN, -1e9, 1e9, "s", \
        "exercise time of the first launch; unset: as soon as shooter and aim are there") \
    ROW(BOOL, flight., key, false, "the first launch waits for the operator's key (flight.operator_port)") \
    ROW(INT, flight., rounds, 1, 1, 64, "", "missiles, one after the other") \
    ROW(DOUBLE, flight., every_s, 0, 0, 3600, "s", \
        "least time between launches; none is before the one before has ended") \
    ROW(CHOICE, flight., sight, FLIGHT_SIGHT_TRUTH, FlightSightOf, \
        (FLIGHT_SIGHT_TRUTH, "truth")(FLIGHT_SIGHT_RECOGNISER, "recogniser")(FLIGHT_SIGHT_RADAR, "radar") \
        (FLIGHT_SIGHT_OPERATOR, "operator"), \
        "what guides them: the true line of sight of each frame; a recogniser's answers (publish.detections_port); " \
        "detections of radar.preset; an operator's aim (flight.operator_port)") \
    ROW(DOUBLE, flight., late_s, 0, 0, 2, "s", "least time from a frame until what was seen in it guides") \
    /* of a camera's directions at 10 to 20 a second: as fly's */ \
    ROW(DOUBLE, flight., memory, 0.6, 0, 0.99, "", "of the fading-memory filter that makes rates of directions") \
    ROW(DOUBLE, flight., hit_m, 2, 0, 50, "m", "so near the aim's centre it goes off, or at the row's fuze_m") \
    ROW(INT, flight., operator_port, 0, 0, 65535, "", "UDP port of the operator's aim; 0: none") \
    ROW(INT, flight., entity, 1, 1, 65000, "", "entity number of the first missile, with node.site and node.application") \
    ROW(INT, flight., force, 1, 0, 255, "", "force that they report: 0 other, 1 friendly, 2 opposing, 3 neutral") \
    ROW(TEXT, flight., type, "2.2.225.1.1.3.0", 32, "", "entity type that they report") \
    ROW(DOUBLE, flight., threshold_m, 0.5, 0.001, 1000, "m", \
        "error of dead reckoning at which an Entity State is sent") \
    ROW(DOUBLE, flight., threshold_deg, 3, 0.01, 180, "deg", "likewise, of attitude") \
    ROW(DOUBLE, flight., heartbeat_s, 5, 0.1, 60, "s", "longest time between two Entity States")

#define CONFIG_NETWORK(ROW) \
    ROW(TEXT, network., address, "", 64, "", \
        "numeric address of the exercise: multicast group, broadcast or host; empty: receive on all, send to " \
        "255.255.255.255") \
    ROW(TEXT, network., interface, "", 32, "", "network interface, for example eth0; empty: the system's choice") \
    ROW(INT, network., ttl, 1, 0, 255, "", "multicast hops; 0: this machine only") \
    /* a million Entity States; pages are touched only when needed */ \
    ROW(INT, network., queue_mb, 256, 1, 1024, "MiB", \
        "receive queue while a frame is rendered; PDUs beyond it are lost and counted")

#define CONFIG_NODE(ROW) \
    ROW(INT, node., site, 4711, 1, 65533, "", \
        "site of this node; its own PDUs, by site and application, are ignored when received") \
    ROW(INT, node., application, 1, 1, 65533, "", "application of this node")

#define CONFIG_PUBLISH(ROW) \
    ROW(CHOICE, publish., dis, PUBLISH_DIS_OFF, PublishDis, \
        (PUBLISH_DIS_OFF, "off")(PUBLISH_DIS_SENSOR, "sensor")(PUBLISH_DIS_TRUTH, "truth"), \
        "Data PDUs per frame and band: off; sensor: what a seeker could measure; truth: with ids and ranges") \
    ROW(BOOL, publish., files, true, "write image files; truth.jsonl and run.json are written without them, too") \
    ROW(BOOL, publish., png, true, "write display images beside the EXR files") \
    ROW(INT, publish., exr_bits, 23, 8, 23, "", \
        "bits of the mantissa of floats in EXR files; 23: all of them, to the bit; with 11 every value is within " \
        "0.025 % (0.015 K of a scene in lwir), and a file a third of the size. Hashes are of the whole values") \
    ROW(WORDS, publish., planes, "all", 64, \
        "truth planes to write: all, none, or any of " \
        "range,entity,part,material,temperature,normal,emissivity,instance,cover") \
    ROW(CHOICE, publish., pairs, PUBLISH_PAIRS_OFF, PublishPairs, \
        (PUBLISH_PAIRS_OFF, "off")(PUBLISH_PAIRS_TARGET, "target")(PUBLISH_PAIRS_ALL, "all"), \
        "replay only: render each frame also without its target, or without any entity, and both without noise") \
    ROW(BOOL, publish., coco, false, "replay only: write coco.json, boxes and masks of visible targets") \
    ROW(BOOL, publish., coco_clutter, false, \
        "coco.json has what is seen of clutter (terrain.clutter) too, in the category `clutter`; false: targets alone") \
    /* of 4 no class can be told */ \
    ROW(INT, publish., coco_min_pixels, 5, 1, 1000000, "px", \
        "targets with fewer mask pixels are ignore regions of coco.json (iscrowd)") \
    ROW(DOUBLE, publish., coco_min_visible, 0, 0, 1, "", \
        "targets with a smaller visible fraction are ignore regions of coco.json (iscrowd)") \
    /* in the dark: 3e-6 W/(m2 sr), ten of the display's 255 steps */ \
    ROW(DOUBLE, publish., coco_min_snr, 0.1, 0, 1000, "", \
        "targets with a smaller snr in a band, whatever its sign, are ignore regions of that band's images in " \
        "coco.json (iscrowd)") \
    ROW(BOOL, publish., truth, true, \
        "write truth.jsonl and hash every frame; false, in `run`, `replay --speed X` and with a CIGI host only: neither is " \
        "computed, and truth planes only if another product has them") \
    ROW(BOOL, publish., latest, false, "keep latest/BAND.png, the newest display of each band, replaced as a whole") \
    ROW(PATH, publish., video, "", config_paths_size, \
        "a video file, all bands side by side (.mp4, .mkv, .ts); or a folder: per band a .ts with KLV and an " \
        ".mp4; empty: none") \
    ROW(CHOICE, publish., video_codec, VIDEO_H264, VideoCodec, \
        (VIDEO_H264, "h264")(VIDEO_H264_10, "h264-10")(VIDEO_HEVC_12, "hevc-12")(VIDEO_FFV1, "ffv1"), \
        "of videos and streams: 8 bits; 10 bits; 12 bits; 16 bits without loss, in .mkv files only") \
    ROW(CHOICE, publish., video_labels, VIDEO_LABELS_OFF, VideoLabels, \
        (VIDEO_LABELS_OFF, "off")(VIDEO_LABELS_BANDS, "bands")(VIDEO_LABELS_TARGETS, "targets"), \
        "drawn into videos and streams, over the pixels: nothing; each band's name; that, and box and name of " \
        "each visible target") \
    ROW(TEXT, publish., stream, "", 128, "", \
        "udp://HOST:PORT, numeric: MPEG-TS with KLV, the first band at PORT, each further one at a port higher " \
        "by 2; empty: none") \
    ROW(CHOICE, publish., klv, KLV_ASYNC, KlvMode, (KLV_ASYNC, "async")(KLV_SYNC, "sync")(KLV_OFF, "off"), \
        "MISB ST 0601 metadata in streams and .ts files: asynchronous, synchronous (stream type 0x15), or none") \
    ROW(CHOICE, publish., vmti, VMTI_ATR, VmtiSource, (VMTI_ATR, "atr")(VMTI_TRUTH, "truth")(VMTI_OFF, "off"), \
        "MISB ST 0903 targets in that metadata: detections received (publish.detections_port); truth, marked so; " \
        "or none") \
    ROW(BOOL, publish., klv_files, false, "write the metadata also into BAND.klv, without video") \
    ROW(TEXT, publish., memory, "", 64, "", \
        "name of a shared-memory ring of frames for a recogniser on this machine, /dev/shm/NAME; empty: none") \
    ROW(CHOICE, publish., memory_planes, MEMORY_PLANES_FLOAT, MemoryPlanes, \
        (MEMORY_PLANES_FLOAT, "float")(MEMORY_PLANES_COUNTS, "counts"), \
        "planes of the ring: radiance, float; or raw counts of the bands with a sensor, 16 bits") \
    ROW(CHOICE, publish., memory_record, MEMORY_RECORD_SENSOR, MemoryRecord, \
        (MEMORY_RECORD_SENSOR, "sensor")(MEMORY_RECORD_TRUTH, "truth"), \
        "targets in the ring: sensor, none; truth, with ids and ranges") \
    ROW(INT, publish., memory_slots, 4, 2, 64, "", \
        "frames that the ring holds; a reader slower than that loses frames") \
    ROW(INT, publish., detections_port, 0, 0, 65535, "", \
        "UDP port on loopback that receives a recogniser's answers (PVDETECT, JSON or MISB ST 0903), for answers.jsonl " \
        "and metadata; 0: none")

#define CONFIG_PROJECTOR(ROW) \
    ROW(TEXT, projector., band, "", 16, "", \
        "band that is shown on a display of this machine, a scene projector's: optical, mwir, lwir, radar, or a channel " \
        "in the place of one; empty: none") \
    ROW(PATH, projector., table, "", 1024, \
        "CSV table from radiance or raw counts to drive levels; empty: the display image's values, with 16 bits raw " \
        "counts") \
    ROW(INT, projector., bits, 8, 8, 16, "", \
        "bits of a drive level, 8, or 16, of which red has the high octet, green the low one") \
    ROW(INT, projector., display, 0, 0, 15, "", "which display, as the window system counts them") \
    ROW(TEXT, projector., window, "full", 16, "", \
        "the whole display (full), or a window in its middle (WIDTHxHEIGHT)") \
    ROW(CHOICE, projector., scale, PROJECTOR_WHOLE, ProjectorScale, \
        (PROJECTOR_ONE, "one")(PROJECTOR_WHOLE, "whole")(PROJECTOR_FIT, "fit"), \
        "the image in the middle, each of its pixels one of the display; a square of the largest whole number of these " \
        "a side; or as large as there is room, by nearest neighbours") \
    ROW(SWITCH, projector., vsync, true, "on|off", "frames are flipped at the display's refresh; off: at once") \
    ROW(INT, projector., wait_ms, 0, 0, 10000, "ms", \
        "how long a frame is held up at most until it is flipped, as a host in step (exercise.cigi) may want; 0: never") \
    ROW(CHOICE, projector., gamepad, PROJECTOR_NO_GAMEPAD, ProjectorGamepad, \
        (PROJECTOR_NO_GAMEPAD, "none")(PROJECTOR_LEVEL, "level")(PROJECTOR_BODY, "body"), \
        "a gamepad of this machine turns the eye of a live node, by poses to exercise.head: from north and level, or from " \
        "the axes of what carries the eye")

#define CONFIG_RECORD(ROW) \
    ROW(PATH, record., path, "", 1024, "pcapng file to which `run` records all received datagrams; empty: none")

#define CONFIG_WEATHER(ROW) \
    ROW(NAME_OR_PATH, weather., atmosphere, "us1976", 1024, \
        "us1976, midlat_summer (haze; their clear air follows air_temp_k and humidity_pct), or another folder of " \
        "etc/atmosphere, or the path of such a folder, ./NAME (whose air is that of its tables)") \
    ROW(DOUBLE, weather., visibility_m, 23000, 100, 300000, "m", "meteorological range") \
    ROW(DOUBLE, weather., air_temp_k, NAN, 220, 330, "K", \
        "at ground level at the terrain origin, with the standard atmospheres' lapse above; unset: the atmosphere's " \
        "own") \
    ROW(DOUBLE, weather., pressure_mbar, 1013.25, 300, 1100, "mbar", "air pressure, for the refraction of sunlight") \
    ROW(DOUBLE, weather., wind_mps, 3, 0, 60, "m/s", "wind speed; cools ground and vehicles, moves smoke") \
    ROW(DOUBLE, weather., wind_from_deg, 270, 0, 360, "deg", "direction the wind comes from, clockwise from north") \
    ROW(NAME_OR_PATH, weather., day, "clear", 1024, \
        "the weather's course: clear sky and air that warms and cools over the day (clear), the values here at " \
        "all times (constant), or a weather file (EPW, TMY3, CSV)") \
    ROW(DOUBLE, weather., air_range_k, 10, 0, 60, "K", \
        "warmest less coldest air of a clear day, whose mean is weather.air_temp_k") \
    ROW(DOUBLE, weather., humidity_pct, 60, 0, 100, "%", \
        "relative humidity at weather.air_temp_k: what the air lets through and sends down in all bands, what ground " \
        "and leaves evaporate") \
    ROW(DOUBLE, weather., cloud, 0, 0, 1, "", \
        "mean share of the sky that clouds cover, which dim the sun and warm the sky") \
    ROW(DOUBLE, weather., rain_mmh, 0, 0, 300, "mm/h", \
        "rain rate, below 0 C of snow as water; dims every band and radar.preset, and wets the ground") \
    ROW(CHOICE, weather., fog, FOG_AUTO, FogChoice, \
        (FOG_AUTO, "auto")(FOG_NONE, "none")(FOG_RADIATION, "radiation")(FOG_ADVECTION, "advection"), \
        "what dims below 2 km of visibility: drops of fog by radiation (small) or advection (large), none: haze " \
        "alone; auto: radiation below 3 m/s of wind, else advection")

#define CONFIG_HEAT(ROW) \
    ROW(DOUBLE, heat., vehicle_step_s, 30, 1, 600, "s", "longest step of the heat of vehicles, people and buildings") \
    ROW(DOUBLE, heat., step_s, 600, 60, 3600, "s", "time grid of the ground's heat") \
    ROW(INT, heat., facets, 7, 3, 17, "", "slopes and azimuths of the ground's heat: a grid of so many a side, odd") \
    ROW(DOUBLE, heat., shadow_m, 16, 0, 1000, "m", \
        "cells of the shadows that relief and plants cast over the day; 0: no shadow cools the ground") \
    ROW(DOUBLE, heat., stood_min, NAN, 0, 20000, "min", \
        "how long what stands at its first report has stood, for the cold ground of its shadow; unset: drawn for each " \
        "by seed and id, from 5 minutes to 3 days") \
    ROW(PATH, heat., given, "", 1024, \
        "file of temperatures of parts over exercise time (CSV: entity, part, t_s, temp_k) that are shown " \
        "instead of those worked out; empty: none") \
    ROW(PATH, heat., vehicles, "", 1024, \
        "file of the temperatures of vehicles, people and buildings (CSV), read at the start where it is there, " \
        "written at the end, for a node that starts again; empty: none") \
    ROW(PATH, heat., marks, "", 1024, \
        "file of what stood, drove and burst (CSV): read at the start where it is there, written at the end, for " \
        "a node that starts again; empty: none")

#define CONFIG_TERRAIN(ROW) \
    ROW(DOUBLE, terrain., relief_m, 15, 0, 200, "m", "rms height of the hills of synthetic terrain") \
    ROW(DOUBLE, terrain., spacing_m, 0, 0, 1000, "m", \
        "distance between elevation posts; 0: 4 for synthetic terrain, else that of the files") \
    ROW(TEXT, terrain., place, "", 80, "", \
        "latitude and longitude, degrees, and height, m, of synthetic ground that follows from them and the seed alone, " \
        "as an exercise with ground.planted was placed on: 50.1,8.6,120; empty: led through the exercise") \
    ROW(PATH, terrain., store, "", 1024, \
        "terrain store of `pitviper terrain import`, instead of elevation, cover and orthophoto; empty: none") \
    ROW(PATHS, terrain., elevation, "", config_paths_size, \
        "elevation files or folders, separated by commas, or a list; empty: synthetic terrain") \
    ROW(CHOICE, terrain., vertical, TERRAIN_VERTICAL_AUTO, TerrainVertical, \
        (TERRAIN_VERTICAL_AUTO, "auto")(TERRAIN_VERTICAL_GEOID, "geoid")(TERRAIN_VERTICAL_ELLIPSOID, "ellipsoid"), \
        "vertical datum of the files; auto: from their CRS, else the geoid") \
    ROW(PATH, terrain., geoid, "", 1024, "geoid grid (.gtx); empty: EGM96 of proj-data") \
    ROW(PATHS, terrain., cover, "", config_paths_size, \
        "land cover files or folders; empty: derived from slope and height") \
    ROW(NAME_OR_PATH, terrain., cover_table, "", 1024, \
        "worldcover, nlcd, fbfm40, dynamicworld, corine or a CSV of code, surface; empty: detected from the codes") \
    ROW(INT, terrain., cover_band, 0, 0, 1000, "", \
        "band of the cover files; 0: 4 for LANDFIRE landscape files (8 bands), else 1") \
    ROW(PATHS, terrain., orthophoto, "", config_paths_size, "orthophoto files or folders") \
    ROW(PATHS, terrain., sources_from, "", config_paths_size, \
        "folders where files may lie that others name (VRT); empty: in the folder of the file that names them " \
        "alone") \
    ROW(CHOICE, terrain., ground, TERRAIN_GROUND_AUTO, TerrainGround, \
        (TERRAIN_GROUND_AUTO, "auto")(TERRAIN_GROUND_CLAMP, "clamp")(TERRAIN_GROUND_TRUST, "trust") \
        (TERRAIN_GROUND_FIT, "fit"), \
        "ground clamping; clamp: place land entities on the terrain; trust: leave them at their reported " \
        "heights; fit: fit the terrain to them; auto: clamp on real terrain; fit synthetic terrain and clamp the " \
        "entities whose positions are inconsistent with it") \
    ROW(SWITCH, terrain., detail, true, "on|off", \
        "noise of the ground within each surface class (etc/ground_detail.csv); off: classes of one value") \
    ROW(NAME_OR_PATHS, terrain., buildings, "invented", config_paths_size, \
        "off, invented or files: buildings, walls, roads, power lines and poles of GeoJSON, Shapefile, GeoPackage or " \
        "FlatGeobuf files, separated by commas, or a list") \
    ROW(PATH, terrain., trees, "", 1024, \
        "table of trees (CSV): lat and lon, or x_m and y_m; kind, height_m, marked; empty: none") \
    ROW(DOUBLE, terrain., clutter, 1, 0, 20, "", \
        "civil vehicles, machines, animals, fires and rocks, by the densities of clutter_table times this; 0: none") \
    ROW(NAME_OR_PATH, terrain., clutter_table, "rear_area", 1024, \
        "what clutter there is: rear_area (vehicles, generators, machines, stores, fires about troops), countryside or a " \
        "CSV as etc/clutter.csv") \
    ROW(SWITCH, terrain., lamps, true, "on|off", \
        "windows, street lamps and headlamps of buildings and clutter are lit by night; off: a blackout") \
    ROW(SWITCH, terrain., woods, true, "on|off", \
        "trees, bushes, hedges and low plants, by canopy layers, marked trunks or surface classes; off: bare " \
        "ground") \
    ROW(INT, terrain., woods_trees, 300000, 0, woods_most_trees, "", \
        "most trees, bushes and hedges; beyond, those farthest from what is on the ground are left out") \
    ROW(DOUBLE, terrain., woods_far_m, 25000, 0, 50000, "m", \
        "distance from the sensor within which the plants stand that woods_trees leaves out, fewer from four fifths of " \
        "it on; 0: none") \
    ROW(DOUBLE, terrain., woods_far_mb, 600, 16, 100000, "MB", \
        "memory of these plants; what no frame in work needs is given back beyond it") \
    ROW(DOUBLE, terrain., woods_half_m, 0, 0, 50000, "m", \
        "half width of a square about the aim in which plants stand; below 50: the extent of entities and " \
        "host about the middle of the exercise, in steps, and 4 km beyond") \
    ROW(SWITCH, terrain., woods_leaves, true, "on|off", "leaves of deciduous trees; off: bare, as in winter") \
    ROW(DOUBLE, terrain., woods_sway, 0, 0, 5, "", \
        "amplitude of the sway of plants in the wind of weather.wind_mps: 1 realistic, 0 none") \
    ROW(SWITCH, terrain., woods_tables, true, "on|off", \
        "plants lower than 84 .. 132 px in the image are met in tables of what rays meet of their kind; off: " \
        "themselves") \
    ROW(DOUBLE, terrain., woods_level1_px, 0, 0, 1000, "px", \
        "plants lower than this in the image are traced with fewer, larger leaves, low ones alone with woods_tables; " \
        "0: none") \
    ROW(DOUBLE, terrain., woods_low_m, 60, 0, 1000, "m", \
        "distance from the sensor within which grass, reeds, crops and stones stand; 0: none")

#define CONFIG_OBSERVER(ROW) \
    ROW(DOUBLE, observer., range_m, 600, 10, 100000, "m", \
        "ground distance of the stand-off observer from its aim point") \
    ROW(DOUBLE, observer., height_m, 250, 1, 20000, "m", "height of the stand-off observer above its aim point") \
    ROW(DOUBLE, observer., rate_dps, 2, -60, 60, "deg/s", \
        "angular rate of the stand-off observer's orbit, clockwise from above")

#define CONFIG_MODELS(ROW) \
    ROW(PATH, models., catalog, "", 1024, \
        "rows that take precedence over etc/catalog.csv: which model an entity type gets") \
    ROW(PATH, models., materials, "", 1024, "rows that take precedence over etc/materials.csv") \
    ROW(DOUBLE, models., sag_m, 0.002, 1e-5, 0.1, "m", \
        "chord error: largest distance of a facet from the curved surface of a built-in shape")

#define CONFIG_ENTITIES(ROW) \
    ROW(DOUBLE, entities., timeout_s, 12, 0.1, 1e5, "s", "an entity without a report for this long is removed") \
    ROW(DOUBLE, entities., timeout_land_v7_s, 132, 0.1, 1e5, "s", "the same for land entities of DIS version 7") \
    ROW(DOUBLE, entities., extrapolation_limit_s, 12, 0.01, 1e4, "s", "longest extrapolation by dead reckoning") \
    ROW(INT, entities., capacity, 100000, 1, 1000000, "", \
        "most entities in the table; beyond, the sender with the most entities loses its farthest and stalest") \
    ROW(INT, entities., shown, 2000, 1, 1000000, "", \
        "most entities in a frame: those whose reports lie nearest the host's") \
    /* as many as a sender has ids */ \
    ROW(INT, entities., new_per_s, 65536, 1, 1000000, "1/s", \
        "most entities that one sender may add, in a second and at once; those beyond are counted")

#define CONFIG_QUALITY(ROW) \
    ROW(SWITCH, quality., budget, true, "off|on", \
        "each frame's estimate of its own error, in truth.jsonl; changes no image") \
    ROW(SWITCH, quality., deadline, true, "off|on", \
        "`run` alone: a frame that would not be done in time gives up rays of ground, plants and sky, never of " \
        "targets, and notes it in the recording; it never has more than sensor.* sets; off: frames are left out") \
    ROW(DOUBLE, quality., radiance_rmse_percent, NAN, 0.01, 1000, "%", \
        "largest sampling error, rms relative to the band's mean: selects sensor.samples, edge_samples, " \
        "target_samples, antialias") \
    ROW(DOUBLE, quality., temperature_rms_k, NAN, 1e-3, 1000, "K", \
        "the same as apparent temperature, for mwir and lwir") \
    ROW(DOUBLE, quality., frame_ms, NAN, 0.01, 1e6, "ms", \
        "time available for the rays of a frame, from the table's times and quality.machine_factor") \
    ROW(DOUBLE, quality., machine_factor, 1, 0.001, 1000, "", \
        "time on this machine relative to that in the table; `run` measures it when it is not given") \
    ROW(PATH, quality., table, "", 1024, \
        "sampling settings with their errors and times, from `pitviper bench quality --table FILE`; empty: " \
        "etc/quality.csv")

#define CONFIG_CACHE(ROW) \
    ROW(SWITCH, cache., on, true, "off|on", \
        "what runs make before their first frame and content decides is kept on disk for the next; changes no product") \
    ROW(PATH, cache., folder, "", 1024, "where; empty: $XDG_CACHE_HOME/pitviper, else ~/.cache/pitviper") \
    ROW(INT, cache., most_mb, 2048, 1, 1048576, "MB", "most that it takes; the least recently used is removed")

#define CONFIG_TOP(ROW) \
    ROW(LONG, , seed, 1, 0, 2147483647, "", "seed of all random numbers")

/* clang-format on */

#endif
