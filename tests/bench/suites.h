/* tests/bench/suites.h: what `pitviper bench` runs: all suites, and the functions that add their rows, each in the file
 * that its name tells: bench_precision_air in tests/bench/render/precision_air.c. Those that take a Bench alone return
 * the reason of a failure, which they have logged. */
#ifndef TESTS_BENCH_SUITES_H
#define TESTS_BENCH_SUITES_H

#include "tests/bench/bench.h"

/* Gives the suites one after the other, room by room from the first, starting from a zeroed state; NULL: there are no
 * more. It is a BenchNext. */
const BenchSuite *bench_next_suite(size_t state[2]);

/* ---- dis ----------------------------------------------------------------------------------------- */

Status bench_speed_pdus(Bench *bench);      /* PDUs, bundles, a capture */
Status bench_network_sockets(Bench *bench); /* sockets and the recorder */
Status bench_stability_stamps(Bench *bench);

/* ---- terrain ------------------------------------------------------------------------------------- */

Status bench_precision_earth(Bench *bench);
Status bench_precision_land(Bench *bench);
Status bench_stability_earth(Bench *bench); /* runs the other two */
Status bench_stability_posts(Bench *bench);
Status bench_stability_import(Bench *bench); /* stores made of files */

/* ---- entities ------------------------------------------------------------------------------------ */

Status bench_speed_table(Bench *bench); /* the entity table */
Status bench_precision_motion(Bench *bench);
Status bench_stability_motion(Bench *bench); /* runs the other three */
Status bench_stability_pdus(Bench *bench);   /* numbers of PDUs */
Status bench_stability_text(Bench *bench);   /* numbers in files */
Status bench_stability_models(Bench *bench);

/* ---- render -------------------------------------------------------------------------------------- */

Status bench_precision_light(Bench *bench);
Status bench_precision_air(Bench *bench);
Status bench_precision_weather(Bench *bench);
Status bench_precision_limb(Bench *bench);
Status bench_precision_faces(Bench *bench);
Status bench_precision_trace(Bench *bench);
Status bench_precision_heat(Bench *bench);
Status bench_precision_network(Bench *bench); /* precision_vehicle.c: steps in time */
Status bench_precision_patches(Bench *bench); /* precision_vehicle.c: patches */
Status bench_precision_gas(Bench *bench);
Status bench_precision_radar(Bench *bench);
Status bench_speed_network(Bench *bench); /* precision_vehicle.c: what a step costs */
Status bench_speed_air(Bench *bench);
Status bench_speed_crowd(Bench *bench);
Status bench_stability_parts(Bench *bench);    /* rays against triangles */
Status bench_stability_ground(Bench *bench);   /* rays against the height field */
Status bench_stability_light(Bench *bench);    /* Planck, air, smoke, surfaces */
Status bench_stability_sun(Bench *bench);      /* the sun at the horizon, overhead, behind */
Status bench_stability_air(Bench *bench);      /* any weather, any height */
Status bench_stability_horizon(Bench *bench);  /* bending rays, the Earth beyond the outline */
Status bench_stability_gloss(Bench *bench);    /* gloss near things */
Status bench_stability_pictures(Bench *bench); /* ranges, origins, views, sizes */
Status bench_stability_crowd(Bench *bench);    /* numbers of entities, positions of the eye, the radar */
Status bench_stability_plants(Bench *bench);   /* rays against plants */
Status bench_stability_plant_tables(Bench *bench);
Status bench_stability_scenery(Bench *bench); /* buildings and clutter */
Status bench_stability_heat(Bench *bench);    /* the ground's heat */
Status bench_stability_network(Bench *bench); /* stability_heat.c: networks of thermal nodes */
Status bench_stability_radar(Bench *bench);   /* the field of a radar target */
Status bench_stability_built(Bench *bench);   /* walls to a radar */

/* ---- sensor -------------------------------------------------------------------------------------- */

Status bench_speed(Bench *bench);             /* a frame, its rays alone, what comes before and after it */
Status bench_speed_check(const Bench *bench); /* its options */
Status bench_speed_horizon(Bench *bench);     /* bending rays over the sea, the Earth beyond the outline */
Status bench_speed_radar(Bench *bench);       /* the radar with phase: targets by signatures, updates */
Status bench_woods(Bench *bench);             /* woods_frames.c: frames of three million trees */
Status bench_town(Bench *bench);              /* town.c: frames of 10,000 houses */
Status bench_town_import(Bench *bench);       /* town_import.c: towns of files, to records and to a first frame */
Status bench_woods_check(const Bench *bench); /* its options */
Status bench_network_live(Bench *bench);      /* a live node, and a process that sends an exercise to it */
Status bench_network_publish(Bench *bench);   /* shared memory and video of a live node, by its latency ledger */
Status bench_loop(Bench *bench);              /* a CIGI host, a node and a recogniser, in step */
Status bench_skip(Bench *bench);              /* skip_frames.c: the time that each exact skip saves */
Status bench_precision(Bench *bench);         /* frames, models and detectors; precision.h has its parts */
Status bench_stability_detector(Bench *bench);
Status bench_stability_twilight(Bench *bench);  /* twilight on the display */
Status bench_quality(Bench *bench);             /* quality_rows.c: the table from which quality.* selects */
Status bench_quality_check(const Bench *bench); /* its options */

#endif
