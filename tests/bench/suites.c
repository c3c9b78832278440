/* tests/bench/suites.c: all suites of `pitviper bench`, room by room. Those of one name run one after another, in this
 * order. */
#include "tests/bench/suites.h"

/* Runs the stress cases of render, in order; a case that fails does not stop the rest. */
static Status bench_stability_render(Bench *bench)
{
    static Status (*const part[])(Bench *) = {
        bench_stability_parts,   bench_stability_ground,  bench_stability_light,        bench_stability_sun,
        bench_stability_air,     bench_stability_horizon, bench_stability_gloss,        bench_stability_pictures,
        bench_stability_crowd,   bench_stability_plants,  bench_stability_plant_tables, bench_stability_heat,
        bench_stability_network, bench_stability_radar,   bench_stability_built,        bench_stability_scenery};
    Status failed = STATUS_OK;
    for (size_t k = 0; k < sizeof part / sizeof *part; k++) {
        const Status status = part[k](bench);
        if (status == STATUS_OK) continue;
        log_error("bench: stability: %s", status_name(status));
        failed = status;
    }
    return failed;
}

static const BenchSuite suites[] = {
    /* dis */
    {.name = "dis",
     .room = "dis",
     .help = "PDUs: decode, encode, bundles, a capture",
     .run = bench_speed_pdus,
     .reads = "Times are of one PDU, datagram or entity on one core; the errors are octets that do not come back, and "
              "places "
              "against a motion integrated step by step: both are 0 but for rounding."},
    {.name = "network",
     .room = "dis",
     .help = "loopback: datagrams at stated rates, how late they are taken, the recorder; then a live node",
     .run = bench_network_sockets,
     .reads = "Rates are what was received beside the share that was lost on the way, sender and receiver on the same "
              "machine; "
              "latencies run from the kernel's stamp of a datagram."},
    {.name = "stability",
     .room = "dis",
     .help = "time stamps about the hour, clocks over days, fields at the edges of a float",
     .run = bench_stability_stamps},
    /* terrain */
    {.name = "precision", .room = "terrain", .help = "places, the geoid, the sun", .run = bench_precision_earth},
    {.name = "precision", .room = "terrain", .help = "posts, detail", .run = bench_precision_land},
    {.name = "stability",
     .room = "terrain",
     .help = "places from pole to pole, frames, sun, geoid; grids with cliffs, spikes and voids",
     .run = bench_stability_earth},
    /* entities */
    {.name = "dis",
     .room = "entities",
     .help = "the entity table: reports in, snapshots out",
     .run = bench_speed_table},
    {.name = "stability",
     .room = "entities",
     .help = "motion and attitude at their edges, every number from outside, degenerate models",
     .run = bench_stability_motion},
    {.name = "precision", .room = "entities", .help = "dead reckoning", .run = bench_precision_motion},
    /* render */
    {.name = "precision",
     .room = "render",
     .help = "black bodies, light on surfaces, smoke",
     .run = bench_precision_light},
    {.name = "precision",
     .room = "render",
     .help = "a frame's tables of the air and the sky",
     .run = bench_precision_air},
    {.name = "precision",
     .room = "render",
     .help = "the air by the weather, the sun that heats",
     .run = bench_precision_weather},
    {.name = "precision", .room = "render", .help = "the round air below the horizontal", .run = bench_precision_limb},
    {.name = "precision", .room = "render", .help = "unlit sides against a path tracer", .run = bench_precision_faces},
    {.name = "precision", .room = "render", .help = "rays against ground and parts", .run = bench_precision_trace},
    {.name = "precision",
     .room = "render",
     .help = "the ground's heat: steps, elements, slopes, shade",
     .run = bench_precision_heat},
    {.name = "precision", .room = "render", .help = "a vehicle's heat: steps", .run = bench_precision_network},
    {.name = "precision", .room = "render", .help = "a vehicle's heat: patches", .run = bench_precision_patches},
    {.name = "precision", .room = "render", .help = "hot gas: grey gases", .run = bench_precision_gas},
    {.name = "precision",
     .room = "render",
     .help = "the radar field of a target: tubes, mirrors, edges, reuse",
     .run = bench_precision_radar},
    {.name = "speed", .room = "render", .help = "a step of a vehicle's heat", .run = bench_speed_network},
    {.name = "speed", .room = "render", .help = "a frame's air by the eye's height", .run = bench_speed_air},
    {.name = "crowd",
     .room = "render",
     .help = "frames in a world of 100,000 entities, and of tanks stacked in one place",
     .run = bench_speed_crowd},
    {.name = "stability",
     .room = "render",
     .help = "rays, light and pictures under stress: needles, far origins, 1 K, 200 km, 8192 px",
     .run = bench_stability_render},
    /* sensor */
    {.name = "speed",
     .room = "sensor",
     .options = "size=WxH: 720x486,ground=KMxKM: 12x16; of posts 1 m apart,model=FILE: fills the picture; "
                "models/brlcad/ktank.obj of the reference data or else the built-in tank,"
                "bands=optical|radar: pictures of all bands or the radar with phase alone; both",
     .help =
         "frames over a large ground with twenty vehicles: whole, by stage, against the tracer alone; set-up, a sweep",
     .run = bench_speed,
     .check = bench_speed_check,
     .reads =
         "Frames are whole, planes of truth and all, handed over in memory; stages are of one thread, where they add "
         "up to the frame (bars: their share), and `rays alone` is the least that a frame could take. Rows of the "
         "radar are of one with phase: its targets, and whole updates."},
    {.name = "speed",
     .room = "sensor",
     .help = "frames over the sea: rays that bend, the Earth beyond the terrain's outline",
     .run = bench_speed_horizon},
    {.name = "speed",
     .room = "sensor",
     .help = "a 94 GHz seeker's radar: a target in a new bin of aspect and in one at hand, ten of them with clutter; "
             "what the ground's mirror costs",
     .run = bench_speed_radar},
    {.name = "woods",
     .room = "sensor",
     .options = "trees=N: at most; 3000000,parts=WORDS: times errors vehicles flight seeker; some of them joined by +,"
                "views=DIGITS: of 1234",
     .help =
         "frames of three million trees over 192 M posts, in full detail and by tables of far plants: time, and what the "
         "latter costs in pictures, vehicles seen, a flight, recognisers; a frame of two cameras and a radar",
     .run = bench_woods,
     .check = bench_woods_check,
     .reads =
         "Frames are whole, of all bands, one ray a pixel but for rows of the default quality. Times of full detail are with terrain.woods_tables: "
         "off; errors are beside plants with the finest leaves everywhere, against 16 rays in every pixel in full "
         "detail; of tables also by the same 16 rays in both, where no sampling is part of it. Rows with a limit are of tables beside full "
         "detail: noise is out where they say so (products of differences by two independent sets of rays), the standard error is by tiles, frames "
         "or vehicles, and twice it, at most half of what was asked, is added to the limit."},
    {.name = "town",
     .room = "sensor",
     .help = "frames of 10,000 houses and 5,000 cars and trailers beside the same without: set-up, memory, time, bits",
     .run = bench_town},
    {.name = "town",
     .room = "sensor",
     .help = "towns of files, 10,000 and 200,000 buildings as GeoJSON, GeoPackage and Shapefile: to records; the first "
             "with clutter to its first frame",
     .run = bench_town_import,
     .reads = "Buildings are read by a process of their own, whose time is in the wall's and not in the processor's."},
    {.name = "network",
     .room = "sensor",
     .help = "a live node, an exercise sent to it: what is lost, how late it is",
     .run = bench_network_live},
    {.name = "network",
     .room = "sensor",
     .help = "a live node with shared memory and video: when frames are there, how many are left out",
     .run = bench_network_publish,
     .reads = "Times are from the node's own latency ledger, from the end of rendering; error: 99 % of the frames."},
    {.name = "loop",
     .room = "sensor",
     .help =
         "from pose to pose: a CIGI host, the frame, a recogniser's answer through shared memory and UDP, 256 x 256 "
         "on bare ground",
     .run = bench_loop,
     .reads =
         "Times are of a loop in lockstep of three processes on this machine; the stages are one after another, and error "
         "is what 99 % of the frames keep. Other load on the machine decides them: its average is in the table."},
    {.name = "skip",
     .room = "sensor",
     .help = "what each exact skip saves, in the scene where it saves most",
     .run = bench_skip,
     .reads = "The time is of a frame with the skip, the ratio says how much longer it takes without; the planes are "
              "the same to the bit, or the row fails."},
    {.name = "precision",
     .room = "sensor",
     .help = "frames, models and detectors: settings, what each costs and how wrong it is",
     .run = bench_precision},
    {.name = "stability",
     .room = "sensor",
     .help = "detectors of 1 to 16 bits, displays without contrast, threads that agree",
     .run = bench_stability_detector},
    {.name = "stability",
     .room = "sensor",
     .help = "twilight on the display, from day to night",
     .run = bench_stability_twilight},
    {.name = "quality",
     .room = "sensor",
     .options = "table=FILE: written too; quality.* picks from etc/quality.csv",
     .help =
         "rays a pixel, at edges and over small targets together: time against error on bare ground and in woods, what quality.* picks from",
     .run = bench_quality,
     .check = bench_quality_check},
};

const BenchSuite *bench_next_suite(size_t state[2])
{
    return state[0] < sizeof suites / sizeof *suites ? &suites[state[0]++] : NULL;
}
