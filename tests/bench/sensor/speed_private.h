/* tests/bench/sensor/speed_private.h: shared by the files of `bench speed`. */
#ifndef TESTS_BENCH_SENSOR_SPEED_PRIVATE_H
#define TESTS_BENCH_SENSOR_SPEED_PRIVATE_H

#include "tests/bench/suites.h"
#include "sensor/quality/trial_private.h"

enum { what_size = 160 };

static const unsigned    three_bands = 1u << BAND_OPTICAL | 1u << BAND_MWIR | 1u << BAND_LWIR;
static const char *const all_threads = "all threads"; /* their number is printed above the table */

typedef struct Speed {
    Bench     *bench;
    int        width, height;
    double     east_m, north_m;
    LocalFrame frame;
    Landscape  landscape;
    TrialScene scene, close; /* twenty vehicles; one */
    Pool      *one, *many;
    Arena     *arena[3];   /* of frames on many threads, on one, and others */
    char       target[96]; /* what fills the image, and the sensor position */
} Speed;

/* Opens size, pools and arenas by the options, the ground with its rows, and the scene of the close target. */
Status speed_open(Speed *s);
Status speed_make_ground(Speed *s);
void   speed_close(Speed *s); /* all of it, also after a failure */
Status speed_open_close(Speed *s);
/* Whether the rows of `optical` (pictures of all bands) or `radar` are asked for: --bands names one of them. */
bool          speed_wants(const Bench *bench, const char *rows);
RenderRequest speed_request(const View *view, unsigned bands, bool truth);
TrialFrame    speed_frame(const Speed *s, const TrialScene *scene, const RenderRequest *request, bool many);
/* Into a row, whether the planes of a frame are those of one thread without skips; its limit: they are. */
void speed_judge_bits(BenchRow *row, const Speed *s, const TrialFrame *frame);
/* Makes the rows of gloss on the other side of the close target, of twilight. */
Status speed_gloss(Speed *s, const RenderRequest *close);
Status speed_twilight(Speed *s, const RenderRequest *of);
/* Makes the rows of a frame's files and of memory. */
Status speed_files(Speed *s);
void   speed_memory(Speed *s);
/* Makes the rows of a world's set-up by parts, and of a sweep's variant. */
Status speed_start(Speed *s);
/* Makes the rows of the ground's heat; warms the scene's world. */
Status speed_heat(Speed *s);

/* ---- speed_rays.c: the rays of an image of one sample per pixel, in a frame's own order, for the tracers alone ----
 */

typedef struct RawRays RawRays;

/* Eye rays in the frame's tiles and, where it has a band with shadows, the sun rays of their hits; the rays that
 * pass near each vehicle are found here, too. frame: one that was rendered; its arena is used, not reset. */
Status raw_rays_create(RawRays **out, const TrialFrame *frame);
void   raw_rays_destroy(RawRays *raw);
int    raw_rays_count(const RawRays *raw);
/* Traces the rays of a frame by its own tracers, ground by tiles and parts by packets, with its tiles, order and
 * limits, and does nothing else. Eye rays go to the parts and then to the ground in front of them, sun rays to the
 * parts and, if not blocked, to the ground. user: a RawRays with a pool. */
void raw_trace(void *user);
void raw_use_pool(RawRays *raw, Pool *pool);
/* Worst difference in range, m, between the ground tracer and a reference walk from one post line to the next in
 * double, over every n-th ray traced to the ground; INFINITY where one hits the ground and the other does not. */
double raw_worst_m(const RawRays *raw, int every);

#endif
